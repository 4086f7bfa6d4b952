# SPDX-License-Identifier: Apache-2.0
"""People in random poses, clothes, skins and builds (shared/render: mh_human.py, CC0 MakeHuman)."""
from __future__ import annotations

import dataclasses

import cv2
import numpy as np

from .mesh import Mesh, make, merged
from .textures import TextureBank, pattern, read_rgb, u8

Rng = np.random.Generator
LOOKS = (  # sex, skin, clothes, hair, shoes
    ("male", "young_lightskinned_male_diffuse", "male_casualsuit03", "short02", "shoes01"),
    ("female", "young_lightskinned_female_diffuse2", "female_casualsuit01", "ponytail01", "shoes02"),
    ("male", "middleage_darkskinned_male_diffuse", "male_casualsuit03", "short04", "shoes03"),
    ("female", "young_lightskinned_female_diffuse2", "female_casualsuit01", "short04", "shoes02"),
    ("male", "young_lightskinned_male_diffuse", "male_casualsuit03", None, "shoes01"),
    ("female", "middleage_darkskinned_male_diffuse", "male_casualsuit03", "ponytail01", "shoes03"),
)


@dataclasses.dataclass
class Posed:
    mesh: Mesh  # feet on z = 0 round the origin, faces -y
    hands: dict[str, np.ndarray]


class Cast:
    def __init__(self, mh: object, bank: TextureBank, rng: Rng):
        self.mh, self.bank = mh, bank
        self.humans = []
        for sex, skin, clothes, hair, shoes in LOOKS:
            human = mh.Human(sex, height=1.75, skin=skin, clothes=clothes, hair=hair, shoes=shoes)
            items = [self._item_mesh(i) for i in human.items]
            paints = [self._paints(i, rng) for i in human.items]
            self.humans.append((human, items, paints))

    def _item_mesh(self, item: object) -> Mesh:
        corners = [tuple(item.vt[t]) for f in item.ft for t in f]
        m = make(item.v, [list(f) for f in item.f], corners)
        fans = [len(f) - 2 for f in item.f]
        m.part[:] = np.repeat(np.asarray(item.part), fans)
        if item.kind == "hair" and item.tex:
            m.alpha[:] = self.bank.alpha_file(item.tex)
        return m

    def _paints(self, item: object, rng: Rng) -> list[int]:
        """Textures that this item may wear."""
        if not item.tex:
            return [-1]
        base = read_rgb(item.tex).astype(np.float32)
        out = [self.bank.add(u8(base))]
        if item.kind == "clothes" and "suit" in item.name:
            out += [self.bank.add(u8(self._dressed(base, item.name, rng))) for _ in range(9)]
        elif item.kind == "hair":
            for tint in ((35, 25, 20), (120, 85, 50), (190, 150, 90), (60, 40, 30), (150, 150, 150), (15, 15, 15)):
                grey = base.mean(-1, keepdims=True)
                out.append(self.bank.add(u8(grey / (grey.mean() + 1) * np.float32(tint))))
        elif item.kind == "body":
            for gain in ((1.08, 1.05, 1.0), (0.8, 0.72, 0.65), (0.55, 0.45, 0.4), (0.95, 0.85, 0.75), (1.1, 0.95, 0.9)):
                out.append(self.bank.add(u8(base * np.float32(gain))))
        return out

    @staticmethod
    def _dressed(base: np.ndarray, name: str, rng: Rng) -> np.ndarray:
        """Shirt and trousers in new patterns; the folds of the original stay as light and dark."""
        h, w = base.shape[:2]
        if name.startswith("male"):
            upper = ~((base[..., 2] > base[..., 0] + 8) & (base[..., 2] > 50))
            upper = cv2.medianBlur(upper.astype(np.uint8), 9) > 0
        else:
            upper = np.zeros((h, w), bool)
            upper[: int(h * 0.43)] = True
            upper[int(h * 0.42) :, int(w * 0.73) :] = True
        grey = base.mean(-1)
        fold = grey / (cv2.GaussianBlur(grey, (0, 0), 25) + 8)
        wear = lambda: cv2.resize(u8(pattern(rng)), (w, h)).astype(np.float32)
        mix = np.where(upper[..., None], wear(), wear() if rng.random() < 0.7 else base)
        return mix * np.clip(fold, 0.6, 1.3)[..., None]

    # ---- poses
    def _rest(self, h: object, rng: Rng, sitting: bool) -> dict[str, np.ndarray]:
        t, seed = rng.uniform(0, 60), rng.uniform(0, 6)
        if sitting:
            return h.sit(t, seed, rng.random() < 0.6)
        return h.gait(rng.random(), rng.uniform(0, 1) * (rng.random() < 0.6), t, seed)

    def _arms(self, h: object, p: dict[str, np.ndarray], rng: Rng) -> None:
        for side in "LR":
            u, q = rng.random(), {}
            if u < 0.35:
                continue
            if u < 0.6:  # carries something in front
                h.arms(q, side, down=rng.uniform(36, 50), swing=rng.uniform(0, 30), elbow=rng.uniform(50, 105))
            elif u < 0.8:  # reaches
                h.arms(q, side, down=rng.uniform(20, 45), swing=rng.uniform(30, 85), elbow=rng.uniform(0, 30))
            elif u < 0.92:  # at the head: phone, chin
                h.arms(q, side, down=rng.uniform(30, 45), swing=rng.uniform(20, 60), elbow=rng.uniform(100, 140))
            else:  # waves
                h.arms(q, side, down=rng.uniform(-50, 10), swing=rng.uniform(0, 50), elbow=rng.uniform(0, 90))
            p.update(q)

    def _bend(self, p: dict[str, np.ndarray], rng: Rng) -> None:
        lean = np.radians(abs(rng.normal(0, 14)) if rng.random() < 0.4 else 3)
        add = lambda bone, rv: p.__setitem__(bone, p.get(bone, np.zeros(3)) + np.asarray(rv))
        add("spine05", (lean * 0.6, rng.normal(0, 0.06), 0))
        add("spine03", (lean * 0.5, rng.normal(0, 0.05), rng.normal(0, 0.15)))
        add("neck01", (rng.normal(0.05, 0.15), rng.normal(0, 0.08), rng.normal(0, 0.3)))
        add("head", (rng.normal(0, 0.12), rng.normal(0, 0.08), rng.normal(0, 0.25)))
        for s in "LR":
            if rng.random() < 0.5:
                curl = (1 if s == "L" else -1) * rng.uniform(-0.1, 0.9)
                for k in (2, 3, 4, 5):
                    for j in (1, 2):
                        p[f"finger{k}-{j}.{s}"] = np.array([0, curl, 0])

    def person(self, rng: Rng, sitting: bool) -> Posed:
        h, items, paints = self.humans[int(rng.integers(len(self.humans)))]
        p = self._rest(h, rng, sitting)
        self._arms(h, p, rng)
        self._bend(p, rng)
        G = h.fk(p)
        V = h.skin(G)
        root, low = h.joint(G, "root"), min(v[:, 2].min() for v in V)
        tall = rng.uniform(0.88, 1.1)
        wide = tall * rng.uniform(0.92, 1.22)
        at = lambda v: ((v - [root[0], root[1], low]) * [wide, wide, tall]).astype(np.float32)
        worn = [i.painted(q[int(rng.integers(len(q)))], (0.1, 0.08, 0.06)) for i, q in zip(items, paints)]
        mesh = merged([m.with_vertices(at(v)) for m, v in zip(worn, V)])
        palm = lambda s: at(0.4 * h.joint(G, f"wrist.{s}") + 0.6 * h.joint(G, f"finger3-1.{s}"))
        return Posed(mesh, {s: palm(s) for s in "LR"})
