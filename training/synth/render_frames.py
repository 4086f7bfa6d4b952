# SPDX-License-Identifier: Apache-2.0
"""Renders training frames with exact boxes: python3 -m synth.render_frames OUT --count N --seed S

OUT gets NNNNNN.jpg, NNNNNN.mask.png and, last, NNNNNN.json; a stopped run resumes.
Frame k of seed S is the same on every run on the same machine."""
from __future__ import annotations

import argparse
import json
import os
import pathlib
import sys
import time

import cv2
import numpy as np

from detector.classes import CLASSES
from detector.files import write_whole
from .mesh import merged
from .people import Cast
from .props import PropShop
from .raster import Rasteriser, TextureTable, build
from .scene import Composer, Scene
from .textures import TextureBank

WIDTH, HEIGHT, SUPERSAMPLING = 400, 300, 2
Rng = np.random.Generator


def studio(render_dir: pathlib.Path, scratch: pathlib.Path, seed: int) -> tuple[Composer, Rasteriser]:
    sys.path.insert(0, str(render_dir))
    sys.dont_write_bytecode = True
    import mh_human

    rng = np.random.default_rng(seed)
    bank = TextureBank(str(render_dir / "assets"), rng)
    composer = Composer(PropShop(str(render_dir / "assets"), bank), Cast(mh_human, bank, rng))
    libs = build(render_dir, scratch)
    return composer, Rasteriser(libs, TextureTable(bank.images), TextureTable(bank.alphas))


def light(rng: Rng, iz: np.ndarray, n: np.ndarray, K: tuple[float, ...], scene: Scene) -> np.ndarray:
    """Ambient light, one to four lamps, darkening near occluders; [h, w, 3] linear."""
    h, w = iz.shape
    z = 1 / np.maximum(iz, 0.05)
    u, v = np.meshgrid(np.arange(w), np.arange(h))
    cam = np.stack([(u - K[2]) / K[0] * z, (v - K[3]) / K[1] * z, z], -1)
    X, N = cam @ scene.R.T + scene.p, n @ scene.R.T
    tint = lambda: 1 + rng.normal(0, 0.07) * np.array([1, 0.1, -1])
    out = rng.uniform(0.15, 0.8) * tint() * (0.65 + 0.35 * N[..., 2:])
    for _ in range(int(rng.integers(1, 5))):
        at = np.array([rng.uniform(-3, 3), rng.uniform(-0.5, 5), rng.uniform(1.6, 2.7)])
        d = at - X
        r = np.linalg.norm(d, axis=-1, keepdims=True)
        facing = np.clip((d * N).sum(-1, keepdims=True) / r, 0, 1)
        out = out + rng.uniform(0.2, 2.2) * tint() * facing / (0.6 + r * r * rng.uniform(0.1, 0.5))
    for sigma in (3, 9):
        hidden = np.clip((cv2.GaussianBlur(iz, (0, 0), sigma) - iz) / (iz + 1e-3), 0, 1)
        out = out * (1 - rng.uniform(0.2, 0.7) * hidden[..., None])
    return np.maximum(out, 0.01)


def developed(rng: Rng, lin: np.ndarray) -> np.ndarray:
    """8-bit BGR: exposure, white balance, tone curve, a little blur and noise."""
    level = np.percentile(lin.mean(-1), rng.uniform(50, 85)) + 1e-3
    lin = lin * rng.uniform(0.1, 0.45) / level * (1 + rng.normal(0, 0.06, 3))
    lin = (1 - np.exp(-1.3 * np.clip(lin, 0, None))) if rng.random() < 0.7 else np.clip(lin, 0, 1)
    im = 255 * np.power(lin, 1 / rng.uniform(1.8, 2.5))
    im = cv2.GaussianBlur(im, (0, 0), rng.uniform(0.3, 0.9))
    im += rng.normal(0, rng.uniform(0.5, 5), im.shape)
    return np.clip(im[..., ::-1] + 0.5, 0, 255).astype(np.uint8)


def box_of(mask: np.ndarray) -> list[int]:
    ys, xs = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    return [int(xs[0]), int(ys[0]), int(xs[-1]) + 1, int(ys[-1]) + 1]


def labels(scene: Scene, ob: np.ndarray, part: np.ndarray, K: tuple[float, ...]) -> tuple[list, list]:
    """Visible boxes [class, x0, y0, x1, y1]; those of scarcely visible things go to the second list."""
    keep, ignore = [], []

    def add(mask: np.ndarray, cls: str, whole_px: float) -> None:
        seen = int(mask.sum())
        if seen < 4:
            return
        b = box_of(mask)
        area = (b[2] - b[0]) * (b[3] - b[1])
        faint = seen < 18 or min(b[2] - b[0], b[3] - b[1]) < 4 or area < 0.06 * whole_px
        (ignore if faint else keep).append([CLASSES.index(cls), *b])

    for k, t in enumerate(scene.things, 1):
        if not t.cls:
            continue
        mask = ob == k
        if not mask.any():
            continue
        c = (t.mesh.v - scene.p) @ scene.R
        c = c[c[:, 2] > 0.1]
        uv = c[:, :2] / c[:, 2:] * [K[0], K[1]]
        uv = np.clip(uv + [K[2], K[3]], 0, [WIDTH, HEIGHT])
        add(mask, t.cls, float(np.prod(np.ptp(uv, axis=0))))
        if t.cls == "person":
            for p, cls in ((1, "head"), (2, "hand"), (3, "hand")):
                add(mask & (part == p), cls, 0)
    return keep, ignore


def frame(rng: Rng, composer: Composer, raster: Rasteriser) -> tuple[np.ndarray, dict, np.ndarray]:
    scene = composer.compose(rng)
    f = WIDTH * rng.uniform(0.68, 1.05)
    K = (f, f, WIDTH / 2 - 0.5 + rng.normal(0, 4), HEIGHT / 2 - 0.5 + rng.normal(0, 4))
    half = (f / 2, f / 2, (K[2] + 0.5) / 2 - 0.5, (K[3] + 0.5) / 2 - 0.5)
    mesh = merged([t.mesh for t in scene.things])
    ids = np.concatenate([np.full(len(t.mesh.tri), k) for k, t in enumerate(scene.things, 1)])
    raster.load(mesh, ids, scene.R, scene.p)
    _, ob, part = raster.maps(WIDTH, HEIGHT, K)
    low = raster.low(WIDTH // 2, HEIGHT // 2, half)
    lin = raster.shade(SUPERSAMPLING, WIDTH, HEIGHT, K, light(rng, low[0], low[2], half, scene), low)
    keep, ignore = labels(scene, ob, part, K)
    solid = np.array([False] + [t.cls != "" for t in scene.things])[ob]
    return developed(rng, lin), {"boxes": keep, "ignore": ignore}, solid


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__)
    ap.add_argument("out", type=pathlib.Path)
    ap.add_argument("--render", type=pathlib.Path, default=os.environ.get("YDD_RENDER", "../../shared/render"))
    ap.add_argument("--count", type=int, default=3000)
    ap.add_argument("--seed", type=int, default=1)
    ap.add_argument("--every", type=int, default=1, help="render frames START, START + EVERY, ...: for two processes")
    ap.add_argument("--start", type=int, default=0)
    args = ap.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    composer, raster = studio(pathlib.Path(args.render), args.out / ".lib", args.seed)
    start = time.time()
    for n, k in enumerate(range(args.start, args.count, args.every), 1):
        name = f"{k:06d}"
        if (args.out / f"{name}.json").exists():
            continue
        rng = np.random.default_rng([args.seed, k])
        image, truth, solid = frame(rng, composer, raster)
        cv2.imwrite(str(args.out / f"{name}.jpg"), image, [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(80, 96))])
        cv2.imwrite(str(args.out / f"{name}.mask.png"), solid.astype(np.uint8) * 255)
        write_whole(args.out / f"{name}.json", json.dumps(truth))
        if n % 100 == 0:
            print(f"{n} frames, {(time.time() - start) / n:.2f} s each", flush=True)


if __name__ == "__main__":
    main()
