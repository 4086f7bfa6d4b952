# SPDX-License-Identifier: Apache-2.0
"""YOLOv5's training target: shape-matched anchors in up to three cells, CIoU, objectness, classes."""
from __future__ import annotations

import dataclasses
import math

import torch
import torch.nn.functional as F
from torch import Tensor

from .model import ANCHORS, STRIDES


@dataclasses.dataclass
class LossWeights:
    box: float = 0.05
    objectness: float = 1.0
    classes: float = 0.25
    balance: tuple[float, float, float] = (4.0, 1.0, 0.4)
    ratio: float = 4.0  # an anchor fits a box when no side differs by more


def ciou(a: Tensor, b: Tensor) -> Tensor:
    """Complete IoU of boxes (cx, cy, w, h): Zheng et al. 2020, eq. 10."""
    a0, a1, b0, b1 = (x[:, :2] + s * x[:, 2:] / 2 for x in (a, b) for s in (-1, 1))
    inter = (torch.minimum(a1, b1) - torch.maximum(a0, b0)).clamp(min=0).prod(1)
    union = a[:, 2:].prod(1) + b[:, 2:].prod(1) - inter + 1e-7
    iou = inter / union
    hull = ((torch.maximum(a1, b1) - torch.minimum(a0, b0)) ** 2).sum(1) + 1e-7
    apart = ((a[:, :2] - b[:, :2]) ** 2).sum(1)
    angle = torch.atan(b[:, 2] / (b[:, 3] + 1e-7)) - torch.atan(a[:, 2] / (a[:, 3] + 1e-7))
    v = 4 / math.pi**2 * angle**2
    alpha = (v / (1 - iou + v + 1e-7)).detach()
    return iou - apart / hull - alpha * v


def match(boxes: Tensor, anchors: Tensor, w: int, h: int, ratio: float) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """`boxes` [n, 4] (cx, cy, w, h) in cells -> box, anchor, cell x, cell y of every match.

    A box goes to the anchors of its shape, in the cell of its centre and in the nearest cell to the
    side and the nearest above or below."""
    r = boxes[None, :, 2:] / anchors[:, None]
    fits = torch.maximum(r, 1 / r).amax(2) < ratio
    ai, bi = fits.nonzero(as_tuple=True)
    c = boxes[bi, :2]
    cell, frac = c.floor(), c - c.floor()
    size = torch.tensor([w, h])
    bs, as_, cells = [bi], [ai], [cell]
    for axis in (0, 1):
        step = torch.zeros_like(cell)
        step[:, axis] = torch.where(frac[:, axis] < 0.5, -1.0, 1.0)
        q = cell + step
        ok = ((q >= 0) & (q < size)).all(1)
        bs.append(bi[ok]), as_.append(ai[ok]), cells.append(q[ok])
    cells_ = torch.cat(cells).long()
    cells_ = torch.minimum(cells_.clamp(min=0), size - 1)
    return torch.cat(bs), torch.cat(as_), cells_[:, 0], cells_[:, 1]


def ignored(shape: tuple[int, int, int], stride: int, regions: Tensor) -> Tensor:
    """Where regions [m, 5] (image, x0, y0, x1, y1 px) say that nothing is known: [b, h, w]."""
    out = torch.zeros(shape, dtype=torch.bool)
    for i, x0, y0, x1, y1 in regions.tolist():
        c = lambda t: int(t / stride)
        out[int(i), c(y0) : c(y1) + 1, c(x0) : c(x1) + 1] = True
    return out


def loss(
    outputs: list[Tensor], targets: Tensor, regions: Tensor, weights: LossWeights
) -> tuple[Tensor, tuple[float, float, float]]:
    """`targets` [n, 6]: image, class, cx, cy, w, h in pixels. -> loss times the batch, its parts."""
    zero = torch.zeros(())
    l_box, l_obj, l_cls = zero, zero, zero
    for y, stride, anchors_px, balance in zip(outputs, STRIDES, ANCHORS, weights.balance):
        b, _, h, w = y.shape
        y = y.view(b, 3, -1, h, w)
        anchors = torch.tensor(anchors_px, dtype=torch.float32) / stride
        want = torch.zeros(b, 3, h, w)
        if len(targets):
            boxes = targets[:, 2:] / stride
            k, a, gx, gy = match(boxes, anchors, w, h, weights.ratio)
            img, cls = targets[k, 0].long(), targets[k, 1].long()
            p = y[img, a, :, gy, gx]
            if len(p):
                xy = p[:, :2].sigmoid() * 2 - 0.5
                wh = (p[:, 2:4].sigmoid() * 2) ** 2 * anchors[a]
                at = torch.stack((gx, gy), 1)
                iou = ciou(torch.cat((xy, wh), 1), torch.cat((boxes[k, :2] - at, boxes[k, 2:]), 1))
                l_box = l_box + (1 - iou).mean()
                order = iou.detach().argsort()
                want[img[order], a[order], gy[order], gx[order]] = iou.detach().clamp(0)[order]
                truth = F.one_hot(cls, p.shape[1] - 5).float()
                l_cls = l_cls + F.binary_cross_entropy_with_logits(p[:, 5:], truth)
        raw = F.binary_cross_entropy_with_logits(y[:, :, 4], want, reduction="none")
        known = (want > 0) | ~ignored((b, h, w), stride, regions)[:, None]
        l_obj = l_obj + balance * (raw * known).mean()
    parts = (weights.box * l_box, weights.objectness * l_obj, weights.classes * l_cls)
    total = sum(parts, zero) * len(outputs[0])
    return total, tuple(float(p.detach()) for p in parts)  # type: ignore[return-value]
