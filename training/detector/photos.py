# SPDX-License-Identifier: Apache-2.0
"""Photographs without anything that the detector knows, as frames: python3 -m detector.photos OUT FOLDER [FOLDER ...]

They teach what is nothing, and stand behind rendered people and things. Drawings and pictures in which
the teachers see something are left out, and the same picture in another size."""
from __future__ import annotations

import argparse
import json
import pathlib

import cv2
import numpy as np

from .data import FRAME_H, FRAME_W
from .networks import Teachers

DOUBT = 0.15


def middle(image: np.ndarray) -> np.ndarray:
    """The largest middle part of the shape of a frame."""
    h, w = image.shape[:2]
    k = min(w / FRAME_W, h / FRAME_H)
    x, y = int((w - k * FRAME_W) / 2), int((h - k * FRAME_H) / 2)
    part = image[y : y + int(k * FRAME_H), x : x + int(k * FRAME_W)]
    return cv2.resize(part, (FRAME_W, FRAME_H), interpolation=cv2.INTER_AREA)


def plain(image: np.ndarray) -> bool:
    """Gradients and flat drawings have hardly any fine detail."""
    return float(np.median(np.abs(cv2.Laplacian(image, cv2.CV_32F)))) < 2


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__)
    ap.add_argument("out", type=pathlib.Path)
    ap.add_argument("folders", type=pathlib.Path, nargs="+")
    ap.add_argument("--models", type=pathlib.Path, required=True)
    args = ap.parse_args()
    done = args.out / "done"
    if done.exists():  # which pictures are alike is only known when all are looked at
        return
    args.out.mkdir(parents=True, exist_ok=True)
    teachers, thumbnails = Teachers(args.models), []
    files = sorted(f for d in args.folders for f in d.rglob("*") if f.suffix in (".jpg", ".png") and f.is_file())
    for file in files:
        image = cv2.imread(str(file), cv2.IMREAD_REDUCED_COLOR_2)
        if image is None or min(image.shape[:2]) < FRAME_H:
            continue
        image = middle(image)
        small = cv2.resize(image, (16, 12), interpolation=cv2.INTER_AREA).astype(float)
        again = any(np.abs(small - t).mean() < 8 for t in thumbnails)
        if again or plain(image) or len(teachers.detect(image, DOUBT).boxes):
            continue
        name = args.out / f"{len(thumbnails):06d}"
        cv2.imwrite(str(name.with_suffix(".jpg")), image, [cv2.IMWRITE_JPEG_QUALITY, 92])
        name.with_suffix(".json").write_text(json.dumps({"boxes": [], "ignore": []}))
        thumbnails.append(small)
    done.touch()
    print(f"{args.out}: {len(thumbnails)} of {len(files)} pictures")


if __name__ == "__main__":
    main()
