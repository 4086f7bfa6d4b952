# SPDX-License-Identifier: Apache-2.0
"""Triangle meshes as plain arrays: primitives, OBJ files, transforms. Metres, z up."""
from __future__ import annotations

import dataclasses
import math
import os

import numpy as np

Vec = tuple[float, float, float]


@dataclasses.dataclass
class Mesh:
    v: np.ndarray  # [n, 3] float32 vertices
    tri: np.ndarray  # [m, 3] int32
    uv: np.ndarray  # [m, 6] float32, three texture coordinates a triangle
    tex: np.ndarray  # [m] int16, texture or -1
    col: np.ndarray  # [m, 3] float32 linear colour where there is no texture
    em: np.ndarray  # [m] float32 emission, 0: lit
    alpha: np.ndarray  # [m] int8, alpha texture or -1
    part: np.ndarray  # [m] uint8, 1 head, 2 left hand, 3 right hand, 0 anything else

    def moved(self, M: np.ndarray) -> "Mesh":
        v = (self.v @ M[:3, :3].T + M[:3, 3]).astype(np.float32)
        return dataclasses.replace(self, v=v)

    def painted(self, tex: int = -1, col: Vec | None = None, em: float = 0.0) -> "Mesh":
        m = len(self.tri)
        c = self.col if col is None else np.tile(np.float32(col), (m, 1))
        return dataclasses.replace(self, tex=np.full(m, tex, np.int16), col=c, em=np.full(m, em, np.float32))

    def with_vertices(self, v: np.ndarray) -> "Mesh":
        return dataclasses.replace(self, v=v.astype(np.float32))


def make(v: object, faces: list, uv: list | None = None) -> Mesh:
    """Polygons are cut into fans; `uv` holds one (u, v) a corner of `faces`, in order."""
    tri, tuv, at = [], [], 0
    for f in faces:
        c = [(0.0, 0.0)] * len(f) if uv is None else uv[at : at + len(f)]
        at += len(f)
        for k in range(1, len(f) - 1):
            tri.append((f[0], f[k], f[k + 1]))
            tuv.append((*c[0], *c[k], *c[k + 1]))
    m = len(tri)
    return Mesh(
        np.asarray(v, np.float32).reshape(-1, 3),
        np.asarray(tri, np.int32).reshape(-1, 3),
        np.asarray(tuv, np.float32).reshape(-1, 6),
        np.full(m, -1, np.int16),
        np.full((m, 3), 0.5, np.float32),
        np.zeros(m, np.float32),
        np.full(m, -1, np.int8),
        np.zeros(m, np.uint8),
    )


def merged(parts: list[Mesh]) -> Mesh:
    off = np.cumsum([0] + [len(p.v) for p in parts[:-1]])
    tri = np.concatenate([p.tri + o for p, o in zip(parts, off)]).astype(np.int32)
    cat = lambda k: np.concatenate([getattr(p, k) for p in parts])
    return Mesh(cat("v"), tri, *(cat(k) for k in ("uv", "tex", "col", "em", "alpha", "part")))


def pose(loc: Vec, yaw_deg: float = 0.0, pitch_deg: float = 0.0, roll_deg: float = 0.0) -> np.ndarray:
    """Turns about x by pitch, about y by roll, about z by yaw, then moves."""
    a, b, c = (math.radians(d) for d in (yaw_deg, pitch_deg, roll_deg))
    rz = np.array([[math.cos(a), -math.sin(a), 0], [math.sin(a), math.cos(a), 0], [0, 0, 1]])
    rx = np.array([[1, 0, 0], [0, math.cos(b), -math.sin(b)], [0, math.sin(b), math.cos(b)]])
    ry = np.array([[math.cos(c), 0, math.sin(c)], [0, 1, 0], [-math.sin(c), 0, math.cos(c)]])
    M = np.eye(4)
    M[:3, :3] = rz @ ry @ rx
    M[:3, 3] = loc
    return M


def box(size: Vec, tile_m: float | None = None) -> Mesh:
    """Centred in x and y, its base at z = 0. One texture repeat every `tile_m`, else one a face."""
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    v = [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)]
    v += [(a, b, z) for a, b, _ in v]
    f = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7), (3, 2, 1, 0)]
    w, d, h = size
    uv: list = []
    for a, b in ((w, h), (d, h), (w, h), (d, h), (w, d), (w, d)):
        a, b = (a / tile_m, b / tile_m) if tile_m else (1, 1)
        uv += [(0, 0), (a, 0), (a, b), (0, b)]
    return make(v, f, uv)


def quad(w: float, h: float, uvr: tuple[float, float, float, float] = (0, 0, 1, 1)) -> Mesh:
    """An upright picture in the xz plane that faces -y, its lower edge at z = 0."""
    a, b, c, d = uvr
    v = [(-w / 2, 0, 0), (w / 2, 0, 0), (w / 2, 0, h), (-w / 2, 0, h)]
    return make(v, [(0, 1, 2, 3)], [(a, b), (c, b), (c, d), (a, d)])


def lathe(profile: list[tuple[float, float]], segments: int = 20) -> Mesh:
    """(radius, height) turned about z."""
    n, v, f, uv = segments, [], [], []
    for r, z in profile:
        v += [(r * math.cos(2 * math.pi * k / n), r * math.sin(2 * math.pi * k / n), z) for k in range(n)]
    rows = len(profile) - 1
    for i in range(rows):
        for k in range(n):
            f.append((i * n + k, i * n + (k + 1) % n, (i + 1) * n + (k + 1) % n, (i + 1) * n + k))
            a, b, c, d = k / n, (k + 1) / n, i / rows, (i + 1) / rows
            uv += [(a, c), (b, c), (b, d), (a, d)]
    return make(v, f, uv)


def tube(points: np.ndarray, radius: float, segments: int = 8) -> Mesh:
    """A round bar along a polyline."""
    p = np.asarray(points, float)
    t = np.gradient(p, axis=0)
    t /= np.linalg.norm(t, axis=1, keepdims=True) + 1e-12
    up = np.where(np.abs(t[:, 2:]) > 0.9, [[1.0, 0, 0]], [[0, 0, 1.0]])
    a = np.cross(t, up)
    a /= np.linalg.norm(a, axis=1, keepdims=True) + 1e-12
    b = np.cross(t, a)
    ang = 2 * math.pi * np.arange(segments) / segments
    ring = a[:, None] * np.cos(ang)[None, :, None] + b[:, None] * np.sin(ang)[None, :, None]
    v = (p[:, None] + radius * ring).reshape(-1, 3)
    n = segments
    f = [
        (i * n + k, i * n + (k + 1) % n, (i + 1) * n + (k + 1) % n, (i + 1) * n + k)
        for i in range(len(p) - 1)
        for k in range(n)
    ]
    return make(v, f)


def rounded(size: Vec, power: float = 4.0, segments: int = 16) -> Mesh:
    """A superellipsoid: 2 an ellipsoid, large a box; centred in x and y, base at z = 0."""
    v, f, uv = [], [], []
    e = 2.0 / power
    s = lambda x: math.copysign(abs(x) ** e, x)
    m, n = segments, segments * 2
    for i in range(m + 1):
        a = -math.pi / 2 + math.pi * i / m
        for k in range(n):
            b = 2 * math.pi * k / n
            v.append(
                (
                    size[0] / 2 * s(math.cos(a)) * s(math.cos(b)),
                    size[1] / 2 * s(math.cos(a)) * s(math.sin(b)),
                    size[2] / 2 * (1 + s(math.sin(a))),
                )
            )
    for i in range(m):
        for k in range(n):
            q = (k + 1) % n
            f.append((i * n + k, i * n + q, (i + 1) * n + q, (i + 1) * n + k))
            a, b, c, d = 2 * k / n, 2 * (k + 1) / n, i / m, (i + 1) / m
            uv += [(a, c), (b, c), (b, d), (a, d)]
    return make(v, f, uv)


def _materials(path: str) -> dict[str, tuple[Vec, str | None]]:
    out: dict[str, tuple[Vec, str | None]] = {}
    name, kd, image = "", (0.6, 0.6, 0.6), None
    with open(path, errors="replace") as lines:
        for line in lines:
            w = line.split()
            if not w:
                continue
            if w[0] == "newmtl":
                name, kd, image = " ".join(w[1:]), (0.6, 0.6, 0.6), None
            elif w[0] == "Kd":
                kd = tuple(min(0.85, max(0.02, float(x))) for x in w[1:4])
            elif w[0] == "map_Kd":
                file = os.path.join(os.path.dirname(path), line.strip()[7:].strip())
                image = file if os.path.exists(file) else None
            out[name] = (kd, image)
    return out


def load_obj(path: str, texture_of: object) -> Mesh:
    """An OBJ file (y up) with its MTL; `texture_of(file)` gives the number of a texture."""
    v, vt, faces, uv, names = [], [], [], [], []
    mats = _materials(path[:-4] + ".mtl") if os.path.exists(path[:-4] + ".mtl") else {}
    current = ""
    with open(path, errors="replace") as lines:
        for line in lines:
            w = line.split()
            if not w:
                continue
            if w[0] == "v":
                v.append((float(w[1]), -float(w[3]), float(w[2])))
            elif w[0] == "vt":
                vt.append((float(w[1]), float(w[2])))
            elif w[0] == "usemtl":
                current = " ".join(w[1:])
            elif w[0] == "f":
                c = [x.split("/") for x in w[1:]]
                ids = [int(x[0]) for x in c]
                ids = [i - 1 if i > 0 else len(v) + i for i in ids]
                if len(ids) < 3:
                    continue
                faces.append(ids)
                ts = [int(x[1]) if len(x) > 1 and x[1] else 0 for x in c]
                uv += [vt[t - 1 if t > 0 else len(vt) + t] if t and vt else (0.0, 0.0) for t in ts]
                names += [current] * (len(ids) - 2)
    out = make(v, faces, uv)
    for name in set(names):
        at = np.array([n == name for n in names])
        kd, image = mats.get(name, ((0.6, 0.6, 0.6), None))
        out.col[at] = kd
        out.tex[at] = texture_of(image) if image else -1
    return out


def fitted(m: Mesh, height: float | None = None, width: float | None = None) -> Mesh:
    """Centred in x and y with its base at z = 0, scaled to a height (z) or a width (x) in metres."""
    lo, hi = m.v.min(0), m.v.max(0)
    s = height / (hi[2] - lo[2]) if height else (width or 1.0) / (hi[0] - lo[0])
    return m.with_vertices((m.v - [(lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2, lo[2]]) * s)
