# SPDX-License-Identifier: Apache-2.0
"""python3 -m unittest detector.test_stages"""
from __future__ import annotations

import csv
import json
import pathlib
import tempfile
import unittest

import numpy as np

from .corrected import correct, labels
from .evaluate import Picture, rows
from .faults import faults
from .networks import Found
from .train import FIELDS, Log


class Resuming(unittest.TestCase):
    def test_lines_of_steps_that_are_done_again_fall_away(self) -> None:
        with tempfile.TemporaryDirectory() as d:
            file = pathlib.Path(d) / "log.csv"
            line = lambda step: ",".join([str(step)] + ["0.5"] * (len(FIELDS) - 1))
            file.write_text("\n".join([",".join(FIELDS), line(3), line(6), line(9), "12,0."]))
            log = Log(file, 6)
            log.parts.append((1.0, 2.0, 3.0, 4.0))
            log.write(9, 0.001)
            log.file.close()
            again = list(csv.DictReader(file.open()))
            self.assertEqual([r["step"] for r in again], ["3", "6", "9"])
            self.assertEqual(again[-1]["box"], "1.00000")

    def test_a_fresh_training_has_a_fresh_log(self) -> None:
        with tempfile.TemporaryDirectory() as d:
            file = pathlib.Path(d) / "log.csv"
            file.write_text("what was here before\n")
            Log(file, 0).file.close()
            self.assertEqual(file.read_text(), ",".join(FIELDS) + "\n")


class Faults(unittest.TestCase):
    def test_second_loose_and_other_boxes_are_told_apart(self) -> None:
        p = Picture(pathlib.Path(), rows([[0, 0, 0, 10, 20]]), rows([[0, 60, 0, 80, 20]]))
        boxes = np.float64(
            [[0, 0, 10, 20], [0, 0, 10, 19], [0, 0, 10, 7], [30, 0, 40, 20], [62, 1, 70, 19], [0, 0, 9, 9]]
        )
        found = Found(boxes, np.array([0.9, 0.8, 0.7, 0.6, 0.5, 0.1]), np.zeros(6, int))
        self.assertEqual([f.kind() for f in faults(p, found, 0, 0.3)], ["second", "loose", "rest"])


class Correcting(unittest.TestCase):
    def test_small_things_are_unknown_and_other_classes_left_out(self) -> None:
        row = lambda cls, pixels: {"cls": cls, "pixels": pixels, "box": [1, 2, 3, 4]}
        t = labels([row("person", 60), row("cup", 59), row("desk", 1000)])
        self.assertEqual(t, {"boxes": [["person", 1, 2, 3, 4]], "ignore": [["cup", 1, 2, 3, 4]]})

    def test_frames_that_nobody_corrected_go(self) -> None:
        with tempfile.TemporaryDirectory() as d:
            folder, mine = pathlib.Path(d), {"boxes": [["person", 1, 2, 3, 4]], "ignore": []}
            for name in ("000003", "000007"):
                (folder / f"{name}.json").write_text('{"boxes": [], "ignore": []}')
                (folder / f"{name}.jpg").write_text("")
            self.assertEqual(correct(folder, {7: mine, 9: mine}), 1)
            self.assertEqual(sorted(f.name for f in folder.iterdir()), ["000007.jpg", "000007.json"])
            self.assertEqual(json.loads((folder / "000007.json").read_text()), mine)


if __name__ == "__main__":
    unittest.main()
