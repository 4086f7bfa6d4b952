# SPDX-License-Identifier: Apache-2.0
"""Textures: those of the renderer's assets and generated patterns, RGB."""
from __future__ import annotations

import glob
import os

import cv2
import numpy as np

SIZE = 256


def _colour(rng: np.random.Generator) -> np.ndarray:
    """Office colours: mostly greys, blues, browns; now and then anything."""
    if rng.random() < 0.45:
        return np.full(3, rng.uniform(10, 245)) + rng.normal(0, 8, 3)
    hsv = np.uint8([[[rng.integers(180), int(255 * rng.beta(1.3, 2.2)), rng.integers(25, 250)]]])
    return cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB)[0, 0].astype(float)


def _noise(rng: np.random.Generator, sigma: float) -> np.ndarray:
    f = cv2.GaussianBlur(rng.normal(size=(SIZE, SIZE)).astype(np.float32), (0, 0), sigma)
    return f / (f.std() + 1e-6)


def plain(rng: np.random.Generator) -> np.ndarray:
    f = 1 + rng.uniform(0, 0.12) * _noise(rng, rng.uniform(0.7, 25))
    return _colour(rng) * f[..., None]


def bands(rng: np.random.Generator) -> np.ndarray:
    """Stripes one way, plaid both ways."""
    cols = [_colour(rng) for _ in range(int(rng.integers(2, 5)))]

    def line() -> np.ndarray:
        out, i = np.zeros((SIZE, 3)), 0
        while i < SIZE:
            w = int(rng.integers(2, 40))
            out[i : i + w] = cols[int(rng.integers(len(cols)))]
            i += w
        return out

    a, b, u = line(), line(), rng.random()
    if u < 0.35:
        return np.repeat(a[None], SIZE, 0)
    return np.repeat(b[:, None], SIZE, 1) if u < 0.7 else 0.5 * a[None] + 0.5 * b[:, None]


def shapes(rng: np.random.Generator) -> np.ndarray:
    im = np.ascontiguousarray(np.tile(_colour(rng), (SIZE, SIZE, 1)))
    cols = [tuple(_colour(rng)) for _ in range(4)]
    for _ in range(int(rng.integers(10, 160))):
        x, y = (int(v) for v in rng.integers(0, SIZE, 2))
        s, c, u = int(rng.integers(2, 40)), cols[int(rng.integers(4))], rng.random()
        if u < 0.35:
            cv2.circle(im, (x, y), s // 2 + 1, c, -1, cv2.LINE_AA)
        elif u < 0.7:
            cv2.rectangle(im, (x, y), (x + s, y + int(rng.integers(2, 40))), c, -1)
        else:
            cv2.putText(im, chr(int(rng.integers(65, 91))), (x, y), 0, 0.3 + s / 30, c, 2, cv2.LINE_AA)
    return im


def marble(rng: np.random.Generator) -> np.ndarray:
    f = np.clip(0.5 + 0.35 * sum(_noise(rng, s) / k for k, s in enumerate((30, 10, 3), 1)), 0, 1)
    return _colour(rng) * f[..., None] + _colour(rng) * (1 - f[..., None])


def text(rng: np.random.Generator) -> np.ndarray:
    """A screen or a sheet of writing."""
    dark = rng.random() < 0.5
    im = np.full((SIZE, SIZE, 3), rng.uniform(0, 50) if dark else rng.uniform(190, 255))
    y = int(rng.integers(4, 14))
    while y < SIZE:
        if rng.random() < 0.85:
            c = _colour(rng) * 0.4 + (150 if dark else 0)
            x = 6 + 8 * int(rng.integers(0, 4))
            while x < SIZE * rng.uniform(0.4, 1):
                w = int(rng.integers(3, 22))
                im[y : y + 3, x : x + w] = c
                x += w + 4
        y += int(rng.integers(5, 9))
    if rng.random() < 0.5:
        x, y = (int(v) for v in rng.integers(0, SIZE - 90, 2))
        im[y : y + int(rng.integers(30, 90)), x : x + int(rng.integers(30, 90))] = _colour(rng)
    return im


PATTERNS = (plain, bands, shapes, marble)


def pattern(rng: np.random.Generator) -> np.ndarray:
    return PATTERNS[int(rng.choice(4, p=(0.45, 0.25, 0.15, 0.15)))](rng)


def u8(im: np.ndarray) -> np.ndarray:
    return np.clip(im, 0, 255).astype(np.uint8)


def read_rgb(path: str, most: int = 512) -> np.ndarray:
    im = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    if im.ndim == 2:
        im = cv2.cvtColor(im, cv2.COLOR_GRAY2BGR)
    s = most / max(im.shape[:2])
    if s < 1:
        im = cv2.resize(im, None, fx=s, fy=s, interpolation=cv2.INTER_AREA)
    return np.ascontiguousarray(im[..., 2::-1])


def read_alpha(path: str) -> np.ndarray:
    im = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    has = im.ndim == 3 and im.shape[2] == 4
    return np.ascontiguousarray(im[..., 3] if has else np.full(im.shape[:2], 255, np.uint8))


class TextureBank:
    """Numbers for textures, in groups that the scene chooses from."""

    def __init__(self, assets: str, rng: np.random.Generator, generated: int = 60):
        self.images: list[np.ndarray] = []
        self.alphas: list[np.ndarray] = []
        self._files: dict[str, int] = {}
        self._alpha_files: dict[str, int] = {}
        gen = os.path.join(assets, "gen_lo")
        files = lambda *names: [self.file(f) for n in names for f in sorted(glob.glob(f"{gen}/{n}*.png"))]
        self.pictures = files("photo", "poster", "whiteboard", "window")
        self.papers, self.keys, self.spines = files("paper"), files("keyb"), files("spines")
        self.papers += [self.add(u8(text(rng))) for _ in range(6)]
        self.screens = files("screen", "photo") + [self.add(u8(text(rng))) for _ in range(12)]
        self.patterns = [self.add(u8(pattern(rng))) for _ in range(generated)]
        furn = os.path.join(assets, "furn")
        woods = ["blendswap-cc-0/drawersCabinet/american_oak.jpg", "blendswap-cc-by/simpleDesk/Wood1.jpg"]
        self.woods = [self.file(os.path.join(furn, w)) for w in woods]
        self.walls = files("wall", "partition", "ceil") + self.patterns
        self.floors = files("carpet") + self.woods + self.patterns

    def add(self, im: np.ndarray) -> int:
        self.images.append(np.ascontiguousarray(im))
        return len(self.images) - 1

    def file(self, path: str) -> int:
        if path not in self._files:
            self._files[path] = self.add(read_rgb(path))
        return self._files[path]

    def alpha_file(self, path: str) -> int:
        if path not in self._alpha_files:
            self.alphas.append(read_alpha(path))
            self._alpha_files[path] = len(self.alphas) - 1
        return self._alpha_files[path]
