# SPDX-License-Identifier: Apache-2.0
"""A contact sheet of frames with boxes drawn by eye: python3 -m detector.sheet MODEL OUT.jpg --eyeballed FILE --data DIR

Green: found, with the class and the score; red: nothing is there; blue: missed. Frames are taken evenly
from every clip that is named with a number of them."""
from __future__ import annotations

import argparse
import pathlib

import cv2
import numpy as np

from .boxes import area, intersections, iou
from .classes import CLASSES, by_class
from .data import size
from .evaluate import Picture, eyeballed
from .networks import Network, ours

WIDTH, COLUMNS = 320, 4
GREEN, RED, BLUE = (60, 200, 60), (40, 40, 230), (240, 140, 40)


def named(image: np.ndarray, box: np.ndarray, colour: tuple[int, int, int], text: str, k: float) -> None:
    x0, y0, x1, y1 = (int(v * k) for v in box)
    cv2.rectangle(image, (x0, y0), (x1, y1), colour, 1)
    at = (x0 + 2, min(image.shape[0] - 2, max(9, y0 + 9)))
    cv2.putText(image, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.32, (0, 0, 0), 2, cv2.LINE_AA)
    cv2.putText(image, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.32, colour, 1, cv2.LINE_AA)


def drawn(net: Network, p: Picture, thresholds: dict[str, float]) -> tuple[np.ndarray, int]:
    """The picture with what was found, wrongly found and missed; how many of the last two."""
    image = cv2.imread(str(p.image))
    k = WIDTH / image.shape[1]
    out, faults = cv2.resize(image, None, fx=k, fy=k, interpolation=cv2.INTER_AREA), 0
    found = net.detect(image, 0.05)
    for c in p.classes:
        keep = (found.classes == c) & (found.scores >= thresholds[CLASSES[c]])
        truth, unknown = (b[b[:, 0] == c][:, 1:] for b in (p.boxes, p.ignore))
        free = np.ones(len(truth), bool)
        for i in np.flatnonzero(keep)[np.argsort(-found.scores[keep])]:
            box = found.boxes[i]
            o = np.where(free, iou(box[None], truth)[0], 0) if len(truth) else np.zeros(0)
            hit = bool(len(o) and o.max() >= 0.5)
            if hit:
                free[int(o.argmax())] = False
            elif (intersections(box[None], unknown) > 0.5 * area(box[None])[:, None]).any():
                continue
            faults += not hit
            named(out, box, GREEN if hit else RED, f"{CLASSES[c]} {found.scores[i]:.2f}"[: 12 if hit else 14], k)
        for box in truth[free]:
            faults += 1
            named(out, box, BLUE, CLASSES[c], k)
    return out, faults


def evenly(pictures: list[Picture], n: int) -> list[Picture]:
    return [pictures[int(i)] for i in np.linspace(0, len(pictures) - 1, n)]


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a = ap.add_argument
    a("model", type=pathlib.Path)
    a("out", type=pathlib.Path)
    a("--eyeballed", type=pathlib.Path, required=True)
    a("--data", type=pathlib.Path, required=True)
    a("--clips", nargs="+", required=True, help="CLIP=N: so many frames of it")
    a("--thresholds", nargs="*", default=[], help="CLASS=SCORE; 0.3 for the others")
    a("--size", type=size, default=(416, 320))
    args = ap.parse_args()
    thresholds = dict.fromkeys(CLASSES, 0.3) | by_class(args.thresholds)
    clips = eyeballed(args.eyeballed, args.data, set())
    net, tiles, faults = ours(args.model, args.size), [], 0
    for c in args.clips:
        name, n = c.split("=")
        pictures = next(p for k, p in clips.items() if k.endswith(name))
        for p in evenly(pictures, int(n)):
            tile, wrong = drawn(net, p, thresholds)
            tiles.append(tile)
            faults += wrong
    rows = [np.hstack(tiles[i : i + COLUMNS]) for i in range(0, len(tiles) - COLUMNS + 1, COLUMNS)]
    cv2.imwrite(str(args.out), np.vstack(rows), [cv2.IMWRITE_JPEG_QUALITY, 82])
    print(f"{args.out}: {len(rows) * COLUMNS} frames, {faults} boxes missed or wrong")


if __name__ == "__main__":
    main()
