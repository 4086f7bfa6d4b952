# SPDX-License-Identifier: Apache-2.0
"""Writes the averaged weights of a checkpoint as ONNX that OpenCV 4.6 and ONNX Runtime load.

python3 -m detector.export CHECKPOINT OUT.onnx"""
from __future__ import annotations

import argparse
import json
import pathlib

import cv2
import numpy as np
import torch

from .classes import CLASSES
from .files import whole
from .model import Sigmoids, Yolo


def load(checkpoint: pathlib.Path) -> Yolo:
    state = torch.load(checkpoint, map_location="cpu")
    net = Yolo(len(CLASSES), state["width"], state["depth"])
    net.load_state_dict(state["ema"])
    return net.eval()


def export(net: Yolo, out: pathlib.Path) -> None:
    """Opset 12, batch norm folded in, any input that is a multiple of 32, heads after the sigmoid."""
    names = ["stride8", "stride16", "stride32"]
    axes = {"images": {2: "height", 3: "width"}} | {n: {2: f"h_{n}", 3: f"w_{n}"} for n in names}
    torch.onnx.export(
        Sigmoids(net.fuse()).eval(), torch.zeros(1, 3, 256, 320), str(out), opset_version=12,
        input_names=["images"], output_names=names, dynamic_axes=axes, do_constant_folding=True,
    )  # fmt: skip


@torch.no_grad()
def calibrated(net: Yolo, file: pathlib.Path) -> Yolo:
    """Stretches and shifts objectness and class logits as detector.calibrate found, in the last convolutions."""
    c = json.loads(file.read_text())
    a, b = (torch.tensor(c[k]) for k in ("stretch", "shift"))
    for head in net.heads:
        w, bias = head.weight.view(3, 5 + net.classes, -1), head.bias.view(3, 5 + net.classes)
        w[:, 4:] *= a[:, None]
        bias[:, 4:] = bias[:, 4:] * a + b
    return net


def check(net: Yolo, out: pathlib.Path) -> float:
    """The largest difference between OpenCV's answer and PyTorch's, at two sizes."""
    dnn, worst = cv2.dnn.readNetFromONNX(str(out)), 0.0
    for h, w in ((256, 320), (320, 416)):
        x = np.random.default_rng(h).random((1, 3, h, w), np.float32)
        dnn.setInput(x)
        got = dnn.forward(["stride8", "stride16", "stride32"])
        with torch.no_grad():
            want = Sigmoids(net)(torch.from_numpy(x))
        worst = max(worst, *(float(np.abs(g - t.numpy()).max()) for g, t in zip(got, want)))
    return worst


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__)
    ap.add_argument("checkpoint", type=pathlib.Path)
    ap.add_argument("out", type=pathlib.Path)
    ap.add_argument("--calibration", type=pathlib.Path, help="what detector.calibrate wrote")
    args = ap.parse_args()
    net = load(args.checkpoint)
    if args.calibration:
        net = calibrated(net, args.calibration)
    with whole(args.out) as part:
        export(net, part)
        worst = check(net, part)
        print(f"{args.out}: {part.stat().st_size / 1e6:.2f} MB, OpenCV differs by {worst:.1e} at most")
        if worst > 1e-3:
            raise SystemExit("the exported network does not compute what was trained")


if __name__ == "__main__":
    main()
