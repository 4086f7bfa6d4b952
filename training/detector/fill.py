# SPDX-License-Identifier: Apache-2.0
"""Fills the classes that a set does not label with the teachers' boxes: python3 -m detector.fill IN OUT --models DIR

IN has SET/NAME.jpg, NAME.json, labels.json (detector.photographs). A class that the set labels keeps its
boxes; what a teacher is sure of elsewhere becomes a box, what it doubts an unknown region, and so does a box
of a labelled class that the labels do not know (crowds, shelves). Heads and hands count near a person only."""
from __future__ import annotations

import argparse
import json
import pathlib

import cv2
import numpy as np
import torch

from .boxes import area, intersections, iou
from .classes import CLASSES
from .data import number, size
from .files import write_whole
from .graphs import GraphTeachers
from .networks import Found

SURE, DOUBT, UNLABELLED = 0.45, 0.15, 0.35  # scores: a box; an unknown region; a labelled class that labels miss
PERSON, PARTS = CLASSES.index("person"), (CLASSES.index("head"), CLASSES.index("hand"))


def numbered(rows: list) -> np.ndarray:
    """[n, 5]: classes by name or number to numbers."""
    return np.array([[number(r[0]), *r[1:]] for r in rows], float).reshape(-1, 5)


def near_person(box: np.ndarray, persons: np.ndarray) -> bool:
    """Half of the box lies in a person's box that is a quarter larger."""
    if not len(persons):
        return False
    side = persons[:, 2:] - persons[:, :2]
    wide = np.concatenate([persons[:, :2] - side / 8, persons[:, 2:] + side / 8], 1)
    return bool(intersections(box[None], wide).max() > 0.5 * area(box[None])[0])


def filled(boxes: np.ndarray, ignore: np.ndarray, labelled: set[int], found: Found) -> tuple[list, list]:
    """Boxes and unknown regions with what the teachers add."""
    extra, doubt = [], []
    sure_person = (found.classes == PERSON) & (found.scores >= SURE)
    persons = boxes[boxes[:, 0] == PERSON, 1:] if PERSON in labelled else found.boxes[sure_person]
    for b, s, c in zip(found.boxes, found.scores, found.classes):
        row = [int(c), *(float(v) for v in b)]
        same = boxes[boxes[:, 0] == c, 1:]
        if c in labelled:
            if s >= UNLABELLED and (not len(same) or iou(b[None], same).max() < 0.4):
                doubt.append(row)
        elif c in PARTS and not near_person(b, persons):
            if s >= SURE:
                doubt.append(row)
        elif s >= DOUBT:
            (extra if s >= SURE else doubt).append(row)
    return [*boxes.tolist(), *extra], [*ignore.tolist(), *doubt]


def fill(folder: pathlib.Path, out: pathlib.Path, teachers: GraphTeachers, part: tuple[int, int]) -> int:
    labelled = {CLASSES.index(c) for c in json.loads((folder / "labels.json").read_text())["labelled"]}
    out.mkdir(parents=True, exist_ok=True)
    files = [f for f in sorted(folder.glob("*.json")) if f.name != "labels.json"][part[0] :: part[1]]
    for f in files:
        if (out / f.name).exists():
            continue
        t = json.loads(f.read_text())
        image = (folder / f.name).with_suffix(".jpg").read_bytes()
        found = teachers.detect(cv2.imdecode(np.frombuffer(image, np.uint8), cv2.IMREAD_COLOR), DOUBT)
        boxes, ignore = filled(numbered(t["boxes"]), numbered(t["ignore"]), labelled, found)
        short = lambda rows: [[int(r[0]), *(round(v, 1) for v in r[1:])] for r in rows]
        (out / f.name).with_suffix(".jpg").write_bytes(image)
        write_whole(out / f.name, json.dumps({"boxes": short(boxes), "ignore": short(ignore)}))
    return len(files)


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("folder", type=pathlib.Path)
    ap.add_argument("out", type=pathlib.Path)
    ap.add_argument("--models", type=pathlib.Path, required=True, help="folder of the teachers")
    ap.add_argument("--size", type=size, default=(512, 384), help="at which the teachers look")
    ap.add_argument("--part", type=int, nargs=2, default=(0, 1), metavar=("K", "N"), help="every Nth picture, from the Kth")
    args = ap.parse_args()
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    teachers = GraphTeachers(args.models, args.size)
    for folder in sorted(f.parent for f in args.folder.glob("*/labels.json")):
        print(f"{folder.name}: {fill(folder, args.out / folder.name, teachers, args.part)}", flush=True)


if __name__ == "__main__":
    main()
