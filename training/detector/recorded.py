# SPDX-License-Identifier: Apache-2.0
"""AP50 of the program itself on photographs kept apart: python3 -m detector.recorded JUDGE --slam ydd-slam

Unlike detector.evaluate, which runs the network in PyTorch, this runs `ydd-slam detect` over the photographs,
once for every --set (in the form of `--set` of ydd-slam; empty: as the detector file says), and compares what
the sets gain or lose. Every box of a score of 0.02 or more counts."""
from __future__ import annotations

import argparse
import json
import pathlib
import subprocess
import tempfile

import cv2
import numpy as np

from .classes import CLASSES
from .evaluate import Picture, Tally, judged
from .networks import Found

FLOOR = 0.02


def recording(pictures: list[Picture], folder: pathlib.Path) -> None:
    """A recording whose frames are the photographs."""
    (folder / "rgb").mkdir(parents=True)
    lines = []
    for k, p in enumerate(pictures):
        name = f"rgb/{k:06d}.png"
        cv2.imwrite(str(folder / name), cv2.imread(str(p.image)))
        lines.append(f"{k / 10:.6f} {name}")
    for stream in ("rgb.txt", "depth.txt"):  # a layout that is known; nobody looks at the depth
        (folder / stream).write_text("\n".join(lines) + "\n")


def with_weak_boxes(detector: pathlib.Path, out: pathlib.Path) -> None:
    """The detector file without thresholds; paths stay what they are, seen from where it lies."""
    import yaml

    config = yaml.safe_load(detector.read_text())
    for network in config["networks"].values():
        for key in ("model", "classes"):
            network[key] = str((detector.parent / network[key]).resolve())
        network.pop("class_thresholds", None)
        network["score_threshold"] = FLOOR
    config["merge"] = {"enabled": False}
    out.write_text(yaml.safe_dump(config))


def detect(slam: pathlib.Path, folder: pathlib.Path, settings: list[str], out: pathlib.Path) -> list[Found]:
    command = [str(slam), "detect", str(folder / "room"), "--detector", str(folder / "weak.yaml"), "--quiet"]
    for s in settings:
        command += ["--set", s]
    subprocess.run([*command, "--out", str(out)], check=True, stdout=subprocess.DEVNULL)
    found = []
    for line in out.read_text().splitlines():
        ds = json.loads(line)["detections"]
        boxes = np.array([d["box"] for d in ds], float).reshape(-1, 4)
        scores = np.array([d["score"] for d in ds], float)
        found.append(Found(boxes, scores, np.array([CLASSES.index(d["cls"]) for d in ds], int)))
    return found


def tallies(pictures: list[Picture], found: list[Found]) -> dict[str, Tally]:
    out = {c: Tally() for c in CLASSES}
    for p, f in zip(pictures, found, strict=True):
        for c in p.classes:
            m = f.classes == c
            of = lambda b: b[b[:, 0] == c][:, 1:]
            out[CLASSES[c]].add(f.boxes[m], f.scores[m], of(p.boxes), of(p.ignore))
    return out


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a = ap.add_argument
    a("judge", type=pathlib.Path)
    a("--slam", type=pathlib.Path, required=True)
    a("--detector", type=pathlib.Path, default=pathlib.Path("../configs/detector/ydd.yaml"))
    a(
        "--set",
        nargs="*",
        default=["", "networks.*.precision=int8"],
        help="one column for each; several settings by commas",
    )
    args = ap.parse_args()
    pictures, columns = judged(args.judge), []
    with tempfile.TemporaryDirectory() as t:
        folder = pathlib.Path(t)
        recording(pictures, folder / "room")
        with_weak_boxes(args.detector, folder / "weak.yaml")
        for s in args.set:
            found = detect(args.slam.resolve(), folder, [x for x in s.split(",") if x], folder / "found.jsonl")
            columns.append(tallies(pictures, found))
    print("| class | boxes | " + " | ".join(s or "as it is" for s in args.set) + " |")
    print("|" + " --- |" * (2 + len(columns)))
    known = [c for c in CLASSES if columns[0][c].truths]
    for c in known:
        print(f"| {c} | {columns[0][c].truths} | " + " | ".join(f"{t[c].ap():.3f}" for t in columns) + " |")
    print("| mean | | " + " | ".join(f"{np.mean([t[c].ap() for c in known]):.4f}" for t in columns) + " |")


if __name__ == "__main__":
    main()
