# SPDX-License-Identifier: Apache-2.0
"""python3 -m unittest detector.test_distil"""
from __future__ import annotations

import unittest

import torch
from torch import Tensor, nn

from .distil import Parts, Teacher, Things, lessons

CHANNELS, SIZES = (4, 6, 8), ((8, 8), (4, 4), (2, 2))


class Pretended:
    """A teacher's graph whose answers are given."""

    def __init__(self, answers: list[Tensor]):
        self.given = answers

    def run(self, x: Tensor) -> list[Tensor]:
        return self.given


def pretending(kind: type[Teacher], answers: list[Tensor], weight: float = 1.0) -> Teacher:
    t = kind.__new__(kind)
    nn.Module.__init__(t)
    t.weight, t.graph = weight, Pretended(answers)  # type: ignore[assignment]
    t.heads = nn.ModuleList(nn.Identity() for _ in CHANNELS)
    return t


def logits(outputs: int, seed: int) -> list[Tensor]:
    g = torch.Generator().manual_seed(seed)
    return [torch.randn(2, outputs, h, w, generator=g) for h, w in SIZES]


class Distance(unittest.TestCase):
    def nearest_at_the_same_answers(self, kind: type[Teacher], exact: list[Tensor], answers: list[Tensor]) -> None:
        """Soft answers leave entropy: the distance there is not zero, but nowhere smaller."""
        t = pretending(kind, answers)
        least = float(t.distance(exact, answers))
        for seed in range(3):
            other = [e + 0.3 * n for e, n in zip(exact, logits(kind.outputs, seed))]
            self.assertGreater(float(t.distance(other, answers)), least + 0.01)

    def test_things_answer_after_the_sigmoid(self) -> None:
        exact = logits(255, 1)
        self.nearest_at_the_same_answers(Things, exact, [e.sigmoid() for e in exact])

    def test_parts_have_boxes_without_a_sigmoid(self) -> None:
        exact = logits(8, 2)
        self.nearest_at_the_same_answers(Parts, exact, [torch.cat([e[:, :4], e[:, 4:].sigmoid()], 1) for e in exact])

    def test_parts_are_asked_in_blue_green_red_up_to_255(self) -> None:
        t, seen = pretending(Parts, []), []
        t.graph.run = lambda x: seen.append(x)  # type: ignore[assignment, method-assign]
        t.answers(torch.tensor([0.0, 0.5, 1.0]).view(1, 3, 1, 1))
        self.assertEqual(seen[0].flatten().tolist(), [255, 127.5, 0])


class Lessons(unittest.TestCase):
    def setUp(self) -> None:
        self.answers = [e.sigmoid() for e in logits(255, 1)]
        self.features = [e.requires_grad_() for e in logits(255, 3)]

    def test_weigh_what_they_say(self) -> None:
        x = torch.zeros(2, 3, 64, 64)
        taught = lambda weight: nn.ModuleList([pretending(Things, self.answers, weight)])
        one, half = (float(lessons(taught(w), x, self.features, False)) for w in (1.0, 0.5))
        self.assertAlmostEqual(half, one / 2, places=5)

    def test_leave_the_network_alone_while_heads_know_nothing(self) -> None:
        t = pretending(Things, self.answers)
        t.heads = nn.ModuleList(nn.Conv2d(255, 255, 1) for _ in CHANNELS)
        lessons(nn.ModuleList([t]), torch.zeros(2, 3, 64, 64), self.features, True).backward()
        self.assertTrue(all(f.grad is None for f in self.features))
        self.assertTrue(all(h.weight.grad.abs().sum() > 0 for h in t.heads))

    def test_no_real_picture_no_lesson(self) -> None:
        t = nn.ModuleList([pretending(Things, self.answers)])
        self.assertEqual(float(lessons(t, torch.zeros(0, 3, 64, 64), self.features, False)), 0)


if __name__ == "__main__":
    unittest.main()
