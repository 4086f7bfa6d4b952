# SPDX-License-Identifier: Apache-2.0
"""Teaches the features of our network what larger trainings saw: their answers to the same augmented picture.

Two teachers: YOLOv5n (COCO), whose heads have our layout, and YOLOX-nano (body, head, hand). More heads of ours
learn their soft answers in every cell: objectness, all their classes, boxes. They are thrown away after training;
only answers are learned from, no weight of a teacher is read into ours."""
from __future__ import annotations

import pathlib

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from .graphs import Graph
from .loss import LossWeights

THRESHOLD = 0.03  # of a teacher's objectness: where its class and its box say something


class Teacher(nn.Module):
    """A network that answers, and our heads that learn its answers; of its state only the heads are kept."""

    outputs, file = 0, ""

    def __init__(self, channels: tuple[int, int, int], models: pathlib.Path, weight: float):
        super().__init__()
        self.weight = weight
        self.heads = nn.ModuleList(nn.Conv2d(c, self.outputs, 1) for c in channels)
        for h in self.heads:
            self.cells(h.bias.data[None, :, None, None])[:, :, 4:] = -5.0  # type: ignore[union-attr, operator]
        self.graph = Graph(models / self.file)

    def cells(self, y: Tensor) -> Tensor:
        """[b, outputs, h, w] -> [b, anchors, 5 + classes, h, w]."""
        raise NotImplementedError

    def answers(self, x: Tensor) -> list[Tensor]:
        """Of the teacher to RGB pictures in 0..1."""
        raise NotImplementedError

    def boxes(self, mine: Tensor, theirs: Tensor) -> Tensor:
        """[n, 4] each -> how far apart, [n]."""
        raise NotImplementedError

    def distance(self, features: list[Tensor], answers: list[Tensor]) -> Tensor:
        """Between what our heads read in `features` and `answers` after the sigmoid, one scalar."""
        total = torch.zeros(())
        for head, f, t, weight in zip(self.heads, features, answers, LossWeights().balance):
            y, t = self.cells(head(f)), self.cells(t)
            total = total + weight * F.binary_cross_entropy_with_logits(y[:, :, 4].float(), t[:, :, 4])
            at = (t[:, :, 4] > THRESHOLD).nonzero(as_tuple=True)
            if not len(at[0]):
                continue
            mine, theirs = (v[at[0], at[1], :, at[2], at[3]].float() for v in (y, t))
            sure = theirs[:, 4]
            classes = F.binary_cross_entropy_with_logits(mine[:, 5:], theirs[:, 5:], reduction="none").mean(1)
            apart = 2.0 * classes + 0.25 * self.boxes(mine[:, :4], theirs[:, :4])
            total = total + (apart * sure).sum() / sure.sum()
        return total


class Things(Teacher):
    """YOLOv5n, 80 classes of COCO."""

    outputs, file = 255, "yolov5n_coco_anysize.onnx"

    def cells(self, y: Tensor) -> Tensor:
        return y.view(len(y), 3, -1, *y.shape[2:])

    def answers(self, x: Tensor) -> list[Tensor]:
        return self.graph.run(x)

    def boxes(self, mine: Tensor, theirs: Tensor) -> Tensor:
        return (mine.sigmoid() - theirs).abs().sum(1)


class Parts(Teacher):
    """YOLOX-nano: body, head, hand; one box a cell, offsets and logarithms of the sides in cells."""

    outputs, file = 8, "yolox_n_body_head_hand_anysize.onnx"

    def cells(self, y: Tensor) -> Tensor:
        return y[:, None]

    def answers(self, x: Tensor) -> list[Tensor]:
        return self.graph.run(255 * x.flip(1))

    def boxes(self, mine: Tensor, theirs: Tensor) -> Tensor:
        return F.smooth_l1_loss(mine, theirs, reduction="none", beta=0.5).clamp(max=4).sum(1)


def teachers(channels: tuple[int, int, int], models: pathlib.Path | None, weights: tuple[float, float]) -> nn.ModuleList:
    """Those that have a weight; none without their folder."""
    kinds = [(Things, weights[0]), (Parts, weights[1])] if models else []
    return nn.ModuleList(k(channels, models, w) for k, w in kinds if w > 0)  # type: ignore[arg-type]


def lessons(teachers: nn.ModuleList, x: Tensor, features: list[Tensor], heads_only: bool) -> Tensor:
    """What our heads still have to learn about the real pictures `x`; `heads_only`: our features stay as they are,
    as long as heads that know nothing would only spoil them."""
    total = torch.zeros(())
    if not len(x):
        return total
    features = [f.detach() for f in features] if heads_only else features
    for t in teachers:
        total = total + t.weight * t.distance(features, t.answers(x))  # type: ignore[operator]
    return total
