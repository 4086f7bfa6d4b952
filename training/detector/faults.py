# SPDX-License-Identifier: Apache-2.0
"""What the false boxes of a class are: python3 -m detector.faults MODEL JUDGE OUT.jpg

On photographs kept apart: second boxes of something that has one (overlap of one half or more with a labelled
box), loose ones (0.2 to 0.5), the rest; and the precision and recall from rising scores on. OUT.jpg shows every
false box in red, labelled ones in blue, for one's own eyes: the rest may be real things that nobody labelled."""
from __future__ import annotations

import argparse
import dataclasses
import pathlib

import cv2
import numpy as np
import torch

from .boxes import area, intersections, iou
from .classes import CLASSES
from .data import size
from .evaluate import Picture, Tally, judged
from .graphs import ExactNetwork
from .networks import Found

SIDE, COLUMNS = 320, 6
BLUE, RED, WHITE = (240, 140, 40), (40, 40, 230), (255, 255, 255)


@dataclasses.dataclass
class Fault:
    picture: Picture
    box: np.ndarray
    score: float
    overlap: float  # with the labelled box that is nearest

    def kind(self) -> str:
        return "second" if self.overlap >= 0.5 else "loose" if self.overlap >= 0.2 else "rest"


def faults(p: Picture, found: Found, c: int, threshold: float) -> list[Fault]:
    truth, unknown = (b[b[:, 0] == c][:, 1:] for b in (p.boxes, p.ignore))
    free, out = np.ones(len(truth), bool), []
    mine = np.flatnonzero((found.classes == c) & (found.scores >= threshold))
    for k in mine[np.argsort(-found.scores[mine], kind="stable")]:
        box = found.boxes[k : k + 1]
        overlaps = iou(box, truth)[0] if len(truth) else np.zeros(1)
        left = np.where(free, overlaps, 0) if len(truth) else overlaps
        if left.max() >= 0.5:
            free[int(left.argmax())] = False
        elif not (intersections(box, unknown) > 0.5 * area(box)[:, None]).any():
            out.append(Fault(p, box[0], float(found.scores[k]), float(overlaps.max())))
    return out


def tile(f: Fault, c: int, number: int) -> np.ndarray:
    image = cv2.imread(str(f.picture.image))
    for box, colour in [(b[1:], BLUE) for b in f.picture.boxes if b[0] == c] + [(f.box, RED)]:
        x0, y0, x1, y1 = (int(v) for v in box)
        cv2.rectangle(image, (x0, y0), (x1, y1), colour, 2)
    k = (SIDE - 20) / max(image.shape[:2])
    image, out = cv2.resize(image, None, fx=k, fy=k), np.zeros((SIDE, SIDE, 3), np.uint8)
    out[: image.shape[0], : image.shape[1]] = image
    text = f"{number}: {f.score:.2f}, {f.kind()} ({f.overlap:.2f})"
    cv2.putText(out, text, (3, SIDE - 5), cv2.FONT_HERSHEY_SIMPLEX, 0.45, WHITE, 1, cv2.LINE_AA)
    return out


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a = ap.add_argument
    a("model", type=pathlib.Path)
    a("judge", type=pathlib.Path)
    a("out", type=pathlib.Path)
    a("--cls", default="person")
    a("--threshold", type=float, default=0.37)
    a("--size", type=size, default=(416, 320))
    args = ap.parse_args()
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    c, tally, found = CLASSES.index(args.cls), Tally(), []
    net = ExactNetwork(args.model, "yolov5_heads", dict(enumerate(CLASSES)), args.size)
    for p in judged(args.judge):
        if c not in p.classes:
            continue
        boxes = net.detect(cv2.imread(str(p.image)), 0.02)
        m, of = boxes.classes == c, lambda b: b[b[:, 0] == c][:, 1:]
        tally.add(boxes.boxes[m], boxes.scores[m], of(p.boxes), of(p.ignore))
        found += faults(p, boxes, c, args.threshold)
    for kind in ("second", "loose", "rest"):
        print(f"{kind}: {sum(f.kind() == kind for f in found)}")
    for s in (args.threshold, *np.arange(0.3, 0.85, 0.05)):
        precision, recall = tally.at(s)
        print(f"from {s:.2f}: precision {precision:.2f}, recall {recall:.2f}")
    tiles = [tile(f, c, k) for k, f in enumerate(found, 1)]
    tiles += [np.zeros((SIDE, SIDE, 3), np.uint8)] * (-len(tiles) % COLUMNS)
    rows = [np.hstack(tiles[k : k + COLUMNS]) for k in range(0, len(tiles), COLUMNS)]
    if rows:
        cv2.imwrite(str(args.out), np.vstack(rows), [cv2.IMWRITE_JPEG_QUALITY, 85])


if __name__ == "__main__":
    main()
