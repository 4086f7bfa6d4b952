# SPDX-License-Identifier: Apache-2.0
"""Corrects suggested frames by boxes that are known: python3 -m detector.corrected SUGGESTED --sequence DIR | --eyes FILE

For measuring what corrections bring: SUGGESTED has NNNNNN.json as `ydd-slam detect --suggest` wrote them. A
rendered sequence has the exact boxes of its frames (detections_gt.jsonl), of which those with under 60 visible
pixels become unknown; FILE has the boxes that somebody drew, by the frame ({"000023": {"boxes": [[class, x0, y0,
x1, y1]], "ignore": [...]}}). A suggested frame that has none goes."""
from __future__ import annotations

import argparse
import json
import pathlib

from .classes import CLASSES
from .files import write_whole

Labels = dict[str, list]


def labels(detections: list[dict]) -> Labels:
    rows: Labels = {"boxes": [], "ignore": []}
    for d in detections:
        if d["cls"] in CLASSES:
            rows["boxes" if d["pixels"] >= 60 else "ignore"].append([d["cls"], *d["box"]])
    return rows


def exact(sequence: pathlib.Path) -> dict[int, Labels]:
    lines = (sequence / "detections_gt.jsonl").read_text().splitlines()
    return {t["frame"]: labels(t["detections"]) for t in map(json.loads, lines)}


def drawn(file: pathlib.Path) -> dict[int, Labels]:
    return {int(k): t for k, t in json.loads(file.read_text())["frames"].items()}


def correct(suggested: pathlib.Path, known: dict[int, Labels]) -> int:
    """How many frames stay, all of them corrected."""
    files = sorted(suggested.glob("*.json"))
    for f in files:
        if int(f.stem) in known:
            write_whole(f, json.dumps(known[int(f.stem)]))
        else:
            f.unlink(), f.with_suffix(".jpg").unlink(missing_ok=True)
    return sum(int(f.stem) in known for f in files)


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("suggested", type=pathlib.Path)
    by = ap.add_mutually_exclusive_group(required=True)
    by.add_argument("--sequence", type=pathlib.Path, help="rendered sequence with detections_gt.jsonl")
    by.add_argument("--eyes", type=pathlib.Path, help="boxes drawn by eye")
    args = ap.parse_args()
    known = exact(args.sequence) if args.sequence else drawn(args.eyes)
    before = len(list(args.suggested.glob("*.json")))
    stay = correct(args.suggested, known)
    print(f"{args.suggested}: {stay} frames corrected, {before - stay} that nobody corrected are gone")


if __name__ == "__main__":
    main()
