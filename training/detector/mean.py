# SPDX-License-Identifier: Apache-2.0
"""The mean of exported networks of ours: python3 -m detector.mean OUT.pt A.onnx B.onnx [...]

Networks that were trained on from the same weights answer better in the mean of their weights than alone
(Wortsman et al., Model soups, ICML 2022), here with batch norm folded in. OUT.pt is a checkpoint for
detector.calibrate and detector.export; training goes on from what they export (--start)."""
from __future__ import annotations

import argparse
import pathlib

import torch
from torch import Tensor

from .classes import CLASSES
from .files import whole
from .model import Yolo
from .start import take, weights


def mean(files: list[pathlib.Path]) -> dict[str, Tensor]:
    """Of the weights by name; the files must hold the same ones."""
    all_weights = [weights(f) for f in files]
    shapes = [{k: v.shape for k, v in w.items()} for w in all_weights]
    for f, s in zip(files, shapes):
        if s != shapes[0]:
            raise SystemExit(f"{f}: has another layout than {files[0]}; take networks of one --width and --depth")
    return {k: torch.stack([w[k].float() for w in all_weights]).mean(0) for k in all_weights[0]}


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("out", type=pathlib.Path)
    ap.add_argument("networks", type=pathlib.Path, nargs="+")
    ap.add_argument("--width", type=float, default=0.25)
    ap.add_argument("--depth", type=float, default=0.33)
    args = ap.parse_args()
    net = Yolo(len(CLASSES), args.width, args.depth)
    # Whatever moments the norms get here, their gains and shifts undo them.
    noise = torch.rand(2, 3, 256, 320, generator=torch.Generator().manual_seed(1))
    take(net, mean(args.networks), noise, args.networks[0])
    with whole(args.out) as tmp:
        torch.save({"ema": net.eval().state_dict(), "width": args.width, "depth": args.depth}, tmp)


if __name__ == "__main__":
    main()
