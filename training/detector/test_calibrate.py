# SPDX-License-Identifier: Apache-2.0
"""python3 -m unittest detector.test_calibrate"""
import unittest

import numpy as np

from .calibrate import LEAST, MOST, UNKNOWN, sure, threshold


class Thresholds(unittest.TestCase):
    scores = np.array([0.9, 0.8, 0.7, 0.6, 0.5, 0.4])
    hit = np.array([1, 1, 1, 0, 1, 0], bool)

    def test_the_lowest_score_from_which_on_enough_is_right(self) -> None:
        self.assertEqual(threshold(self.scores, self.hit, 20, 0.8), 0.5)  # four of five
        self.assertEqual(threshold(self.scores, self.hit, 20, 0.9), 0.7)

    def test_few_boxes_say_nothing_and_none_that_is_right_is_the_given_score(self) -> None:
        self.assertEqual(threshold(self.scores, self.hit, 3, 0.9), UNKNOWN)
        self.assertEqual(threshold(self.scores, ~self.hit, 20, 0.9, MOST), MOST)
        self.assertEqual(threshold(self.scores / 10, np.ones(6, bool), 20, 0.9), LEAST)

    def test_each_half_of_the_pictures_is_judged_by_the_other_half(self) -> None:
        # All of the even pictures is right; of the odd ones only what is above 0.65.
        number, lower = np.repeat([0, 1], 6), self.scores - 0.01
        hit = np.concatenate([np.ones(6, bool), lower > 0.65])
        told = sure(np.concatenate([self.scores, lower]), hit, number, 24, 0.95)
        # Odd ones from 0.4 on: three of five right; even ones from 0.69 on: three of three.
        self.assertEqual(told["boxes"], 8)
        self.assertAlmostEqual(told["precision"], 6 / 8)
        self.assertAlmostEqual(told["recall"], 6 / 24)
        self.assertEqual(told["score"], 0.6)

    def test_of_a_class_with_few_boxes_hardly_one_is_sure(self) -> None:
        self.assertEqual(sure(self.scores, self.hit, np.arange(6), 3, 0.9)["score"], MOST)


if __name__ == "__main__":
    unittest.main()
