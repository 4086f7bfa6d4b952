# SPDX-License-Identifier: Apache-2.0
"""Compares fused.c with PyTorch's own batch norm and SiLU: python3 -m detector.check_fused"""
from __future__ import annotations

import torch
from torch import Tensor, nn

from .fused import batch_norm_silu

VALUES, SUMS = 8e-3, 1e-5  # relative: one bit of bfloat16; float


def difference(a: Tensor, b: Tensor) -> float:
    return float((a.float() - b.float()).abs().max() / b.float().abs().max())


def compare(channels: int) -> dict[str, tuple[float, float]]:
    """What differs by how much, and by how much it may."""
    norms = [nn.BatchNorm2d(channels, eps=1e-3, momentum=0.03) for _ in range(2)]
    for n in norms:
        n.weight.data, n.bias.data = torch.linspace(0.5, 2, channels), torch.linspace(-1, 1, channels)
    x = (2 * torch.randn(4, channels, 31, 29) + 1).bfloat16().contiguous(memory_format=torch.channels_last)
    dy = torch.randn_like(x)
    ours, theirs = x.clone().requires_grad_(), x.float().requires_grad_()
    y, z = batch_norm_silu(ours, norms[0]), nn.functional.silu(norms[1](theirs))
    y.backward(dy), z.backward(dy.float())
    a, b = norms
    return {
        "y": (difference(y, z), VALUES), "dx": (difference(ours.grad, theirs.grad), VALUES),
        "dgain": (difference(a.weight.grad, b.weight.grad), SUMS), "dshift": (difference(a.bias.grad, b.bias.grad), SUMS),
        "mean": (difference(a.running_mean, b.running_mean), SUMS), "variance": (difference(a.running_var, b.running_var), SUMS),
    }  # fmt: skip


def main() -> None:
    torch.manual_seed(0)
    for channels in (16, 48, 256):
        for name, (found, allowed) in compare(channels).items():
            if found > allowed:
                raise SystemExit(
                    f"fused.c, {channels} channels: {name} differs by {found:.1e}, more than {allowed:.0e}"
                )
    print("fused.c agrees with PyTorch")


if __name__ == "__main__":
    main()
