# SPDX-License-Identifier: Apache-2.0
"""python3 -m unittest detector.test_photographs"""
from __future__ import annotations

import pathlib
import tempfile
import unittest

import numpy as np

from .classes import CLASSES
from .fill import filled
from .networks import Found
from .photographs import Photograph, choose, judged, kept_apart, region, voc_rows

LAYOUT = """<annotation><object><name>person</name><difficult>0</difficult>
<bndbox><xmin>11</xmin><ymin>21</ymin><xmax>50</xmax><ymax>90</ymax></bndbox>{part}</object>
<object><name>sofa</name><bndbox><xmin>1</xmin><ymin>1</ymin><xmax>9</xmax><ymax>9</ymax></bndbox></object>
<object><name>tvmonitor</name><difficult>1</difficult>
<bndbox><xmin>1</xmin><ymin>1</ymin><xmax>9</xmax><ymax>9</ymax></bndbox></object></annotation>"""
PART = "<part><name>{}</name><bndbox><xmin>21</xmin><ymin>21</ymin><xmax>30</xmax><ymax>30</ymax></bndbox></part>"


def picture(set_: str, name: str) -> Photograph:
    return Photograph(set_, name, pathlib.Path(name), [], [], ())


def found(name: str, score: float, box: tuple[float, ...]) -> Found:
    return Found(np.array([box]), np.array([score]), np.array([CLASSES.index(name)]))


class KeptApart(unittest.TestCase):
    def test_a_picture_is_left_out_by_its_name_in_every_set(self) -> None:
        with tempfile.TemporaryDirectory() as d:
            file = pathlib.Path(d) / "kept_apart.txt"
            file.write_text("coco2017/coco_000000000110\nvoc2007_layout/voc07_000035\n\n")
            apart = kept_apart(file)
        names = ["coco_000000000110", "voc07_000035", "coco_000000000111"]
        left = [p.name for _, p in choose((picture("coco2017_more", n) for n in names), apart, 1, 0.5)]
        self.assertEqual(left, ["coco_000000000111"])

    def test_what_is_judged_is_not_trained_on_under_another_set(self) -> None:
        names = [f"coco_{k:012d}" for k in range(200)]
        both = [picture("coco2017", n) for n in names] + [picture("coco2017_more", n) for n in names]
        parts = list(choose(iter(both), set(), 14, 0.1))
        self.assertEqual(len(parts), len(names))
        judge = {p.name for part, p in parts if part == "judge"}
        self.assertTrue(8 < len(judge) < 40, len(judge))
        self.assertEqual(judge, {n for n in names if judged(n, 14, 0.1)})

    def test_pictures_of_other_sets_are_never_judged(self) -> None:
        parts = choose((picture("voc2007_more", f"voc07_{k:06d}") for k in range(200)), set(), 14, 0.5)
        self.assertEqual({part for part, _ in parts}, {"train"})


class Layouts(unittest.TestCase):
    def rows(self, part: str) -> tuple[list, list, bool]:
        with tempfile.TemporaryDirectory() as d:
            file = pathlib.Path(d) / "000035.xml"
            file.write_text(LAYOUT.format(part=part))
            return voc_rows(file)

    def test_voc_parts_make_heads_and_hands_labelled_classes(self) -> None:
        boxes, ignore, whole = self.rows(PART.format("head") + PART.format("foot"))
        self.assertEqual(boxes, [("person", 10, 20, 50, 90), ("head", 20, 20, 30, 30)])
        self.assertEqual(ignore, [("monitor", 0, 0, 9, 9)])
        self.assertTrue(whole)

    def test_a_person_without_parts_leaves_them_unknown(self) -> None:
        self.assertFalse(self.rows("")[2])

    def test_regions_come_with_and_without_a_class(self) -> None:
        self.assertEqual(region([1, 2, 3, 4])[1:], (1.0, 2.0, 3.0, 4.0))
        self.assertEqual(region(["chair", 1, 2, 3, 4]), ("chair", 1.0, 2.0, 3.0, 4.0))


class Filling(unittest.TestCase):
    person = np.array([[0, 0, 0, 100, 200]], float)
    none = np.zeros((0, 5))

    def test_a_labelled_class_gets_no_boxes_from_teachers(self) -> None:
        boxes, ignore = filled(self.person, self.none, {0}, found("person", 0.9, (200, 0, 300, 200)))
        self.assertEqual((len(boxes), len(ignore)), (1, 1))

    def test_sure_boxes_are_kept_and_doubted_ones_unknown(self) -> None:
        for score, want in ((0.6, (2, 0)), (0.2, (1, 1)), (0.05, (1, 0))):
            boxes, ignore = filled(self.person, self.none, {0}, found("cup", score, (200, 0, 220, 20)))
            self.assertEqual((len(boxes), len(ignore)), want)

    def test_a_hand_counts_near_a_person_only(self) -> None:
        near = filled(self.person, self.none, {0}, found("hand", 0.9, (90, 50, 110, 70)))
        far = filled(self.person, self.none, {0}, found("hand", 0.9, (300, 50, 320, 70)))
        self.assertEqual((len(near[0]), len(far[0]), len(far[1])), (2, 1, 1))


if __name__ == "__main__":
    unittest.main()
