# SPDX-License-Identifier: Apache-2.0
"""The YOLOv5 (v6) layout: CSP backbone, SPPF, PAN neck, three anchor heads."""
from __future__ import annotations

import math

import torch
from torch import Tensor, nn

from .fused import batch_norm_silu

STRIDES = (8, 16, 32)
# Anchors (width, height in pixels) of the published COCO weights, which the project's decoder knows.
ANCHORS = (((10, 13), (16, 30), (33, 23)), ((30, 61), (62, 45), (59, 119)), ((116, 90), (156, 198), (373, 326)))


class Conv(nn.Module):
    """Convolution, batch norm, SiLU; fuse() folds the norm into the convolution."""

    def __init__(self, cin: int, cout: int, k: int = 1, s: int = 1, p: int | None = None):
        super().__init__()
        self.conv = nn.Conv2d(cin, cout, k, s, k // 2 if p is None else p, bias=False)
        self.norm: nn.Module = nn.BatchNorm2d(cout, eps=1e-3, momentum=0.03)
        self.act = nn.SiLU(inplace=True)

    def forward(self, x: Tensor) -> Tensor:
        x = self.conv(x)
        if self.training and x.dtype == torch.bfloat16:
            return batch_norm_silu(x, self.norm)
        return self.act(self.norm(x))

    def fuse(self) -> None:
        n, c = self.norm, self.conv
        if not isinstance(n, nn.BatchNorm2d):
            return
        gain = n.weight / torch.sqrt(n.running_var + n.eps)
        c.weight.data *= gain[:, None, None, None]
        c.bias = nn.Parameter((n.bias - n.running_mean * gain).detach())
        self.norm = nn.Identity()


class Bottleneck(nn.Module):
    def __init__(self, c: int, shortcut: bool):
        super().__init__()
        self.a, self.b, self.shortcut = Conv(c, c, 1), Conv(c, c, 3), shortcut

    def forward(self, x: Tensor) -> Tensor:
        y = self.b(self.a(x))
        return x + y if self.shortcut else y


class C3(nn.Module):
    """Cross-stage partial block: n bottlenecks on one half of the channels."""

    def __init__(self, cin: int, cout: int, n: int, shortcut: bool = True):
        super().__init__()
        h = cout // 2
        self.left, self.right, self.out = Conv(cin, h), Conv(cin, h), Conv(2 * h, cout)
        self.blocks = nn.Sequential(*(Bottleneck(h, shortcut) for _ in range(n)))

    def forward(self, x: Tensor) -> Tensor:
        return self.out(torch.cat((self.blocks(self.left(x)), self.right(x)), 1))


class SPPF(nn.Module):
    """Max pools of 5, 9 and 13 by repetition."""

    def __init__(self, c: int):
        super().__init__()
        self.a, self.b = Conv(c, c // 2), Conv(c * 2, c)
        self.pool = nn.MaxPool2d(5, 1, 2)

    def forward(self, x: Tensor) -> Tensor:
        x = self.a(x)
        y = self.pool(x)
        z = self.pool(y)
        return self.b(torch.cat((x, y, z, self.pool(z)), 1))


class Yolo(nn.Module):
    """[b, 3, H, W] RGB in 0..1 -> three logit maps [b, 3 (5 + C), H/s, W/s] for s = 8, 16, 32."""

    def __init__(self, classes: int, width: float = 0.25, depth: float = 0.33):
        super().__init__()
        c1, c2, c3, c4, c5 = (max(8, 8 * math.ceil(c * width / 8)) for c in (64, 128, 256, 512, 1024))
        n = lambda k: max(1, round(k * depth))
        self.stem = nn.Sequential(Conv(3, c1, 6, 2, 2), Conv(c1, c2, 3, 2), C3(c2, c2, n(3)))
        self.down3 = nn.Sequential(Conv(c2, c3, 3, 2), C3(c3, c3, n(6)))
        self.down4 = nn.Sequential(Conv(c3, c4, 3, 2), C3(c4, c4, n(9)))
        self.down5 = nn.Sequential(Conv(c4, c5, 3, 2), C3(c5, c5, n(3)), SPPF(c5))
        self.lat5, self.lat4 = Conv(c5, c4), Conv(c4, c3)
        self.up = nn.Upsample(scale_factor=2, mode="nearest")
        self.top4, self.top3 = C3(2 * c4, c4, n(3), False), C3(2 * c3, c3, n(3), False)
        self.pan3, self.pan4 = Conv(c3, c3, 3, 2), Conv(c4, c4, 3, 2)
        self.bot4, self.bot5 = C3(2 * c3, c4, n(3), False), C3(2 * c4, c5, n(3), False)
        self.heads = nn.ModuleList(nn.Conv2d(c, 3 * (5 + classes), 1) for c in (c3, c4, c5))
        self.classes, self.channels = classes, (c3, c4, c5)
        self._bias()

    def _bias(self) -> None:
        """Starts with few objects and evenly unlikely classes."""
        for head, s in zip(self.heads, STRIDES):
            b = head.bias.data.view(3, -1)
            b[:, 4] = math.log(8 / (320 * 256 / s**2))
            b[:, 5:] = math.log(0.6 / (self.classes - 0.99))

    def features(self, x: Tensor) -> list[Tensor]:
        """What the heads read: c3, c4, c5 channels at strides 8, 16, 32."""
        p3 = self.down3(self.stem(x))
        p4 = self.down4(p3)
        l5 = self.lat5(self.down5(p4))
        l4 = self.lat4(self.top4(torch.cat((self.up(l5), p4), 1)))
        f3 = self.top3(torch.cat((self.up(l4), p3), 1))
        f4 = self.bot4(torch.cat((self.pan3(f3), l4), 1))
        return [f3, f4, self.bot5(torch.cat((self.pan4(f4), l5), 1))]

    def forward(self, x: Tensor) -> list[Tensor]:
        return self.answers(self.features(x))

    def answers(self, features: list[Tensor]) -> list[Tensor]:
        with torch.autocast("cpu", enabled=False):  # box sides need more than eight bits
            exact = (f.float() if f.dtype != torch.float32 else f for f in features)  # no cast in an export
            return [h(f) for h, f in zip(self.heads, exact)]

    def fuse(self) -> "Yolo":
        for m in self.modules():
            if isinstance(m, Conv):
                m.fuse()
        return self


class Sigmoids(nn.Module):
    """What is exported: the heads after the sigmoid, without reshapes."""

    def __init__(self, net: Yolo):
        super().__init__()
        self.net = net

    def forward(self, x: Tensor) -> list[Tensor]:
        return [torch.sigmoid(y) for y in self.net(x)]
