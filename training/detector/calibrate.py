# SPDX-License-Identifier: Apache-2.0
"""Makes scores mean something: python3 -m detector.calibrate CHECKPOINT JUDGE OUT.json

On photographs kept apart: finds the stretch and shift of the objectness and of every class logit with
which a score is the odds of a true box (least log loss; detector.export folds them into the last
convolutions), one threshold for every class, for people a second one from which on a box is sure, and
the reliability before and after, each half of the pictures judged by what the other half gave."""
from __future__ import annotations

import argparse
import json
import pathlib

import cv2
import numpy as np
import torch
from torch import Tensor

from .boxes import area, intersections, iou
from .classes import CLASSES, by_class
from .data import size
from .evaluate import Picture, judged
from .export import load
from .files import write_whole
from .model import Yolo
from .networks import Network

FLOOR, LEAST, MOST = 0.01, 0.25, 0.8  # scores that count; the lowest and the highest threshold
FEW, UNKNOWN = 10, 0.3  # boxes of a class that say nothing yet; its threshold then
PRIOR = 20.0  # how hard a class is held near no change


class Checkpoint(Network):
    """A network in PyTorch that remembers the logits of every box it gives."""

    def __init__(self, net: Yolo, size_: tuple[int, int]):
        self.net, self.kind, self.size, self.nms_iou = net, "yolov5_heads", size_, 0.45
        self.names = {k: k for k in range(len(CLASSES))}

    @torch.no_grad()
    def run(self, blob: np.ndarray) -> list[np.ndarray]:
        return [torch.sigmoid(y).numpy() for y in self.net(torch.from_numpy(blob))]

    def _select(self, rows: np.ndarray, floor: float):  # noqa: ANN202
        found = super()._select(rows, floor)
        score = rows[:, 4] * rows[:, 5:].max(1)
        at = [int(np.flatnonzero(score == s)[0]) for s in found.scores]
        self.parts = rows[at][:, [4]], rows[at][np.arange(len(at)), 5 + found.classes] if at else np.zeros(0)
        return found


def verdicts(net: Checkpoint, pictures: list[Picture]) -> np.ndarray:
    """[n, 5]: picture, class, objectness, class probability, hit (1) or not (0); unknown regions left out."""
    out = []
    for number, p in enumerate(pictures):
        found = net.detect(cv2.imread(str(p.image)), FLOOR)
        objectness, probability = net.parts
        for c in p.classes:
            truth, unknown = (b[b[:, 0] == c][:, 1:] for b in (p.boxes, p.ignore))
            free = np.ones(len(truth), bool)
            for k in np.flatnonzero(found.classes == c)[np.argsort(-found.scores[found.classes == c])]:
                box = found.boxes[k : k + 1]
                o = np.where(free, iou(box, truth)[0], 0) if len(truth) else np.zeros(0)
                hit = bool(len(o) and o.max() >= 0.5)
                if hit:
                    free[int(o.argmax())] = False
                elif (intersections(box, unknown) > 0.5 * area(box)[:, None]).any():
                    continue
                out.append((number, c, objectness[k, 0], probability[k], hit))
    return np.array(out, float).reshape(-1, 5)


def logit(p: np.ndarray) -> Tensor:
    q = np.clip(p, 1e-6, 1 - 1e-6)
    return torch.from_numpy(np.log(q / (1 - q))).float()


def fit(v: np.ndarray) -> dict[str, list[float]]:
    """stretch, shift for the objectness (first) and the classes; rare classes stay near no change."""
    n = len(CLASSES)
    stretch, shift = torch.ones(1 + n, requires_grad=True), torch.zeros(1 + n, requires_grad=True)
    c, hit = torch.from_numpy(v[:, 1]).long() + 1, torch.from_numpy(v[:, 4]).float()
    zo, zc = logit(v[:, 2]), logit(v[:, 3])
    opt = torch.optim.LBFGS([stretch, shift], max_iter=200, line_search_fn="strong_wolfe")

    def closure() -> Tensor:
        opt.zero_grad()
        p = torch.sigmoid(stretch[0] * zo + shift[0]) * torch.sigmoid(stretch[c] * zc + shift[c])
        loss = torch.nn.functional.binary_cross_entropy(p.clamp(1e-6, 1 - 1e-6), hit, reduction="sum")
        pull = PRIOR * ((stretch[1:] - 1) ** 2 + 0.1 * shift[1:] ** 2).sum() + ((stretch[0] - 1) ** 2)
        total = (loss + pull) / max(len(hit), 1)
        total.backward()
        return total

    opt.step(closure)
    return {"stretch": stretch.detach().tolist(), "shift": shift.detach().tolist()}


def scores(v: np.ndarray, f: dict[str, list[float]]) -> np.ndarray:
    a, b, c = np.array(f["stretch"]), np.array(f["shift"]), v[:, 1].astype(int) + 1
    s = lambda z: 1 / (1 + np.exp(-z))
    return s(a[0] * logit(v[:, 2]).numpy() + b[0]) * s(a[c] * logit(v[:, 3]).numpy() + b[c])


def reliability(s: np.ndarray, hit: np.ndarray) -> tuple[list[tuple[float, float, int]], float]:
    """Mean score, share of hits and number in ten bins of the score; the expected error over all."""
    bins = np.minimum((s * 10).astype(int), 9)
    rows = [(float(s[bins == k].mean()), float(hit[bins == k].mean()), int((bins == k).sum())) for k in np.unique(bins)]
    return rows, sum(n * abs(m - h) for m, h, n in rows) / max(len(s), 1)


def threshold(s: np.ndarray, hit: np.ndarray, truths: int, precision: float, otherwise: float = 0.5) -> float:
    """The lowest score from which on at least this share of the boxes is right: what is missed costs the
    system more than what is doubted. Too few boxes say nothing."""
    if truths < FEW:
        return UNKNOWN
    order = np.argsort(-s)
    right = np.cumsum(hit[order]) / np.arange(1, len(s) + 1)
    good = np.flatnonzero(right >= precision)
    return float(np.clip(s[order][good[-1]], LEAST, MOST)) if len(good) else otherwise


def sure(s: np.ndarray, hit: np.ndarray, number: np.ndarray, truths: int, precision: float) -> dict:
    """From which score on somebody may be told of a box; the share that is right and what is found of all, each
    half of the pictures by the score that the other half gave."""
    of = lambda m: threshold(s[m], hit[m], truths, precision, MOST) if truths >= FEW else MOST
    half = number.astype(int) % 2 == 0
    told = np.where(half, s >= of(~half), s >= of(half))
    return {
        "score": round(of(np.ones(len(s), bool)), 2), "boxes": int(told.sum()),
        "precision": float(hit[told].mean()) if told.any() else 0.0, "recall": float(hit[told].sum() / max(truths, 1)),
    }  # fmt: skip


def summary(v: np.ndarray, pictures: list[Picture], precisions: dict[str, float], surest: dict[str, float]) -> dict:
    one = {"stretch": [1.0] * (1 + len(CLASSES)), "shift": [0.0] * (1 + len(CLASSES))}
    half = v[:, 0].astype(int) % 2 == 0
    crossed = np.where(half, scores(v, fit(v[~half])), scores(v, fit(v[half])))
    both = fit(v)
    after, thresholds, told = scores(v, both), {}, {}
    for c, name in enumerate(CLASSES):
        m, truths = v[:, 1] == c, sum(int((p.boxes[:, 0] == c).sum()) for p in pictures if c in p.classes)
        thresholds[name] = round(threshold(after[m], v[m, 4] > 0, truths, precisions.get(name, 0.5)), 2)
        if name in surest:
            told[name] = sure(after[m], v[m, 4] > 0, v[m, 0], truths, surest[name])
    return {
        **both, "thresholds": thresholds, "sure": told, "boxes": len(v),
        "before": reliability(scores(v, one), v[:, 4]), "crossed": reliability(crossed, v[:, 4]),
    }  # fmt: skip


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a = ap.add_argument
    a("checkpoint", type=pathlib.Path)
    a("judge", type=pathlib.Path)
    a("out", type=pathlib.Path)
    a("--size", type=size, default=(416, 320))
    a("--precision", nargs="*", default=["person=0.75", "head=0.75", "hand=0.55", "monitor=0.55"], help="CLASS=LEAST at its threshold")
    a("--sure", nargs="*", default=["person=0.95", "head=0.95", "hand=0.9"], help="the same from where it is sure")
    args = ap.parse_args()
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    pictures = judged(args.judge)
    v = verdicts(Checkpoint(load(args.checkpoint).fuse(), args.size), pictures)
    r = summary(v, pictures, by_class(args.precision), by_class(args.sure))
    write_whole(args.out, json.dumps(r, indent=1) + "\n")
    for name in ("before", "crossed"):
        rows, error = r[name]
        print(f"{name}: expected error {error:.3f}; " + ", ".join(f"{m:.2f}: {h:.2f} ({n})" for m, h, n in rows))
    print(r["thresholds"])
    for name, t in r["sure"].items():
        print(f"{name} sure from {t['score']}; crossed: {t['boxes']} boxes, {t['precision']:.2f} right, {t['recall']:.2f} found")


if __name__ == "__main__":
    main()
