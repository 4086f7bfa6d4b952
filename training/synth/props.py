# SPDX-License-Identifier: Apache-2.0
"""Things of an office: library models in random size and colour, and procedural ones."""
from __future__ import annotations

import math
import os

import numpy as np

from .mesh import Mesh, box, fitted, lathe, load_obj, merged, pose, quad, rounded, tube
from .textures import TextureBank

Rng = np.random.Generator
BLACK, DARK, METAL, PAPER = (0.012,) * 3, (0.04, 0.04, 0.045), (0.25, 0.25, 0.27), (0.7, 0.68, 0.6)


def tone(rng: Rng) -> tuple[float, float, float]:
    """A linear colour: half of them grey, from black to white."""
    if rng.random() < 0.5:
        g = float(rng.choice([0.015, 0.04, 0.1, 0.3, 0.6, 0.8]) * rng.uniform(0.7, 1.2))
        return (g, g, g)
    c = rng.uniform(0.01, 0.7, 3)
    return (float(c[0]), float(c[1]), float(c[2]))


class PropShop:
    """Makes props; each stands on z = 0, faces -y, and is in metres."""

    MODELS = {
        "chair": (("katorlegaz/office-chair", 0.98), ("blendswap-cc-0/chair2", 0.85), ("blendswap-cc-0/chair", 0.9)),
        "cup": (("katorlegaz/coffee-mug", 0.1), ("blendswap-cc-by/coffee_cup", 0.085), ("scopia/cup", 0.09)),
        "bottle": (("katorlegaz/red-wine-bottle-01", 0.29), ("katorlegaz/spray-bottle", 0.25)),
        "laptop": (("blendswap-cc-by/laptop", 0.24),),
        "phone": (("blendswap-cc-by/wirelessOfficePhone3", 0.06),),
        "clutter": (
            ("scopia/penbox", 0.17),
            ("blendswap-cc-0/littlePlant", 0.3),
            ("scopia/desk_lamp1", 0.45),
            ("scopia/letters_box", 0.07),
            ("scopia/office_box", 0.25),
            ("blendswap-cc-0/basketball", 0.24),
        ),
        "furniture": (
            ("katorlegaz/filing-cabinet", 1.0),
            ("blendswap-cc-by/mediumIndoorPlant", 1.15),
            ("scopia/cardboard-box", 0.35),
            ("scopia/open-cardboard-box", 0.4),
            ("katorlegaz/recycling-bin", 0.5),
            ("blendswap-cc-0/dustbin", 0.35),
        ),
    }

    def __init__(self, assets: str, bank: TextureBank):
        self.bank = bank
        self._models: dict[str, list[Mesh]] = {}
        for cls, entries in self.MODELS.items():
            self._models[cls] = [self._load(os.path.join(assets, "furn", p), h) for p, h in entries]

    def _load(self, folder: str, height: float) -> Mesh:
        return fitted(load_obj(f"{folder}/{os.path.basename(folder)}.obj", self.bank.file), height=height)

    def model(self, cls: str, rng: Rng) -> Mesh:
        """A library model, in a new size and, often, new colours for its materials."""
        ms = self._models[cls]
        m = ms[int(rng.integers(len(ms)))]
        m = m.with_vertices(m.v * (rng.uniform(0.88, 1.15) * rng.uniform(0.93, 1.07, 3)))
        if rng.random() < 0.65:
            m = self._recoloured(m, rng)
        return m

    def _recoloured(self, m: Mesh, rng: Rng) -> Mesh:
        col, tex = m.col.copy(), m.tex.copy()
        kinds, which = np.unique(np.column_stack([m.col, m.tex]), axis=0, return_inverse=True)
        for k in range(len(kinds)):
            at = which.ravel() == k
            col[at] = tone(rng)
            if rng.random() < 0.25:
                tex[at] = self.pick(rng, self.bank.patterns)
            elif rng.random() < 0.5:
                tex[at] = -1
        out = m.painted(col=None)
        out.col, out.tex, out.em = col, tex, m.em
        return out

    @staticmethod
    def pick(rng: Rng, numbers: list[int]) -> int:
        return numbers[int(rng.integers(len(numbers)))]

    def surface(self, rng: Rng, m: Mesh, patterned: float = 0.3) -> Mesh:
        return m.painted(self.pick(rng, self.bank.patterns) if rng.random() < patterned else -1, tone(rng))

    # ---- procedural things
    def make(self, cls: str, rng: Rng) -> Mesh:
        own = getattr(self, "_" + cls, None)
        if own and (cls not in self._models or rng.random() < 0.6):
            return own(rng)
        return self.model(cls, rng)

    def _chair(self, rng: Rng) -> Mesh:
        fabric = lambda m: m.painted(self.pick(rng, self.bank.patterns) if tex else -1, colour)
        tex, colour, frame = rng.random() < 0.3, tone(rng), tone(rng)
        w, d, h = rng.uniform(0.4, 0.54), rng.uniform(0.4, 0.52), rng.uniform(0.42, 0.52)
        thick, back = rng.uniform(0.04, 0.1), rng.uniform(0.3, 0.7)
        parts = [fabric(rounded((w, d, thick), rng.uniform(3, 9), 10)).moved(pose((0, 0, h)))]
        gap = rng.uniform(0.02, 0.2)
        lean = rng.uniform(3, 16)
        panel = fabric(rounded((w * rng.uniform(0.8, 1), 0.05, back), rng.uniform(3, 9), 10))
        parts.append(panel.moved(pose((0, d / 2, h + gap), 0, -lean)))
        bar = lambda a, b, r=0.014: tube(np.linspace(a, b, 3), r, 6).painted(col=frame)
        parts.append(bar((0, d / 2, h), (0, d / 2 + 0.02, h + gap + 0.1), 0.025))
        if rng.random() < 0.6:  # a column with five wheels
            parts.append(bar((0, 0, 0.08), (0, 0, h), 0.028))
            for k in range(5):
                a = 2 * math.pi * (k / 5) + 0.3
                end = (0.3 * math.cos(a), 0.3 * math.sin(a), 0.06)
                parts.append(bar((0, 0, 0.1), end, 0.02))
                parts.append(rounded((0.05, 0.05, 0.05), 2, 5).painted(col=BLACK).moved(pose((end[0], end[1], 0))))
        else:
            for sx in (-1, 1):
                for sy in (-1, 1):
                    top = (sx * w * 0.42, sy * d * 0.42, h)
                    parts.append(bar((sx * w * 0.48, sy * d * 0.5, 0), top))
        if rng.random() < 0.5:
            for sx in (-1, 1):
                x = sx * (w / 2 + 0.03)
                parts.append(box((0.05, d * 0.6, 0.03)).painted(col=frame).moved(pose((x, 0, h + 0.2))))
                parts.append(bar((x, 0, h), (x, 0, h + 0.2)))
        return merged(parts)

    def _monitor(self, rng: Rng) -> Mesh:
        w = rng.uniform(0.36, 0.62)
        h = w / rng.choice([1.25, 1.33, 1.6, 1.78])
        shell, up, rim = (tone(rng) if rng.random() < 0.4 else DARK, rng.uniform(0.06, 0.2), rng.uniform(0.01, 0.035))
        parts = [
            box((w * 0.45, 0.2, 0.018)).painted(col=shell),
            box((0.06, 0.04, up + 0.1)).painted(col=shell).moved(pose((0, 0.05, 0))),
            box((w, 0.045, h)).painted(col=shell).moved(pose((0, 0, up))),
        ]
        if rng.random() < 0.2:  # a tube
            parts.append(rounded((w * 0.8, 0.4, h * 0.85), 6, 8).painted(col=shell).moved(pose((0, 0.2, up + 0.02))))
        face = quad(w - 2 * rim, h - 2 * rim).moved(pose((0, -0.024, up + rim)))
        if rng.random() < 0.3:
            face = face.painted(col=(rng.uniform(0.005, 0.05),) * 3)
        else:
            face = face.painted(self.pick(rng, self.bank.screens), em=rng.uniform(0.25, 1.1))
        return merged([*parts, face])

    def _keyboard(self, rng: Rng) -> Mesh:
        w, d, t = rng.uniform(0.3, 0.47), rng.uniform(0.12, 0.19), 0.018
        body = box((w, d, t)).painted(col=tone(rng))
        top = quad(w * 0.97, d * 0.94).moved(pose((0, -d * 0.47, t + 0.001), 0, -88))
        if rng.random() < 0.4:
            return merged([body, self._own_keys(rng, w, d).moved(pose((0, 0, t)))])
        return merged([body, top.painted(self.pick(rng, self.bank.keys))])

    @staticmethod
    def _own_keys(rng: Rng, w: float, d: float) -> Mesh:
        col, n, rows = tone(rng), int(rng.integers(13, 20)), int(rng.integers(4, 7))
        sx, sy = w * 0.96 / n, d * 0.9 / rows
        at = lambda i, k: pose(((i - (n - 1) / 2) * sx, (k - (rows - 1) / 2) * sy, 0))
        key = box((sx * 0.8, sy * 0.78, 0.006)).painted(col=col)
        return merged([key.moved(at(i, k)) for i in range(n) for k in range(rows)])

    def _mouse(self, rng: Rng) -> Mesh:
        w, d, h = rng.uniform(0.055, 0.07), rng.uniform(0.09, 0.125), rng.uniform(0.03, 0.042)
        return rounded((w, d, h), rng.uniform(2, 3), 10).painted(col=tone(rng) if rng.random() < 0.6 else DARK)

    def _cup(self, rng: Rng) -> Mesh:
        h, r, out = rng.uniform(0.07, 0.13), rng.uniform(0.03, 0.045), rng.uniform(0.85, 1.3)
        shape = [
            (0, 0),
            (r, 0),
            (r * (1 + out) / 2, h / 2),
            (r * out, h),
            (r * out * 0.92, h),
            (r * 0.9, 0.01),
            (0, 0.01),
        ]
        body = self.surface(rng, lathe(shape, 18), 0.35)
        if rng.random() < 0.35:
            return body
        a = np.linspace(-math.pi / 2, math.pi / 2, 9)
        ring = np.stack([r * out + 0.025 * np.cos(a), 0 * a, h * 0.5 + h * 0.3 * np.sin(a)], 1)
        return merged([body, tube(ring, 0.005, 6).painted(col=tuple(body.col[0]))])

    def _bottle(self, rng: Rng) -> Mesh:
        h, r = rng.uniform(0.17, 0.33), rng.uniform(0.028, 0.046)
        n, s = r * rng.uniform(0.25, 0.5), rng.uniform(0.5, 0.75)
        glass, cap = tone(rng), tone(rng)
        body = lathe([(0, 0), (r, 0), (r, h * s), (n * 1.3, h * 0.85), (n, h * 0.93)], 18).painted(col=glass)
        parts = [body, lathe([(n * 1.15, h * 0.92), (n * 1.15, h), (0, h)], 12).painted(col=cap)]
        if rng.random() < 0.7:
            label = lathe([(r * 1.01, h * s * 0.3), (r * 1.01, h * s * 0.85)], 18)
            parts.append(label.painted(self.pick(rng, self.bank.patterns + self.bank.pictures)))
        return merged(parts)

    def _book(self, rng: Rng) -> Mesh:
        w, d, t = rng.uniform(0.12, 0.22), rng.uniform(0.17, 0.3), rng.uniform(0.01, 0.06)
        cover = self.pick(rng, self.bank.pictures + self.bank.patterns)
        parts = [box((w - 0.006, d - 0.006, t * 0.9)).painted(col=PAPER).moved(pose((0, 0, t * 0.05)))]
        if rng.random() < 0.2:  # open
            page = (
                lambda s: box((w, d, t * 0.5))
                .painted(self.pick(rng, self.bank.papers))
                .moved(pose((s * w / 2, 0, 0), 0, 0, -s * 4))
            )
            return merged([page(-1), page(1)])
        lid = lambda z: box((w, d, max(0.002, t * 0.06))).painted(cover).moved(pose((0, 0, z)))
        spine = box((0.006, d, t)).painted(col=tone(rng)).moved(pose((-w / 2, 0, 0)))
        return merged([*parts, lid(0), lid(t * 0.95), spine])

    def _laptop(self, rng: Rng) -> Mesh:
        w, d, col = rng.uniform(0.29, 0.39), rng.uniform(0.2, 0.27), tone(rng)
        open_deg, up = rng.uniform(-30, 15), d * rng.uniform(0.9, 1.0)
        keys = quad(w * 0.9, d * 0.5).moved(pose((0, -d * 0.1, 0.021), 0, -90)).painted(self.pick(rng, self.bank.keys))
        lit = rng.random() < 0.75
        screen = quad(w * 0.93, up * 0.9).moved(pose((0, -0.006, up * 0.05)))
        screen = screen.painted(self.pick(rng, self.bank.screens), em=0.7) if lit else screen.painted(col=BLACK)
        lid = merged([box((w, 0.01, up)).painted(col=col), screen]).moved(pose((0, d / 2, 0.018), 0, open_deg))
        return merged([box((w, d, 0.02)).painted(col=col), keys, lid])

    def _phone(self, rng: Rng) -> Mesh:
        w, d = rng.uniform(0.06, 0.08), rng.uniform(0.12, 0.16)
        face = quad(w * 0.92, d * 0.9).moved(pose((0, -d * 0.45, 0.0092), 0, -90))
        lit = rng.random() < 0.6
        face = face.painted(self.pick(rng, self.bank.screens), em=0.6) if lit else face.painted(col=BLACK)
        return merged([rounded((w, d, 0.009), 9, 8).painted(col=tone(rng)), face])

    def _bag(self, rng: Rng) -> Mesh:
        w, d, h = rng.uniform(0.25, 0.42), rng.uniform(0.12, 0.24), rng.uniform(0.25, 0.5)
        body = self.surface(rng, rounded((w, d, h), rng.uniform(2.8, 6), 14), 0.4)
        strap = tone(rng) if rng.random() < 0.6 else tuple(body.col[0])
        arc = lambda rx, rz, n=12: np.stack(
            [(a := np.linspace(0, math.pi, n)) * 0 + rx * np.cos(a), 0 * a, rz * np.sin(a)], 1
        )
        parts = [body, tube(arc(w * 0.25, rng.uniform(0.06, 0.2)) + [0, 0, h * 0.93], 0.009, 6).painted(col=strap)]
        if rng.random() < 0.65:  # backpack: pocket and shoulder straps
            pocket = self.surface(rng, rounded((w * 0.75, d * 0.5, h * 0.45), 4, 10), 0.4)
            parts.append(pocket.moved(pose((0, -d * 0.45, h * 0.08))))
            for sx in (-1, 1):
                side = arc(h * 0.4, 0.1)[:, [1, 2, 0]] + [sx * w * 0.28, d * 0.45, h * 0.5]
                parts.append(tube(side, 0.014, 6).painted(col=strap))
        return merged(parts)

    def _fan(self, rng: Rng) -> Mesh:
        """A desk or standing fan: cage, blades, motor, foot."""
        r, up, col = rng.uniform(0.11, 0.24), rng.uniform(0.2, 1.1), tone(rng)
        ring = lambda q, y: tube(
            np.stack([q * np.cos(a := np.linspace(0, 2 * math.pi, 28)), 0 * a + y, q * np.sin(a)], 1), 0.004, 5
        )
        cage = [ring(r, y) for y in (-0.035, 0.035)] + [ring(r * k, -0.05) for k in (0.35, 0.7)]
        for k in range(int(rng.integers(12, 30))):
            a = 2 * math.pi * rng.random()
            c = np.array([math.cos(a), 0, math.sin(a)])
            cage.append(tube(np.array([c * r * 0.1 + [0, -0.055, 0], c * r + [0, -0.03, 0]]), 0.002, 4))
        n, turn = int(rng.integers(3, 6)), rng.uniform(0, 360)
        blade = rounded((r * 0.5, 0.008, r * 0.92), 2.3, 8).moved(pose((0, 0, 0), 20))
        blades = [blade.painted(col=tone(rng) if k == 0 else None) for k in range(1)] * n
        spin = [b.moved(pose((0, 0, 0), 0, 0, turn + 360 * k / n)) for k, b in enumerate(blades)]
        hub = (
            lathe([(0, -0.06), (0.04, -0.05), (0.05, 0.1), (0, 0.12)], 12)
            .moved(pose((0, 0, 0), 0, -90))
            .painted(col=col)
        )
        head = merged([merged(cage).painted(col=tone(rng)), *spin, hub]).moved(
            pose((0, 0, up + r), 0, rng.uniform(-20, 10))
        )
        pole = tube(np.array([[0, 0.03, 0], [0, 0.03, up + r]]), 0.015, 8).painted(col=col)
        foot = lathe([(0, 0), (r * 0.9, 0), (r * 0.85, 0.03), (0, 0.05)], 20).painted(col=col)
        return merged([foot, pole, head])

    def _clutter(self, rng: Rng) -> Mesh:
        """Anything small that has no class."""
        size = tuple(rng.uniform(0.03, 0.25, 3))
        u = rng.random()
        if u < 0.4:
            return self.surface(rng, rounded(size, rng.uniform(2, 8), 8), 0.6)
        if u < 0.7:
            return box((0.21, 0.297, 0.002)).painted(self.pick(rng, self.bank.papers))
        return self.model("clutter", rng)

    # ---- furniture without a class
    def desk(self, rng: Rng, w: float, d: float, h: float) -> Mesh:
        top = box((w, d, 0.03), rng.uniform(0.6, 1.2)).moved(pose((0, 0, h - 0.03)))
        wood = rng.random() < 0.5
        top = top.painted(self.pick(rng, self.bank.woods)) if wood else self.surface(rng, top, 0.4)
        leg_col, parts = tone(rng), [top]
        for sx in (-1, 1):
            for sy in (-1, 1):
                parts.append(
                    box((0.05, 0.05, h - 0.03)).painted(col=leg_col).moved(pose((sx * w * 0.46, sy * d * 0.43, 0)))
                )
        if rng.random() < 0.3:
            parts.append(box((w * 0.92, 0.02, h * 0.6)).painted(col=leg_col).moved(pose((0, d * 0.43, h * 0.3))))
        return merged(parts)

    def shelf(self, rng: Rng) -> tuple[Mesh, list[Mesh]]:
        """A shelf and the rows of books in it."""
        w, h, d, rows = rng.uniform(0.6, 1.4), rng.uniform(0.7, 2.0), 0.28, 0
        rows = max(2, int(h / 0.37))
        wood = self.pick(rng, self.bank.woods)
        plank = lambda size, at: box(size, 0.8).painted(wood).moved(pose(at))
        frame = [plank((0.025, d, h), (s * w / 2, 0, 0)) for s in (-1, 1)] + [plank((w, 0.01, h), (0, d / 2, 0))]
        frame += [plank((w, d, 0.022), (0, 0, r * (h - 0.022) / rows)) for r in range(rows + 1)]
        books = []
        for r in range(rows):
            x, z, hh = -w / 2 + 0.03, r * (h - 0.022) / rows + 0.022, min(0.27, h / rows - 0.06)
            while x < w / 2 - 0.12:
                bw = min(rng.uniform(0.1, 0.4), w / 2 - 0.03 - x)
                u = rng.uniform(0, 0.5)
                row = (
                    quad(bw, hh, (u, 0, u + bw, 1)).painted(self.pick(rng, self.bank.spines)).moved(pose((0, -0.09, 0)))
                )
                side = box((bw, 0.17, hh * 0.9)).painted(col=PAPER)
                if rng.random() < 0.8:
                    books.append(merged([row, side]).moved(pose((x + bw / 2, 0, z))))
                x += bw + (0 if rng.random() < 0.6 else rng.uniform(0.05, 0.25))
        return merged(frame), books

    def furniture(self, rng: Rng) -> Mesh:
        if rng.random() < 0.5:
            return self.surface(rng, box(tuple(rng.uniform(0.3, 1.1, 3)), 0.9), 0.5)
        return self.model("furniture", rng)
