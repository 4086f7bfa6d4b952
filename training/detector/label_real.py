# SPDX-License-Identifier: Apache-2.0
"""Labels real frames with the teachers: python3 -m detector.label_real SEQUENCE OUT --frames A:B:STEP

Confident boxes are kept, those in between become unknown regions. --empty says that nobody is in
the clip: persons, heads and hands are then false alarms and left out."""
from __future__ import annotations

import argparse
import json
import pathlib

import cv2
import numpy as np

from .files import write_whole
from .networks import Found, Teachers

WIDTH = 400
PEOPLE = (0, 1, 2)


def truth(found: Found, sure: float, scale: float, empty: bool) -> dict[str, list]:
    rows: dict[str, list] = {"boxes": [], "ignore": []}
    for b, s, c in zip(found.boxes, found.scores, found.classes):
        if empty and c in PEOPLE:
            continue
        rows["boxes" if s >= sure else "ignore"].append([int(c), *(round(float(v) * scale, 1) for v in b)])
    return rows


def frames_of(sequence: pathlib.Path, span: str) -> list[pathlib.Path]:
    names = [line.split()[1] for line in (sequence / "rgb.txt").read_text().splitlines() if line and line[0] != "#"]
    a, b, step = (int(v) if v else None for v in span.split(":"))
    return [sequence / n for n in names[slice(a, b, step)]]


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__)
    ap.add_argument("sequence", type=pathlib.Path)
    ap.add_argument("out", type=pathlib.Path)
    ap.add_argument("--models", type=pathlib.Path, required=True)
    ap.add_argument("--frames", default="::1")
    ap.add_argument("--sure", type=float, default=0.45)
    ap.add_argument("--doubt", type=float, default=0.12)
    ap.add_argument("--empty", action="store_true")
    args = ap.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    cv2.setNumThreads(1)
    teachers = Teachers(args.models)
    for k, file in enumerate(frames_of(args.sequence, args.frames)):
        if (args.out / f"{k:06d}.json").exists():
            continue
        image = cv2.imread(str(file))
        found = teachers.detect(image, args.doubt)
        scale = WIDTH / image.shape[1]
        small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        cv2.imwrite(str(args.out / f"{k:06d}.jpg"), small, [cv2.IMWRITE_JPEG_QUALITY, 95])
        rows = truth(found, args.sure, scale, args.empty)
        write_whole(args.out / f"{k:06d}.json", json.dumps(rows))
    print(f"{args.out}: {k + 1} frames")


if __name__ == "__main__":
    main()
