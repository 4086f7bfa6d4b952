# SPDX-License-Identifier: Apache-2.0
"""Training frames of the project's own simulator: python3 -m synth.simulated OUT --slam ydd-slam

Every seed is another room with other people, of which a few frames far apart are taken. Seeds begin at
FIRST_SEED; tests and benchmarks stay below it."""
from __future__ import annotations

import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile

import cv2
import numpy as np

from detector.classes import CLASSES
from detector.files import write_whole

FIRST_SEED, EVERY_S = 100_000, 0.5
WIDTH, HEIGHT = 400, 300
KINDS = (
    ("--busy", "--path", "xyz"),
    ("--people", "3", "--path", "halfsphere"),
    ("--people", "5", "--path", "room_loop"),
)


def simulate(slam: pathlib.Path, out: pathlib.Path, seed: int, frames: int) -> None:
    options = {"width": WIDTH, "height": HEIGHT, "fps": 1 / EVERY_S, "threads": 1}
    command = [str(slam), "simulate", str(out), "--quiet", "--seed", str(seed), "--frames", str(frames)]
    command += [w for k, v in options.items() for w in ("--set", f"{k}={v:g}")]
    subprocess.run(
        [*command, *KINDS[seed % len(KINDS)], "--colour-format", "jpeg"], check=True, stdout=subprocess.DEVNULL
    )


def labels(detections: list[dict]) -> dict[str, list]:
    rows: dict[str, list] = {"boxes": [], "ignore": []}
    for d in detections:
        if d["cls"] in CLASSES:
            x0, y0, x1, y1 = d["box"]
            faint = d["pixels"] < 18 or min(x1 - x0, y1 - y0) < 4
            rows["ignore" if faint else "boxes"].append([CLASSES.index(d["cls"]), x0, y0, x1, y1])
    return rows


def take(sequence: pathlib.Path, out: pathlib.Path, seed: int) -> None:
    """Its pictures and labels. The masks say that all of a picture belongs together: none stands before another's."""
    for line in (sequence / "detections.jsonl").read_text().splitlines():
        frame = json.loads(line)
        name = out / f"{seed}_{frame['frame']:04d}"
        shutil.copyfile(sequence / frame["file"], name.with_suffix(".jpg"))
        cv2.imwrite(str(name.with_suffix(".mask.png")), np.full((HEIGHT, WIDTH), 255, np.uint8))
        write_whole(name.with_suffix(".json"), json.dumps(labels(frame["detections"])))


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__)
    ap.add_argument("out", type=pathlib.Path)
    ap.add_argument("--slam", type=pathlib.Path, required=True)
    ap.add_argument("--rooms", type=int, default=90)
    ap.add_argument("--frames", type=int, default=8, help="of every room")
    ap.add_argument("--every", type=int, default=1, help="rooms START, START + EVERY, ...: for two processes")
    ap.add_argument("--start", type=int, default=0)
    args = ap.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    for seed in range(FIRST_SEED + args.start, FIRST_SEED + args.rooms, args.every):
        if (args.out / f"{seed}_{args.frames - 1:04d}.json").exists():
            continue
        with tempfile.TemporaryDirectory() as folder:
            simulate(args.slam, pathlib.Path(folder) / "room", seed, args.frames)
            take(pathlib.Path(folder) / "room", args.out, seed)


if __name__ == "__main__":
    main()
