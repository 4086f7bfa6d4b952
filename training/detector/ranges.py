# SPDX-License-Identifier: Apache-2.0
"""What 8-bit integers need to know: python3 -m detector.ranges MODEL.onnx FOLDER

Prints `ranges: [...]` for the detector file: the largest magnitude that the input of every convolution
takes on photographs below FOLDER (drawn by --seed), in the order of the nodes. Larger values saturate."""
from __future__ import annotations

import argparse
import pathlib
import textwrap

import cv2
import numpy as np
import torch

from .data import size
from .graphs import Graph


class Ranges(Graph):
    """Remembers the largest magnitude before each convolution."""

    def __init__(self, file: pathlib.Path):
        super().__init__(file)
        self.largest: dict[str, float] = {}

    def _step(self, op: str, x: list, names: list[str], a: dict) -> torch.Tensor:
        if op == "Conv":
            self.largest[names[1]] = max(self.largest.get(names[1], 0.0), float(x[0].abs().max()))
        return super()._step(op, x, names, a)


def blob(file: pathlib.Path, size_: tuple[int, int]) -> torch.Tensor:
    """As the program scales a picture into its input."""
    image, (w, h) = cv2.imread(str(file)), size_
    k = min(w / image.shape[1], h / image.shape[0])
    M = np.float32([[k, 0, (w - k * image.shape[1]) / 2], [0, k, (h - k * image.shape[0]) / 2]])
    canvas = cv2.warpAffine(image, M, (w, h), flags=cv2.INTER_LINEAR, borderValue=(114, 114, 114))
    return torch.from_numpy(cv2.dnn.blobFromImage(canvas, 1 / 255, swapRB=True))


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("model", type=pathlib.Path)
    ap.add_argument("folder", type=pathlib.Path)
    ap.add_argument("--count", type=int, default=100, help="photographs")
    ap.add_argument("--size", type=size, default=(416, 320))
    ap.add_argument("--seed", type=int, default=1)
    args = ap.parse_args()
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    files = sorted(args.folder.rglob("*.jpg"))
    chosen = np.random.default_rng(args.seed).choice(len(files), min(args.count, len(files)), replace=False)
    net = Ranges(args.model)
    for k in chosen:
        net.run(blob(files[k], args.size))
    order = [i[1] for op, i, _, _ in net.nodes if op == "Conv"]
    numbers = ", ".join(f"{net.largest[name]:.4g}" for name in order)
    print(textwrap.fill(f"ranges: [{numbers}]", 96, subsequent_indent=" " * 9))


if __name__ == "__main__":
    main()
