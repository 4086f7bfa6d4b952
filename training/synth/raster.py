# SPDX-License-Identifier: Apache-2.0
"""The renderer's C rasteriser and shader (shared/render: rast.c, shade.c) behind one class."""
from __future__ import annotations

import ctypes
import pathlib
import subprocess

import numpy as np

from .mesh import Mesh


def build(source: pathlib.Path, into: pathlib.Path) -> tuple[ctypes.CDLL, ctypes.CDLL]:
    into.mkdir(parents=True, exist_ok=True)
    libs = []
    for name, extra in (("rast", []), ("shade", ["-ffast-math"])):
        so = into / f"{name}.so"
        if not so.exists():
            flags = ["-O3", "-march=native", "-shared", "-fPIC", *extra]
            tmp = so.with_suffix(f".{id(so)}.tmp")
            subprocess.run(["gcc", *flags, "-o", tmp, source / f"{name}.c", "-lm"], check=True)
            tmp.rename(so)
        libs.append(ctypes.CDLL(str(so)))
    return libs[0], libs[1]


def _p(a: np.ndarray) -> ctypes.c_void_p:
    return a.ctypes.data_as(ctypes.c_void_p)


class TextureTable:
    """Textures as the C code wants them: pointers, widths, heights."""

    def __init__(self, images: list[np.ndarray]):
        self.images = [np.ascontiguousarray(i) for i in images] or [np.zeros((1, 1, 3), np.uint8)]
        n = len(self.images)
        self.pointers = (ctypes.c_void_p * n)(*[i.ctypes.data for i in self.images])
        self.widths = (ctypes.c_int * n)(*[i.shape[1] for i in self.images])
        self.heights = (ctypes.c_int * n)(*[i.shape[0] for i in self.images])


class Rasteriser:
    def __init__(self, libs: tuple[ctypes.CDLL, ctypes.CDLL], colour: TextureTable, alpha: TextureTable):
        self.rast, self.shader = libs
        self.colour, self.alpha = colour, alpha

    def load(self, mesh: Mesh, ids: np.ndarray, R: np.ndarray, p: np.ndarray) -> None:
        """`R`, `p`: camera to world of the optical frame (x right, y down, z forward)."""
        c = np.ascontiguousarray
        self.v = c((mesh.v.astype(np.float64) - p) @ R, np.float32)
        self.tri, self.uv = c(mesh.tri, np.int32), c(mesh.uv, np.float32)
        self.id, self.part = c(ids, np.uint16), c(mesh.part, np.uint8)
        self.al, self.ct = c(mesh.alpha, np.int8), c(mesh.tex, np.int16)
        self.col, self.em = c(mesh.col, np.float32), c(mesh.em, np.float32)

    def maps(self, w: int, h: int, K: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Depth (0: nothing), object ids, parts at pixel centres."""
        z = np.full((h, w), np.inf, np.float32)
        ob, part = np.zeros((h, w), np.uint16), np.zeros((h, w), np.uint8)
        f, a = ctypes.c_float, self.alpha
        self.rast.raster(
            len(self.tri),
            _p(self.v),
            _p(self.tri),
            _p(self.uv),
            _p(self.id),
            _p(self.part),
            _p(self.al),
            a.pointers,
            a.widths,
            a.heights,
            w,
            h,
            *(f(k) for k in K),
            f(0.05),
            _p(z),
            _p(ob),
            _p(part),
        )
        z[np.isinf(z)] = 0
        return z, ob, part

    def _head(self) -> tuple:
        a = self.alpha
        return (
            len(self.tri),
            _p(self.v),
            _p(self.tri),
            _p(self.uv),
            _p(self.al),
            a.pointers,
            a.widths,
            a.heights,
            _p(self.id),
        )

    def low(self, w: int, h: int, K: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Inverse depth, ids and normals (camera frame) of a small picture for the light."""
        iz, ob = np.zeros((h, w), np.float32), np.zeros((h, w), np.uint16)
        n = np.zeros((h, w, 3), np.float32)
        k = [ctypes.c_float(x) for x in K]
        self.shader.lowmaps(*self._head(), w, h, *k, _p(iz), _p(ob), _p(n))
        return iz, ob, n

    def shade(self, ss: int, w: int, h: int, K: tuple[float, ...], light: np.ndarray, low: tuple) -> np.ndarray:
        """Linear RGB [h, w, 3]: supersampled albedo times the light of the small picture."""
        iz, ob, n = low
        out, light = np.zeros((h, w, 3), np.float32), np.ascontiguousarray(light, np.float32)
        t, k = self.colour, [ctypes.c_float(x) for x in K]
        self.shader.shade(
            *self._head(),
            _p(self.ct),
            _p(self.col),
            _p(self.em),
            t.pointers,
            t.widths,
            t.heights,
            ss,
            w,
            h,
            *k,
            iz.shape[1],
            iz.shape[0],
            _p(light),
            _p(iz),
            _p(ob),
            _p(n),
            _p(out),
        )
        return out
