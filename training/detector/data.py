# SPDX-License-Identifier: Apache-2.0
"""Training pictures in memory, their labels, and augmentation.

A source is a folder with NAME.jpg, NAME.json ({"boxes": [[class, x0, y0, x1, y1]], "ignore": the
same}) and, for rendered frames, NAME.mask.png (255: not the room itself). Frames come to FRAME_W x
FRAME_H; photographs (detector.fill) keep their shape."""
from __future__ import annotations

import argparse
import dataclasses
import json
import pathlib

import cv2
import numpy as np

from .boxes import area, clipped, intersections
from .classes import CLASSES

Rng = np.random.Generator
FRAME_W, FRAME_H = 400, 300
LONGEST = 416  # side of a photograph


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
    real: bool = False  # nothing in it is rendered


def number(name: str | int) -> int:
    return CLASSES.index(name) if isinstance(name, str) else int(name)


def _array(rows: list) -> np.ndarray:
    return np.array(rows, np.float32).reshape(-1, 5)


class Frames:
    """All pictures of some folders; boxes in pixels of the pictures as they are kept here."""

    def __init__(self, folders: list[pathlib.Path], photographs: list[pathlib.Path] = []):
        self.images: list[np.ndarray] = []
        self.solid: list[np.ndarray | None] = []
        self.boxes: list[np.ndarray] = []
        self.ignore: list[np.ndarray] = []
        self.kind: list[str] = []
        for d in folders:
            for f in sorted(d.glob("*.json")):
                self._load(f, False)
        for f in sorted(f for d in photographs for f in d.glob("*/*.json")):
            if f.name != "labels.json":
                self._load(f, True)

    def _load(self, file: pathlib.Path, photograph: bool) -> None:
        truth = json.loads(file.read_text())
        image = cv2.imread(str(file.with_suffix(".jpg")))
        s = min(1.0, LONGEST / max(image.shape[:2])) if photograph else FRAME_W / image.shape[1]
        if s != 1:
            w, h = (round(v * s) for v in image.shape[1::-1]) if photograph else (FRAME_W, FRAME_H)
            image = cv2.resize(image, (w, h), interpolation=cv2.INTER_AREA)
        self.images.append(image)
        for rows, out in ((truth["boxes"], self.boxes), (truth["ignore"], self.ignore)):
            out.append(_array([[number(r[0]), *r[1:]] for r in rows]) * np.float32([1, s, s, s, s]))
        mask = file.with_suffix(".mask.png")
        solid = np.packbits(cv2.imread(str(mask), 0) > 127, axis=1) if mask.exists() else None
        self.solid.append(solid)
        self.kind.append("photograph" if photograph else "real" if solid is None else "rendered")

    def of(self, kind: str) -> np.ndarray:
        return np.flatnonzero(np.array(self.kind) == kind)

    def __len__(self) -> int:
        return len(self.images)

    def sample(self, k: int) -> Sample:
        return Sample(self.images[k], self.boxes[k], self.ignore[k], self.kind[k] != "rendered")

    def composite(self, k: int, background: Sample) -> Sample:
        """The things of rendered frame k before a real picture of the same size; what they hide is unknown."""
        packed = self.solid[k]
        assert packed is not None
        solid = np.unpackbits(packed, axis=1).astype(bool)
        image = np.where(solid[..., None], self.images[k], background.image)
        keep, doubt = [self.boxes[k]], [self.ignore[k]]
        for b in background.boxes:
            x0, y0, x1, y1 = (int(v) for v in b[1:])
            hidden = solid[y0 : y1 + 1, x0 : x1 + 1].mean() if x1 >= x0 and y1 >= y0 else 1
            (keep if hidden < 0.35 else doubt).append(b[None])
        return Sample(image, np.concatenate(keep), np.concatenate([*doubt, background.ignore]), False)


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
    return cut(Sample(image, boxes, ignore, s.real), w, h)


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
    return Sample(s.image, c[good], i, s.real)


def letterboxed(s: Sample, w: int, h: int) -> Sample:
    sh, sw = s.image.shape[:2]
    k = min(w / sw, h / sh)
    return warped(s, k, (w - k * sw) / 2, (h - k * sh) / 2, w, h, False)


def random_view(s: Sample, rng: Rng, w: int, h: int) -> Sample:
    """Scaled about the size it would have as a whole, and cropped at random."""
    ih, iw = s.image.shape[:2]
    k = min(w / iw, h / ih) * float(np.exp(rng.uniform(np.log(0.6), np.log(1.8))))
    tx = rng.uniform(min(0, w - k * iw), max(0, w - k * iw))
    ty = rng.uniform(min(0, h - k * ih), max(0, h - k * ih))
    return warped(s, k, tx, ty, w, h, rng.random() < 0.5)


def covering(s: Sample, rng: Rng, w: int, h: int, most: float) -> Sample:
    """A random part that fills the picture, up to `most` times as large as it must be."""
    ih, iw = s.image.shape[:2]
    k = max(w / iw, h / ih) * rng.uniform(1, most)
    return warped(s, k, rng.uniform(w - k * iw, 0), rng.uniform(h - k * ih, 0), w, h, rng.random() < 0.5)


def mosaic(four: list[Sample], rng: Rng, w: int, h: int) -> Sample:
    cx, cy = int(w * rng.uniform(0.3, 0.7)), int(h * rng.uniform(0.3, 0.7))
    image, boxes, ignore = np.empty((h, w, 3), np.uint8), [], []
    for s, (x0, y0, x1, y1) in zip(four, ((0, 0, cx, cy), (cx, 0, w, cy), (0, cy, cx, h), (cx, cy, w, h))):
        t = covering(s, rng, x1 - x0, y1 - y0, 1.8)
        image[y0:y1, x0:x1] = t.image
        at = np.float32([0, x0, y0, x0, y0])
        boxes.append(t.boxes + at), ignore.append(t.ignore + at)
    return Sample(image, np.concatenate(boxes), np.concatenate(ignore), all(s.real for s in four))


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
    return Sample(s.image, s.boxes[~gone], np.concatenate([s.ignore, s.boxes[gone]]), s.real)


NOISE = np.random.default_rng(0).normal(0, 1, 1 << 20).astype(np.float32)  # drawn from, not drawn anew


def noisy(im: np.ndarray, rng: Rng, sigma: float) -> np.ndarray:
    at = int(rng.integers(0, len(NOISE) // 2))
    n = np.resize(NOISE[at:], im.shape)
    return np.clip(im + sigma * n, 0, 255).astype(np.uint8)


def darkened(im: np.ndarray, rng: Rng) -> np.ndarray:
    """A room with little light: the sensor's noise stays."""
    light = (im * rng.uniform(0.12, 0.5)).astype(np.float32)
    return noisy(light, rng, rng.uniform(2, 8))


def compressed(im: np.ndarray, rng: Rng) -> np.ndarray:
    ok, data = cv2.imencode(".jpg", im, [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(15, 75))])
    return cv2.imdecode(data, cv2.IMREAD_COLOR)


def tinted(im: np.ndarray, rng: Rng) -> np.ndarray:
    """Another white balance."""
    x = np.arange(256)
    luts = [np.clip(x * rng.uniform(0.75, 1.25), 0, 255).astype(np.uint8) for _ in range(3)]
    return cv2.merge([cv2.LUT(c, t) for c, t in zip(cv2.split(im), luts)])


def looks(im: np.ndarray, rng: Rng) -> np.ndarray:
    """Another camera, other light: each change with its own odds, in the order in which they happen."""
    steps = ((0.8, recoloured), (0.25, tinted), (0.1, darkened), (0.25, blurred),
             (0.2, lambda i, r: noisy(i, r, r.uniform(2, 14))), (0.2, compressed))  # fmt: skip
    for odds, change in steps:
        if rng.random() < odds:
            im = change(im, rng)
    if rng.random() < 0.06:
        im = cv2.cvtColor(cv2.cvtColor(im, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
    return im


def rarity(boxes: list[np.ndarray], share: float, bare: float) -> np.ndarray:
    """How often each picture is drawn: by its rarest class, sqrt(share / the part of pictures with it), at
    least 1; `bare` for pictures without boxes (the repeat factor of Gupta et al. 2019)."""
    present = [np.unique(b[:, 0]).astype(int) for b in boxes]
    part = np.bincount(np.concatenate([*present, np.zeros(0, int)]), minlength=32) / max(len(boxes), 1)
    factor = np.maximum(1, np.sqrt(share / np.maximum(part, 1e-4)))
    return np.array([factor[p].max() if len(p) else bare for p in present])


@dataclasses.dataclass
class Pool:
    """Numbers of pictures and how likely each is."""

    numbers: np.ndarray
    odds: np.ndarray

    def draw(self, rng: Rng) -> int:
        return int(self.numbers[min(np.searchsorted(self.odds, rng.random()), len(self.numbers) - 1)])


class Augmenter:
    """Draws training samples: rendered, photographs and other real frames with fixed shares, rare classes more often."""

    def __init__(self, frames: Frames, w: int, h: int, shares: dict[str, float]):
        self.f, self.w, self.h = frames, w, h
        self.pools, self.shares = {}, {}
        for kind, share in shares.items():
            numbers = frames.of(kind)
            if len(numbers) == 0:
                continue
            weight = rarity([frames.boxes[k] for k in numbers], 0.3, 0.4 if kind == "photograph" else 1.0)
            self.pools[kind] = Pool(numbers, np.cumsum(weight) / weight.sum())
            self.shares[kind] = share
        self.kinds = list(self.shares)
        self.upto = np.cumsum([self.shares[k] for k in self.kinds]) / sum(self.shares.values())

    def _background(self, rng: Rng) -> Sample:
        kind = "photograph" if "photograph" in self.pools and rng.random() < 0.6 else "real"
        pool = self.pools.get(kind) or next(p for k, p in self.pools.items() if k != "rendered")
        return covering(self.f.sample(pool.draw(rng)), rng, FRAME_W, FRAME_H, 1.5)

    def _one(self, rng: Rng) -> Sample:
        kind = self.kinds[min(int(np.searchsorted(self.upto, rng.random())), len(self.kinds) - 1)]
        k = self.pools[kind].draw(rng)
        if kind == "rendered" and len(self.pools) > 1 and rng.random() < 0.35:
            return self.f.composite(k, self._background(rng))
        return self.f.sample(k)

    def draw(self, rng: Rng, calm: bool = False) -> Sample:
        """`calm`: no mosaic and no holes, as in the last part of a training."""
        if rng.random() < 0.35 and not calm:
            s = mosaic([self._one(rng) for _ in range(4)], rng, self.w, self.h)
        elif rng.random() < 0.3:
            s = letterboxed(self._one(rng), self.w, self.h)
        else:
            s = random_view(self._one(rng), rng, self.w, self.h)
        s.image = looks(s.image, rng)
        if rng.random() < 0.2 and not calm:
            s = with_holes(dataclasses.replace(s, image=np.ascontiguousarray(s.image)), rng)
        return s
