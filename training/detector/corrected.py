# SPDX-License-Identifier: Apache-2.0
"""Corrects suggested frames by known boxes: python3 -m detector.corrected SUGGESTED SEQUENCE

For measuring what corrections bring: SUGGESTED has NNNNNN.json as `ydd-slam detect SEQUENCE --suggest` wrote
them, SEQUENCE the exact boxes of its frames (detections_gt.jsonl). Boxes of under 60 visible pixels become unknown."""
from __future__ import annotations

import argparse
import json
import pathlib

from .classes import CLASSES
from .files import write_whole


def labels(detections: list[dict]) -> dict[str, list]:
    rows: dict[str, list] = {"boxes": [], "ignore": []}
    for d in detections:
        if d["cls"] in CLASSES:
            rows["boxes" if d["pixels"] >= 60 else "ignore"].append([d["cls"], *d["box"]])
    return rows


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("suggested", type=pathlib.Path)
    ap.add_argument("sequence", type=pathlib.Path)
    args = ap.parse_args()
    lines = (args.sequence / "detections_gt.jsonl").read_text().splitlines()
    exact = {t["frame"]: t["detections"] for t in map(json.loads, lines)}
    files = sorted(args.suggested.glob("*.json"))
    for f in files:
        write_whole(f, json.dumps(labels(exact[int(f.stem)])))
    print(f"{args.suggested}: {len(files)} frames corrected")


if __name__ == "__main__":
    main()
