# SPDX-License-Identifier: Apache-2.0
"""Training pictures in memory, their labels, and augmentation.

A source is a folder with NAME.jpg, NAME.json ({"boxes": [[class, x0, y0, x1, y1]], "ignore": the
same}) and, for rendered frames, NAME.mask.png (255: not the room itself), all of one size."""
from __future__ import annotations

import argparse
import dataclasses
import json
import pathlib

import cv2
import numpy as np

from .boxes import area, clipped, intersections

Rng = np.random.Generator
FRAME_W, FRAME_H = 400, 300
HAND, MOUSE, FAN = 2, 6, 13


def size(text: str) -> tuple[int, int]:
    """An option like 320x256."""
    w, h = (int(v) for v in text.split("x"))
    if w % 32 or h % 32:
        raise argparse.ArgumentTypeError(f"{text}: width and height must be multiples of 32")
    return w, h


@dataclasses.dataclass
class Sample:
    image: np.ndarray  # [h, w, 3] uint8 BGR
    boxes: np.ndarray  # [n, 5] class, x0, y0, x1, y1
    ignore: np.ndarray  # [m, 5]


def _array(rows: list) -> np.ndarray:
    return np.array(rows, np.float32).reshape(-1, 5)


class Frames:
    """All pictures of some folders as one array; boxes scaled to FRAME_W x FRAME_H."""

    def __init__(self, folders: list[pathlib.Path]):
        files = [f for d in folders for f in sorted(d.glob("*.json"))]
        n = len(files)
        self.images = np.zeros((n, FRAME_H, FRAME_W, 3), np.uint8)
        self.solid = np.zeros((n, FRAME_H, FRAME_W // 8), np.uint8)
        self.boxes: list[np.ndarray] = []
        self.ignore: list[np.ndarray] = []
        self.real: list[bool] = []
        for k, f in enumerate(files):
            self._load(k, f)

    def _load(self, k: int, file: pathlib.Path) -> None:
        truth = json.loads(file.read_text())
        image = cv2.imread(str(file.with_suffix(".jpg")))
        s = FRAME_W / image.shape[1]
        if s != 1:
            image = cv2.resize(image, (FRAME_W, FRAME_H), interpolation=cv2.INTER_AREA)
        self.images[k] = image
        for rows, out in ((truth["boxes"], self.boxes), (truth["ignore"], self.ignore)):
            out.append(_array(rows) * np.float32([1, s, s, s, s]))
        mask = file.with_suffix(".mask.png")
        self.real.append(not mask.exists())
        if mask.exists():
            self.solid[k] = np.packbits(cv2.imread(str(mask), 0) > 127, axis=1)

    def __len__(self) -> int:
        return len(self.images)

    def sample(self, k: int) -> Sample:
        return Sample(self.images[k], self.boxes[k], self.ignore[k])

    def composite(self, k: int, background: int) -> Sample:
        """The things of rendered frame k before another frame; what they hide is not labelled."""
        solid = np.unpackbits(self.solid[k], axis=1).astype(bool)
        image = np.where(solid[..., None], self.images[k], self.images[background])
        keep, doubt = [self.boxes[k]], [self.ignore[k]]
        for b in self.boxes[background]:
            x0, y0, x1, y1 = (int(v) for v in b[1:])
            hidden = solid[y0 : y1 + 1, x0 : x1 + 1].mean() if x1 >= x0 and y1 >= y0 else 1
            (keep if hidden < 0.35 else doubt).append(b[None])
        return Sample(image, np.concatenate(keep), np.concatenate([*doubt, self.ignore[background]]))


# ---- geometry
def warped(s: Sample, scale: float, tx: float, ty: float, w: int, h: int, flip: bool) -> Sample:
    M = np.float32([[scale, 0, tx], [0, scale, ty]])
    grey = (114, 114, 114)
    how = cv2.INTER_AREA if scale < 0.6 else cv2.INTER_LINEAR
    image = cv2.warpAffine(s.image, M, (w, h), flags=how, borderValue=grey)
    move = lambda b: np.column_stack([b[:, :1], b[:, 1:] * scale + np.float32([tx, ty, tx, ty])])
    boxes, ignore = move(s.boxes), move(s.ignore)
    if flip:
        image = np.ascontiguousarray(image[:, ::-1])
        for b in (boxes, ignore):
            b[:, [1, 3]] = w - b[:, [3, 1]]
    return cut(Sample(image, boxes, ignore), w, h)


def cut(s: Sample, w: int, h: int) -> Sample:
    """Clips to the picture; what shows less than a quarter, or under 4 px, becomes unknown."""
    before, c = area(s.boxes[:, 1:]), s.boxes.copy()
    c[:, 1:] = clipped(c[:, 1:], w, h)
    seen = area(c[:, 1:])
    there, side = seen > 2, np.minimum(c[:, 3] - c[:, 1], c[:, 4] - c[:, 2])
    large = (c[:, 0] <= 1) & (seen > 0.02 * w * h)  # a person or head that fills the picture counts
    good = there & (side >= 4) & ((seen >= 0.25 * before) | large)
    i = s.ignore.copy()
    i[:, 1:] = clipped(i[:, 1:], w, h)
    i = np.concatenate([i[area(i[:, 1:]) > 0], c[there & ~good]])
    return Sample(s.image, c[good], i)


def letterboxed(s: Sample, w: int, h: int) -> Sample:
    sh, sw = s.image.shape[:2]
    k = min(w / sw, h / sh)
    return warped(s, k, (w - k * sw) / 2, (h - k * sh) / 2, w, h, False)


def random_view(s: Sample, rng: Rng, w: int, h: int) -> Sample:
    """Scaled about the size it would have as a whole, and cropped at random."""
    base = w / FRAME_W
    k = base * float(np.exp(rng.uniform(np.log(0.6), np.log(1.7))))
    tx = rng.uniform(min(0, w - k * FRAME_W), max(0, w - k * FRAME_W))
    ty = rng.uniform(min(0, h - k * FRAME_H), max(0, h - k * FRAME_H))
    return warped(s, k, tx, ty, w, h, rng.random() < 0.5)


def mosaic(four: list[Sample], rng: Rng, w: int, h: int) -> Sample:
    cx, cy = int(w * rng.uniform(0.3, 0.7)), int(h * rng.uniform(0.3, 0.7))
    image, boxes, ignore = np.empty((h, w, 3), np.uint8), [], []
    for s, (x0, y0, x1, y1) in zip(four, ((0, 0, cx, cy), (cx, 0, w, cy), (0, cy, cx, h), (cx, cy, w, h))):
        tw, th = x1 - x0, y1 - y0
        k = max(tw / FRAME_W, th / FRAME_H) * rng.uniform(1, 1.8)
        t = warped(s, k, rng.uniform(tw - k * FRAME_W, 0), rng.uniform(th - k * FRAME_H, 0), tw, th, rng.random() < 0.5)
        image[y0:y1, x0:x1] = t.image
        at = np.float32([0, x0, y0, x0, y0])
        boxes.append(t.boxes + at), ignore.append(t.ignore + at)
    return Sample(image, np.concatenate(boxes), np.concatenate(ignore))


# ---- looks
def recoloured(im: np.ndarray, rng: Rng) -> np.ndarray:
    hsv = cv2.cvtColor(im, cv2.COLOR_BGR2HSV)
    x = np.arange(256)
    hue = ((x + rng.uniform(-6, 6)) % 180).astype(np.uint8)
    sat = np.clip(x * rng.uniform(0.3, 1.5), 0, 255).astype(np.uint8)
    tone = 255 * (x / 255) ** float(np.exp(rng.uniform(-0.5, 0.5)))
    val = np.clip((tone - 128) * rng.uniform(0.65, 1.3) + 128 + rng.uniform(-25, 25), 0, 255).astype(np.uint8)
    out = cv2.merge([cv2.LUT(c, t) for c, t in zip(cv2.split(hsv), (hue, sat, val))])
    return cv2.cvtColor(out, cv2.COLOR_HSV2BGR)


def blurred(im: np.ndarray, rng: Rng) -> np.ndarray:
    if rng.random() < 0.4:
        return cv2.GaussianBlur(im, (0, 0), rng.uniform(0.4, 1.6))
    n, a = int(rng.integers(3, 12)), rng.uniform(0, np.pi)
    k = np.zeros((n, n), np.float32)
    c, d = (n - 1) / 2, np.array([np.cos(a), np.sin(a)]) * (n - 1) / 2
    cv2.line(k, tuple(np.int32(c - d)), tuple(np.int32(c + d)), 1.0)
    return cv2.filter2D(im, -1, k / k.sum())


def with_holes(s: Sample, rng: Rng) -> Sample:
    """Cut-out: up to four patches of noise or grey; boxes that they hide by half become unknown."""
    h, w = s.image.shape[:2]
    holes = []
    for _ in range(int(rng.integers(1, 5))):
        a, b = rng.uniform(0.05, 0.3, 2) * [w, h]
        x, y = rng.uniform(0, w - a), rng.uniform(0, h - b)
        x0, y0, x1, y1 = int(x), int(y), int(x + a), int(y + b)
        s.image[y0:y1, x0:x1] = (
            rng.integers(0, 256, 3) if rng.random() < 0.6 else rng.integers(0, 256, (y1 - y0, x1 - x0, 3))
        )
        holes.append((x0, y0, x1, y1))
    hidden = intersections(s.boxes[:, 1:], np.float32(holes)).max(1, initial=0) / np.maximum(area(s.boxes[:, 1:]), 1)
    gone = hidden > 0.5
    return Sample(s.image, s.boxes[~gone], np.concatenate([s.ignore, s.boxes[gone]]))


class Augmenter:
    """Draws training samples; rare classes more often, real frames with a fixed share."""

    def __init__(self, frames: Frames, w: int, h: int, real_share: float = 0.15):
        self.f, self.w, self.h = frames, w, h
        self.real = np.flatnonzero(frames.real)
        self.rendered = np.flatnonzero(~np.array(frames.real, bool))
        self.real_share = real_share if len(self.real) else 0.0
        rare = [1 + 1.0 * sum(int(b[0]) in (HAND, MOUSE, FAN) for b in frames.boxes[k]) ** 0.5 for k in self.rendered]
        self.odds = np.cumsum(rare) / np.sum(rare)

    def _one(self, rng: Rng) -> Sample:
        if rng.random() < self.real_share:
            return self.f.sample(int(rng.choice(self.real)))
        k = int(self.rendered[min(np.searchsorted(self.odds, rng.random()), len(self.rendered) - 1)])
        u = rng.random()
        if u < 0.35 and len(self.real):
            return self.f.composite(k, int(rng.choice(self.real)))
        return self.f.sample(k)

    def draw(self, rng: Rng, calm: bool = False) -> Sample:
        """`calm`: no mosaic and no holes, as in the last part of a training."""
        if rng.random() < 0.4 and not calm:
            s = mosaic([self._one(rng) for _ in range(4)], rng, self.w, self.h)
        elif rng.random() < 0.3:
            s = letterboxed(self._one(rng), self.w, self.h)
        else:
            s = random_view(self._one(rng), rng, self.w, self.h)
        s.image = recoloured(s.image, rng) if rng.random() < 0.8 else s.image
        if rng.random() < 0.25:
            s.image = blurred(s.image, rng)
        if rng.random() < 0.2:
            noise = rng.normal(0, rng.uniform(2, 14), s.image.shape)
            s.image = np.clip(s.image + noise, 0, 255).astype(np.uint8)
        if rng.random() < 0.06:
            s.image = cv2.cvtColor(cv2.cvtColor(s.image, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
        if rng.random() < 0.2 and not calm:
            s = with_holes(Sample(np.ascontiguousarray(s.image), s.boxes, s.ignore), rng)
        return s
