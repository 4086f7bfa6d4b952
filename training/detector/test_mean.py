# SPDX-License-Identifier: Apache-2.0
"""python3 -m unittest detector.test_mean"""
from __future__ import annotations

import pathlib
import tempfile
import unittest

import torch

from .classes import CLASSES
from .export import export
from .mean import mean
from .model import Yolo
from .start import take, weights

WIDTH, DEPTH = 0.0625, 0.33


def network(seed: int, width: float = WIDTH) -> Yolo:
    torch.manual_seed(seed)
    net = Yolo(len(CLASSES), width, DEPTH).eval()
    with torch.no_grad():
        for p in net.parameters():  # equal biases would be written once
            p.add_(0.02 * torch.randn_like(p))
    return net


class TestMean(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def exported(self, seed: int, width: float = WIDTH) -> pathlib.Path:
        file = pathlib.Path(self.folder.name) / f"{seed}_{width}.onnx"
        export(network(seed, width), file)
        return file

    def test_of_one_network_twice_answers_like_it(self) -> None:
        file, net = self.exported(1), network(9)
        take(net, mean([file, file]), torch.rand(2, 3, 64, 64), file)
        x = torch.rand(1, 3, 64, 96)
        with torch.no_grad():
            for mine, theirs in zip(net.eval()(x), network(1)(x)):
                torch.testing.assert_close(mine, theirs, atol=1e-4, rtol=1e-3)

    def test_lies_between_two(self) -> None:
        a, b = self.exported(1), self.exported(2)
        both, of_a, of_b = mean([a, b]), weights(a), weights(b)
        moved = 0
        for name, m in both.items():
            torch.testing.assert_close(m, (of_a[name] + of_b[name]) / 2)
            moved += int(not torch.equal(m, of_a[name]))
        self.assertGreater(moved, len(both) // 2)

    def test_another_layout_is_refused(self) -> None:
        with self.assertRaisesRegex(SystemExit, "another layout"):
            mean([self.exported(1), self.exported(2, 0.125)])

    def test_what_is_no_network_of_ours_is_named(self) -> None:
        with self.assertRaisesRegex(SystemExit, "teacher.onnx: has no stem"):
            take(network(1), {"conv1.weight": torch.zeros(1)}, torch.rand(1, 3, 64, 64), pathlib.Path("teacher.onnx"))

    def test_another_width_than_was_said_is_named(self) -> None:
        file = self.exported(1, 0.125)
        with self.assertRaisesRegex(SystemExit, "another width"):
            take(network(1), weights(file), torch.rand(1, 3, 64, 64), file)


if __name__ == "__main__":
    unittest.main()
