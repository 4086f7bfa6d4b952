# SPDX-License-Identifier: Apache-2.0
"""Teaches the features of our network what a larger training saw: its answers to the same augmented picture.

The teacher (YOLOv5n, COCO) has heads of the same layout. Three more heads of ours learn its soft answers in
every cell: objectness, all 80 classes, boxes. They are thrown away after training; only answers are
learned from, no weight of the teacher is read into ours."""
from __future__ import annotations

import pathlib

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from .graphs import Graph

THRESHOLD = 0.03  # of the teacher's objectness: where its class and its box say something


class Distiller(nn.Module):
    """Heads on the three feature maps; the teacher itself is no part of the state."""

    def __init__(self, channels: tuple[int, int, int], outputs: int = 255):
        super().__init__()
        self.heads = nn.ModuleList(nn.Conv2d(c, outputs, 1) for c in channels)
        for h in self.heads:
            h.bias.data.view(3, -1)[:, 4:] = -5.0  # type: ignore[union-attr, operator]

    def forward(self, features: list[Tensor]) -> list[Tensor]:
        return [h(f) for h, f in zip(self.heads, features)]


def teacher(models: pathlib.Path) -> Graph:
    return Graph(models / "yolov5n_coco_anysize.onnx")


def distance(student: list[Tensor], taught: list[Tensor], balance: tuple[float, float, float]) -> Tensor:
    """Logits [b, 255, h, w] against answers after the sigmoid, of the same shapes."""
    total = torch.zeros(())
    for y, t, weight in zip(student, taught, balance):
        b, _, h, w = y.shape
        y, t = (v.view(b, 3, -1, h, w) for v in (y, t))
        total = total + weight * F.binary_cross_entropy_with_logits(y[:, :, 4].float(), t[:, :, 4])
        at = (t[:, :, 4] > THRESHOLD).nonzero(as_tuple=True)
        if not len(at[0]):
            continue
        mine, theirs = (v[at[0], at[1], :, at[2], at[3]].float() for v in (y, t))
        sure = theirs[:, 4]
        classes = F.binary_cross_entropy_with_logits(mine[:, 5:], theirs[:, 5:], reduction="none").mean(1)
        boxes = (mine[:, :4].sigmoid() - theirs[:, :4]).abs().sum(1)
        total = total + ((2.0 * classes + 0.25 * boxes) * sure).sum() / sure.sum()
    return total
