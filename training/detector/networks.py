# SPDX-License-Identifier: Apache-2.0
"""ONNX detectors through OpenCV: ours and the two teachers, all answering in our classes."""
from __future__ import annotations

import dataclasses
import pathlib

import cv2
import numpy as np

from .boxes import clipped, nms
from .classes import CLASSES
from .model import ANCHORS, STRIDES

COCO = {0: "person", 24: "bag", 26: "bag", 28: "bag", 39: "bottle", 41: "cup", 56: "chair", 62: "monitor",
        63: "laptop", 64: "mouse", 66: "keyboard", 67: "phone", 73: "book"}  # fmt: skip
BODY_HEAD_HAND = {1: "head", 2: "hand"}


@dataclasses.dataclass
class Found:
    boxes: np.ndarray  # [n, 4]
    scores: np.ndarray
    classes: np.ndarray  # our numbers


def empty() -> Found:
    return Found(np.zeros((0, 4), np.float32), np.zeros(0, np.float32), np.zeros(0, int))


class Network:
    """`kind`: yolov5_heads (RGB / 255) or yolox_heads (BGR 0..255); `names`: output class -> ours."""

    def __init__(
        self, model: pathlib.Path, kind: str, names: dict[int, str], size: tuple[int, int], nms_iou: float = 0.45
    ):
        self.load(model)
        self.kind, self.size, self.nms_iou = kind, size, nms_iou
        self.names = {k: CLASSES.index(v) for k, v in names.items()}

    def load(self, model: pathlib.Path) -> None:
        self.net = cv2.dnn.readNetFromONNX(str(model))

    def run(self, blob: np.ndarray) -> list[np.ndarray]:
        """[1, 3, h, w] -> the heads, finest first."""
        self.net.setInput(blob)
        outs = self.net.forward(self.net.getUnconnectedOutLayersNames())
        return sorted(outs, key=lambda o: -o.shape[2])

    def detect(self, image: np.ndarray, floor: float) -> Found:
        w, h = self.size
        ih, iw = image.shape[:2]
        k = min(w / iw, h / ih)
        dx, dy = (w - k * iw) / 2, (h - k * ih) / 2
        canvas = cv2.warpAffine(image, np.float32([[k, 0, dx], [0, k, dy]]), (w, h),
                                flags=cv2.INTER_AREA if k < 0.6 else cv2.INTER_LINEAR, borderValue=(114, 114, 114))  # fmt: skip
        v5 = self.kind == "yolov5_heads"
        outs = self.run(cv2.dnn.blobFromImage(canvas, 1 / 255 if v5 else 1.0, swapRB=v5))
        decode = _yolov5 if v5 else _yolox
        rows = np.concatenate([decode(o, s, a) for o, s, a in zip(outs, STRIDES, ANCHORS)])
        found = self._select(rows, floor)
        found.boxes = clipped((found.boxes - [dx, dy, dx, dy]) / k, iw, ih)
        return found

    def _select(self, rows: np.ndarray, floor: float) -> Found:
        scores = rows[:, 4:5] * rows[:, 5:]
        best = scores.argmax(1)
        top = scores.max(1)
        at = np.flatnonzero((top >= floor) & np.isin(best, list(self.names)))
        xy, half = rows[at, :2], rows[at, 2:4] / 2
        boxes, top, cls = np.column_stack([xy - half, xy + half]), top[at], best[at]
        keep = [np.flatnonzero(cls == c)[nms(boxes[cls == c], top[cls == c], self.nms_iou)] for c in np.unique(cls)]
        if not keep:
            return empty()
        i = np.concatenate(keep)
        return Found(boxes[i], top[i], np.array([self.names[c] for c in cls[i]]))


def _grid(h: int, w: int) -> tuple[np.ndarray, np.ndarray]:
    return np.meshgrid(np.arange(w), np.arange(h))


def _yolov5(o: np.ndarray, s: int, anchors: tuple) -> np.ndarray:
    _, c, h, w = o.shape
    o = o.reshape(3, c // 3, h, w)
    gx, gy = _grid(h, w)
    rows = []
    for y, (aw, ah) in zip(o, anchors):
        box = [(2 * y[0] - 0.5 + gx) * s, (2 * y[1] - 0.5 + gy) * s, (2 * y[2]) ** 2 * aw, (2 * y[3]) ** 2 * ah]
        rows.append(np.stack([*box, *y[4:]], -1).reshape(-1, c // 3))
    return np.concatenate(rows)


def _yolox(o: np.ndarray, s: int, _: tuple) -> np.ndarray:
    _, c, h, w = o.shape
    y = o[0]
    gx, gy = _grid(h, w)
    box = [(y[0] + gx) * s, (y[1] + gy) * s, np.exp(y[2]) * s, np.exp(y[3]) * s]
    return np.stack([*box, *y[4:]], -1).reshape(-1, c)


class Teachers:
    """Objects and persons of YOLOv5n (COCO), heads and hands of the body-head-hand network."""

    network = Network

    def __init__(self, models: pathlib.Path, size: tuple[int, int] = (640, 480)):
        self.nets = [
            self.network(models / "yolov5n_coco_anysize.onnx", "yolov5_heads", COCO, size),
            self.network(models / "yolox_n_body_head_hand_anysize.onnx", "yolox_heads", BODY_HEAD_HAND, size),
        ]

    def detect(self, image: np.ndarray, floor: float) -> Found:
        a, b = (n.detect(image, floor) for n in self.nets)
        cat = np.concatenate
        return Found(cat([a.boxes, b.boxes]), cat([a.scores, b.scores]), cat([a.classes, b.classes]))


def ours(model: pathlib.Path, size: tuple[int, int]) -> Network:
    return Network(model, "yolov5_heads", dict(enumerate(CLASSES)), size)
