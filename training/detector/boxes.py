# SPDX-License-Identifier: Apache-2.0
"""Boxes as [n, 4] arrays x0, y0, x1, y1 in pixels."""
from __future__ import annotations

import numpy as np


def area(b: np.ndarray) -> np.ndarray:
    return np.clip(b[:, 2] - b[:, 0], 0, None) * np.clip(b[:, 3] - b[:, 1], 0, None)


def intersections(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """[n, m] shared areas."""
    lo = np.maximum(a[:, None, :2], b[None, :, :2])
    hi = np.minimum(a[:, None, 2:], b[None, :, 2:])
    return np.clip(hi - lo, 0, None).prod(2)


def iou(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    i = intersections(a, b)
    return i / np.maximum(area(a)[:, None] + area(b)[None] - i, 1e-9)


def clipped(b: np.ndarray, w: float, h: float) -> np.ndarray:
    return np.clip(b, 0, [w, h, w, h])


def nms(b: np.ndarray, scores: np.ndarray, most: float) -> np.ndarray:
    """Indices that stay, best first."""
    order, keep = np.argsort(-scores, kind="stable"), []
    while len(order):
        k = order[0]
        keep.append(k)
        if len(order) == 1:
            break
        order = order[1:][iou(b[k : k + 1], b[order[1:]])[0] <= most]
    return np.array(keep, int)
