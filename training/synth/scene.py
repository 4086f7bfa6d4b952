# SPDX-License-Identifier: Apache-2.0
"""Random arrangements: a room, desks with things on them, chairs, people, a camera.

World: z up, the camera stands near the origin and looks along +y; metres."""
from __future__ import annotations

import dataclasses
import math

import numpy as np

from .mesh import Mesh, box, pose, quad
from .people import Cast
from .props import PropShop

Rng = np.random.Generator


@dataclasses.dataclass
class Thing:
    mesh: Mesh
    cls: str | None  # None: has no class; "" : the room itself


@dataclasses.dataclass
class Scene:
    things: list[Thing]
    R: np.ndarray  # camera to world, optical frame
    p: np.ndarray


def look(pitch_deg: float, yaw_deg: float, roll_deg: float) -> np.ndarray:
    """Optical frame (x right, y down, z forward) of a camera that looks along +y, then turns."""
    base = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    turn = pose((0, 0, 0), yaw_deg)[:3, :3] @ pose((0, 0, 0), 0, pitch_deg)[:3, :3]
    c, s = math.cos(math.radians(roll_deg)), math.sin(math.radians(roll_deg))
    return turn @ base @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


class Composer:
    def __init__(self, shop: PropShop, cast: Cast):
        self.shop, self.cast, self.bank = shop, cast, shop.bank

    def compose(self, rng: Rng) -> Scene:
        kind = rng.choice(["office", "desk", "portrait", "walk"], p=[0.36, 0.26, 0.16, 0.22])
        self.rng, self.things, self.taken = rng, [], []
        return getattr(self, "_" + kind)()

    # ---- pieces
    def _add(self, mesh: Mesh, cls: str | None, M: np.ndarray) -> None:
        self.things.append(Thing(mesh.moved(M), cls))

    def _n(self, *p: float) -> int:
        """0, 1, 2, ... with these weights."""
        return int(self.rng.choice(len(p), p=np.array(p) / sum(p)))

    def _room(self, depth: float, half: float, high: float) -> None:
        rng, bank, pick = self.rng, self.bank, self.shop.pick
        wall = pick(rng, bank.walls)
        slab = lambda size, at, tex: self._add(box(size, rng.uniform(0.5, 1.6)).painted(tex), "", pose(at))
        slab((2 * half + 2, depth + 3, 0.02), (0, depth / 2, -0.02), pick(rng, bank.floors))
        slab((2 * half + 2, depth + 3, 0.02), (0, depth / 2, high), pick(rng, bank.walls))
        slab((2 * half + 2, 0.1, high), (0, depth, 0), wall)
        for s in (-1, 1):
            slab(
                (0.1, depth + 3, high), (s * half, depth / 2, 0), wall if rng.random() < 0.7 else pick(rng, bank.walls)
            )
        for _ in range(int(rng.integers(0, 8))):
            w, h = rng.uniform(0.2, 1.5), rng.uniform(0.2, 1.1)
            M = pose((rng.uniform(-half, half), depth - 0.06, rng.uniform(0.6, high - 0.6)))
            if rng.random() < 0.4:
                s = rng.choice([-1, 1])
                M = pose((s * (half - 0.06), rng.uniform(0.5, depth), rng.uniform(0.6, high - 0.6)), -90 * s)
            tex = pick(rng, bank.pictures + bank.papers + bank.patterns[:20])
            self._add(quad(w, h).painted(tex, em=1.3 if rng.random() < 0.08 else 0.0), "", M)

    def _spot(self, near: float, far: float, spread: float, gap: float) -> tuple[float, float] | None:
        """A free place in front of the camera."""
        for _ in range(12):
            y = self.rng.uniform(near, far)
            x = y * self.rng.uniform(-spread, spread)
            if all(math.hypot(x - a, y - b) > gap + r for a, b, r in self.taken):
                self.taken.append((x, y, gap))
                return x, y
        return None

    def _on_desk(self, M: np.ndarray, w: float, d: float, h: float, full: float) -> None:
        """Things on a desk whose front is its -y side."""
        rng, shop, spots = self.rng, self.shop, []

        def put(cls: str, x: float, y: float, yaw: float, z: float = 0.0, r: float = 0.0) -> None:
            if any(math.hypot(x - a, y - b) < r + c for a, b, c in spots):
                return
            spots.append((x, y, r))
            self._add(shop.make(cls, rng), None if cls == "clutter" else cls, M @ pose((x, y, h + z), yaw))

        free = lambda: (rng.uniform(-w * 0.47, w * 0.47), rng.uniform(-d * 0.45, d * 0.4))
        n = self._n(0.2, 0.5, 0.3) if w > 1.1 else self._n(0.3, 0.7)
        for k in range(n):
            x = (k - (n - 1) / 2) * 0.62 + rng.normal(0, 0.08)
            put("monitor", x, d * 0.25 + rng.normal(0, 0.05), rng.normal(0, 14), r=0.2)
            if rng.random() < 0.75:
                put("keyboard", x + rng.normal(0, 0.1), -d * 0.2 + rng.normal(0, 0.05), rng.normal(0, 12), r=0.1)
            if rng.random() < 0.75:
                put("mouse", x + rng.uniform(0.26, 0.42), -d * 0.2 + rng.normal(0, 0.06), rng.normal(0, 25), r=0.03)
        odds = (("laptop", 0.3, 0.18), ("fan", 0.14, 0.12), ("bag", 0.1, 0.15))
        for cls, chance, r in odds:
            if rng.random() < chance * full:
                put(cls, *free(), rng.normal(0, 40), r=r)
        many = (
            ("cup", 1.3, 0.04),
            ("bottle", 0.9, 0.04),
            ("phone", 0.8, 0.05),
            ("book", 1.0, 0.1),
            ("clutter", 3.5, 0.06),
        )
        for cls, mean, r in many:
            for _ in range(int(rng.poisson(mean * full))):
                put(cls, *free(), rng.uniform(0, 360), r=r)
        for _ in range(int(rng.poisson(0.5 * full))):  # a pile of books
            (x, y), z, yaw = free(), 0.0, rng.uniform(0, 360)
            for _ in range(int(rng.integers(2, 6))):
                book = shop.make("book", rng)
                self._add(book, "book", M @ pose((x, y, h + z), yaw + rng.normal(0, 12)))
                z += float(np.ptp(book.v[:, 2]))

    def _desk_at(self, x: float, y: float, yaw: float, full: float = 1.0) -> None:
        rng = self.rng
        w, d, h = rng.uniform(1.1, 2.0), rng.uniform(0.6, 0.9), rng.uniform(0.68, 0.78)
        M = pose((x, y, 0), yaw)
        self._add(self.shop.desk(rng, w, d, h), None, M)
        self._on_desk(M, w, d, h, full)
        if rng.random() < 0.55:
            seat = M @ pose((rng.normal(0, 0.2), -d / 2 - rng.uniform(0.1, 0.5), 0), 180 + rng.normal(0, 35))
            self._add(self.shop.make("chair", rng), "chair", seat)

    def _person_at(self, x: float, y: float, yaw: float, sitting: bool) -> None:
        rng, M = self.rng, pose((x, y, 0), yaw)
        who = self.cast.person(rng, sitting)
        if sitting:
            self._add(self.shop.make("chair", rng), "chair", M @ pose((0, 0.05, 0)))
        self._add(who.mesh, "person", M)
        for palm in who.hands.values():
            if rng.random() < 0.22:
                cls = str(rng.choice(["cup", "book", "bottle", "phone", "laptop"], p=[0.3, 0.25, 0.2, 0.2, 0.05]))
                tilt = rng.uniform(40, 80) if cls in ("book", "phone") else rng.normal(0, 10)
                at = (palm[0], palm[1] - 0.05, palm[2] - 0.06)
                self._add(self.shop.make(cls, rng), cls, M @ pose(at, rng.uniform(0, 360), tilt))

    def _people(self, n: int, near: float, far: float, spread: float, sit: float = 0.25) -> None:
        for _ in range(n):
            at = self._spot(near, far, spread, 0.25)
            if at:
                facing = self.rng.normal(0, 45) if self.rng.random() < 0.55 else self.rng.uniform(0, 360)
                self._person_at(*at, facing, self.rng.random() < sit)

    def _free_chairs(self, n: int, near: float, far: float) -> None:
        for _ in range(n):
            at = self._spot(near, far, 0.6, 0.3)
            if at:
                self._add(self.shop.make("chair", self.rng), "chair", pose((*at, 0), self.rng.uniform(0, 360)))

    def _floor_things(self, near: float, far: float) -> None:
        rng = self.rng
        for cls, weights in (("bag", (0.7, 0.3)), ("fan", (0.85, 0.15)), ("furniture", (0.4, 0.3, 0.2, 0.1))):
            for _ in range(self._n(*weights)):
                at = self._spot(near, far, 0.65, 0.3)
                if at:
                    mesh = self.shop.furniture(rng) if cls == "furniture" else self.shop.make(cls, rng)
                    self._add(mesh, None if cls == "furniture" else cls, pose((*at, 0), rng.uniform(0, 360)))

    def _shelf(self, depth: float, half: float) -> None:
        frame, books = self.shop.shelf(self.rng)
        M = pose((self.rng.uniform(-half, half), depth - 0.22, 0))
        self._add(frame, None, M)
        for b in books:
            self._add(b, "book", M)

    def _camera(self, height: float, pitch: float, yaw: float = 12, roll: float = 5) -> Scene:
        rng = self.rng
        R = look(pitch, rng.normal(0, yaw), rng.normal(0, roll))
        return Scene(self.things, R, np.array([0, 0, height]))

    # ---- kinds of scenes
    def _office(self) -> Scene:
        rng, depth = self.rng, self.rng.uniform(3.0, 7.0)
        half = rng.uniform(1.8, 4.0)
        self._room(depth, half, rng.uniform(2.4, 3.2))
        if rng.random() < 0.35:
            self._shelf(depth, half)
        for _ in range(1 + self._n(0.45, 0.4, 0.15)):
            at = self._spot(1.3, depth - 0.5, 0.55, 0.55)
            if at:
                self._desk_at(*at, rng.choice([0, 90, 180, 270], p=[0.5, 0.17, 0.16, 0.17]) + rng.normal(0, 12), 0.7)
        self._people(self._n(0.22, 0.33, 0.28, 0.17), 0.9, depth - 0.4, 0.5, 0.35)
        self._free_chairs(self._n(0.5, 0.35, 0.15), 1.2, depth - 0.4)
        self._floor_things(1.2, depth - 0.3)
        return self._camera(rng.uniform(0.9, 1.75), rng.uniform(-28, 4))

    def _desk(self) -> Scene:
        rng, depth = self.rng, self.rng.uniform(2.0, 5.0)
        self._room(depth, rng.uniform(1.5, 3.0), 2.8)
        y = rng.uniform(0.55, 1.3)
        self.taken.append((0, y, 0.5))
        self._desk_at(rng.normal(0, 0.2), y, rng.normal(0, 25), rng.uniform(0.7, 1.6))
        if rng.random() < 0.3:
            self._person_at(rng.normal(0, 0.5), y + rng.uniform(0.5, 0.8), rng.normal(0, 30), rng.random() < 0.5)
        self._people(self._n(0.75, 0.25), 1.6, depth, 0.4)
        return self._camera(rng.uniform(1.0, 1.5), rng.uniform(-48, -14), 15, 8)

    def _portrait(self) -> Scene:
        rng, depth = self.rng, self.rng.uniform(2.0, 6.0)
        self._room(depth, rng.uniform(1.5, 3.5), 2.7)
        self._people(1 + self._n(0.6, 0.4), 0.65, 1.5, 0.4, 0.25)
        self._people(self._n(0.6, 0.4), 1.5, depth, 0.5)
        self._free_chairs(self._n(0.6, 0.4), 1.5, depth)
        self._floor_things(1.4, depth)
        return self._camera(rng.uniform(1.1, 1.7), rng.uniform(-20, 6))

    def _walk(self) -> Scene:
        rng, depth = self.rng, self.rng.uniform(3.5, 7.0)
        self._room(depth, rng.uniform(1.8, 3.5), rng.uniform(2.4, 3.2))
        self._people(1 + self._n(0.3, 0.35, 0.25, 0.1), 1.0, depth - 0.3, 0.5, 0.12)
        at = self._spot(1.6, depth - 0.4, 0.5, 0.6)
        if at:
            self._desk_at(*at, rng.choice([0, 180]) + rng.normal(0, 12), 0.7)
        self._free_chairs(self._n(0.3, 0.4, 0.3), 1.3, depth - 0.4)
        self._floor_things(1.5, depth - 0.3)
        return self._camera(rng.uniform(0.6, 1.8), rng.uniform(-18, 5))
