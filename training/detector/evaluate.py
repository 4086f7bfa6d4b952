# SPDX-License-Identifier: Apache-2.0
"""Precision, recall, AP50 per class, and false alarms: python3 -m detector.evaluate --help

Truth comes from folders of NAME.jpg + NAME.json (as for training), from sequences with
detections_gt.jsonl, from the teachers, or from eyeballed.json. Unknown regions count neither way."""
from __future__ import annotations

import argparse
import dataclasses
import json
import pathlib

import cv2
import numpy as np
import torch

from .boxes import area, intersections, iou
from .classes import CLASSES, by_class
from .data import LONGEST, size
from .label_real import frames_of, truth
from .graphs import ExactNetwork, ExactTeachers
from .networks import Found

SMALLEST_PX = 10  # of the shorter side at 640 px width; smaller boxes are unknown


@dataclasses.dataclass
class Picture:
    image: pathlib.Path
    boxes: np.ndarray  # [n, 5] class, x0, y0, x1, y1 in pixels of the image
    ignore: np.ndarray
    classes: tuple[int, ...] = tuple(range(len(CLASSES)))  # that the truth knows


def rows(r: list) -> np.ndarray:
    return np.array(r, float).reshape(-1, 5)


def folder(d: pathlib.Path) -> list[Picture]:
    out = []
    for f in sorted(d.glob("*.json")):
        t = json.loads(f.read_text())
        out.append(_without_tiny(Picture(f.with_suffix(".jpg"), rows(t["boxes"]), rows(t["ignore"])), 400))
    return out


def judged(d: pathlib.Path) -> list[Picture]:
    """Photographs kept apart (SET/NAME.json, SET/labels.json): every set by the classes that it labels."""
    out = []
    for names in sorted(d.glob("*/labels.json")):
        known = tuple(CLASSES.index(c) for c in json.loads(names.read_text())["labelled"])
        for f in sorted(names.parent.glob("*.json")):
            if f == names:
                continue
            t = json.loads(f.read_text())
            unknown = [[c, *r[-4:]] for r in t["ignore"] for c in known]
            boxes = [[CLASSES.index(r[0]), *r[1:]] for r in t["boxes"]]
            picture = Picture(f.with_suffix(".jpg"), rows(boxes), rows(unknown), known)
            out.append(_without_tiny(picture, LONGEST))
    return out


def sequence(d: pathlib.Path, span: str) -> list[Picture]:
    """A rendered sequence with its exact boxes; those of under 60 pixels are unknown."""
    truths = {}
    exact = next(f for f in (d / "detections_gt.jsonl", d / "detections.jsonl") if f.exists())
    for line in exact.read_text().splitlines():
        t = json.loads(line)
        truths[pathlib.Path(t["file"]).stem] = t["detections"]
    out = []
    for file in frames_of(d, span):
        keep, ignore = [], []
        for b in truths[file.stem]:
            if b["cls"] in CLASSES:
                (keep if b["pixels"] >= 60 else ignore).append([CLASSES.index(b["cls"]), *b["box"]])
        out.append(_without_tiny(Picture(file, rows(keep), rows(ignore)), 640))
    return out


def _without_tiny(p: Picture, width: int) -> Picture:
    side = np.minimum(p.boxes[:, 3] - p.boxes[:, 1], p.boxes[:, 4] - p.boxes[:, 2]) * 640 / width
    tiny = side < SMALLEST_PX
    return dataclasses.replace(p, boxes=p.boxes[~tiny], ignore=np.concatenate([p.ignore, p.boxes[tiny]]))


def taught(d: pathlib.Path, span: str, models: pathlib.Path, empty: bool) -> list[Picture]:
    """Real frames with the confident boxes of the teachers."""
    t, out = ExactTeachers(models), []
    for file in frames_of(d, span):
        r = truth(t.detect(cv2.imread(str(file)), 0.12), 0.45, 1.0, empty)
        known = tuple(c for c in range(len(CLASSES)) if CLASSES[c] != "fan")
        out.append(_without_tiny(Picture(file, rows(r["boxes"]), rows(r["ignore"]), known), 640))
    return out


def eyeballed(file: pathlib.Path, data: pathlib.Path, trained: set[pathlib.Path]) -> dict[str, list[Picture]]:
    """By clip, without the frames that were trained on."""
    t: dict = json.loads(file.read_text())
    out: dict[str, list[Picture]] = {}
    known = tuple(CLASSES.index(c) for c in t["classes"])
    for f in t["frames"]:
        to = lambda bs: rows([[CLASSES.index(b[0]), *b[1:]] for b in bs])
        if data / f["file"] not in trained:
            p = Picture(data / f["file"], to(f["boxes"]), to(f.get("ignore", [])), known)
            out.setdefault(f"boxes drawn by eye, {f['file'].split('/')[0]}", []).append(p)
    return out


@dataclasses.dataclass
class Tally:
    scores: list[float] = dataclasses.field(default_factory=list)
    hits: list[bool] = dataclasses.field(default_factory=list)
    truths: int = 0

    def add(self, boxes: np.ndarray, scores: np.ndarray, truth_: np.ndarray, ignore: np.ndarray) -> None:
        self.truths += len(truth_)
        free, o = np.ones(len(truth_), bool), iou(boxes, truth_)
        inside = intersections(boxes, ignore) / np.maximum(area(boxes)[:, None], 1e-9)
        for k in np.argsort(-scores, kind="stable"):
            q = np.where(free, o[k], 0) if len(truth_) else np.zeros(0)
            if len(q) and q.max() >= 0.5:
                free[int(q.argmax())] = False
                self.scores.append(float(scores[k])), self.hits.append(True)
            elif not (inside[k] > 0.5).any():
                self.scores.append(float(scores[k])), self.hits.append(False)

    def at(self, threshold: float) -> tuple[float, float]:
        """Precision, recall."""
        s, h = np.array(self.scores), np.array(self.hits, bool)
        tp = int(h[s >= threshold].sum()) if len(s) else 0
        n = int((s >= threshold).sum()) if len(s) else 0
        return tp / n if n else float("nan"), tp / self.truths if self.truths else float("nan")

    def ap(self) -> float:
        """Area under the precision-recall curve, precision made monotonous."""
        if not self.truths:
            return float("nan")
        h = np.array(self.hits, bool)[np.argsort(-np.array(self.scores), kind="stable")]
        tp = np.cumsum(h)
        recall, precision = tp / self.truths, tp / np.arange(1, len(h) + 1)
        precision = np.maximum.accumulate(precision[::-1])[::-1]
        return float(np.sum(np.diff(np.concatenate([[0], recall])) * precision)) if len(h) else 0.0


def measure(detector: object, pictures: list[Picture], floor: float = 0.02) -> dict[str, Tally]:
    out = {c: Tally() for c in CLASSES}
    for p in pictures:
        found: Found = detector.detect(cv2.imread(str(p.image)), floor)  # type: ignore[attr-defined]
        for c in p.classes:
            m = found.classes == c
            of = lambda b: b[b[:, 0] == c][:, 1:]
            out[CLASSES[c]].add(found.boxes[m], found.scores[m], of(p.boxes), of(p.ignore))
    return out


@dataclasses.dataclass
class Thresholds:
    """Ours has one for each class, networks of others and earlier ones of ours a common one."""

    ours: dict[str, float]
    others: float = 0.3

    def of(self, net: str, cls: str) -> float:
        return self.ours.get(cls, self.others) if net.startswith("ours") else self.others


def table(results: dict[str, dict[str, Tally]], thresholds: Thresholds) -> str:
    """AP50, in brackets precision and recall at the threshold."""
    head = "| class | boxes | " + " | ".join(results) + " |"
    lines = [head, "|" + " --- |" * (2 + len(results))]
    f = lambda v: "-" if np.isnan(v) else f"{v:.2f}"
    for c in CLASSES:
        n = next(iter(results.values()))[c].truths
        if n:
            cells = [f"{f(r[c].ap())} ({', '.join(f(v) for v in r[c].at(thresholds.of(n_, c)))})" for n_, r in results.items()]
            lines.append(f"| {c} | {n} | " + " | ".join(cells) + " |")
    means = [np.nanmean([r[c].ap() for c in CLASSES if r[c].truths]) for r in results.values()]
    return "\n".join([*lines, "| mean | | " + " | ".join(f(m) for m in means) + " |"])


PEOPLE = ("person", "head", "hand")


def sure_table(results: dict[str, dict[str, Tally]], sure: dict[str, float]) -> str:
    """Of people: precision and recall from where a box is sure, for ours."""
    mine = {n: r for n, r in results.items() if n.startswith("ours")}
    known = [c for c in PEOPLE if c in sure and next(iter(mine.values()))[c].truths]
    cells = lambda c: " | ".join("{:.2f}, {:.2f}".format(*r[c].at(sure[c])) for r in mine.values())
    head = ["| sure | from | " + " | ".join(mine) + " |", "|" + " --- |" * (2 + len(mine))]
    return "\n".join([*head, *(f"| {c} | {sure[c]} | {cells(c)} |" for c in known)])


def false_alarms(detector: object, files: list[pathlib.Path], name: str, thresholds: Thresholds) -> dict[str, int]:
    """Persons, heads and hands on frames without people."""
    n = dict.fromkeys(PEOPLE, 0)
    for f in files:
        found: Found = detector.detect(cv2.imread(str(f)), 0.1)  # type: ignore[attr-defined]
        for c in n:
            sure = found.scores >= thresholds.of(name, c)
            n[c] += int(((found.classes == CLASSES.index(c)) & sure).sum())
    return n


def without_people(pictures: list[Picture]) -> list[pathlib.Path]:
    """Those whose labels know persons and have none, not even in a crowd or as a difficult one."""
    person = CLASSES.index("person")
    return [p.image for p in pictures if person in p.classes and not any((b[:, 0] == person).any() for b in (p.boxes, p.ignore))]


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a = ap.add_argument
    a("model", type=pathlib.Path)
    a("--models", type=pathlib.Path, required=True, help="folder of the teachers")
    a(
        "--sizes",
        type=size,
        nargs="+",
        default=[(320, 256), (416, 320)],
        help="of our network; the teachers get the last",
    )
    a("--thresholds", nargs="*", default=[], help="CLASS=SCORE of ours; 0.3 for others and for other networks")
    a("--sure", nargs="*", default=[], help="CLASS=SCORE of ours from where a box is sure")
    a("--folder", type=pathlib.Path, nargs="*", default=[])
    a("--judge", type=pathlib.Path, help="folder of photographs kept apart (detector.photographs)")
    a("--before", type=pathlib.Path, help="an earlier network of ours to stand beside")
    a("--sequence", nargs="*", default=[], help="DIR=A:B:STEP with exact boxes")
    a("--taught", nargs="*", default=[], help="DIR=A:B:STEP, truth: confident boxes of the teachers")
    a("--eyeballed", type=pathlib.Path)
    a("--data", type=pathlib.Path, help="folder that eyeballed.json refers to")
    a("--trained", nargs="*", default=[], help="DIR=A:B:STEP: frames that eyeballed.json has and training saw")
    a("--empty", nargs="*", default=[], help="DIR=A:B:STEP without people: false alarms")
    args = ap.parse_args()
    cv2.setNumThreads(1)
    torch.set_num_threads(1)
    thresholds, sure = Thresholds(by_class(args.thresholds)), by_class(args.sure)
    by = lambda s: f"{s[0]}x{s[1]}"
    ours = lambda model, s: ExactNetwork(model, "yolov5_heads", dict(enumerate(CLASSES)), s)
    nets = {f"ours {by(s)}": ours(args.model, s) for s in args.sizes}
    nets[f"teachers {by(args.sizes[-1])}"] = ExactTeachers(args.models, args.sizes[-1])
    if args.before:
        nets[f"before {by(args.sizes[-1])}"] = ours(args.before, args.sizes[-1])
    part = lambda s: (pathlib.Path(s.split("=")[0]), s.split("=")[1])
    sets: dict[str, list[Picture]] = {str(d): folder(d) for d in args.folder}
    if args.judge:
        sets["photographs kept apart"] = judged(args.judge)
    sets |= {s: sequence(*part(s)) for s in args.sequence}
    if args.eyeballed:
        trained = {f for s in args.trained for f in frames_of(*part(s))}
        sets |= eyeballed(args.eyeballed, args.data, trained)
    full = {**nets, "teachers 640x480": ExactTeachers(args.models)}
    for name, pictures in sets.items():
        results = {n: measure(d, pictures) for n, d in full.items()}
        print(f"\n{name}: {len(pictures)} frames\n{table(results, thresholds)}")
        if sure:
            print(f"\n{sure_table(results, sure)}")
    for s in args.taught:
        pictures = taught(*part(s), args.models, False)
        print(f"\n{s}, against the teachers at 640x480: {len(pictures)} frames")
        print(table({n: measure(d, pictures) for n, d in nets.items()}, thresholds))
    nobody = {s: frames_of(*part(s)) for s in args.empty}
    if args.judge:
        nobody["photographs kept apart"] = without_people(sets["photographs kept apart"])
    for s, files in nobody.items():
        for n, d in full.items():
            print(f"{s}: {len(files)} frames without people, {n}: {false_alarms(d, files, n, thresholds)}")
            if sure and n.startswith("ours"):
                told = false_alarms(d, files, n, Thresholds(sure))
                print(f"{s}: {len(files)} frames without people, {n}, sure ones: {told}")


if __name__ == "__main__":
    main()
