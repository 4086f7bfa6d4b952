# SPDX-License-Identifier: Apache-2.0
"""Batch norm and SiLU as one step of autograd, in bfloat16 (fused.c): half of the training time otherwise."""
from __future__ import annotations

import ctypes
import functools
import os
import pathlib
import subprocess
import tempfile

import torch
from torch import Tensor, nn

SOURCE = pathlib.Path(__file__).with_name("fused.c")


@functools.lru_cache(None)
def library() -> ctypes.CDLL:
    """Compiled for this machine when it is first wanted."""
    with tempfile.TemporaryDirectory() as d:
        so = os.path.join(d, "fused.so")
        flags = ["-O3", "-march=native", "-shared", "-fPIC"]
        subprocess.run(["gcc", *flags, "-o", so, str(SOURCE), "-lm"], check=True)
        return ctypes.CDLL(so)


def _p(t: Tensor) -> ctypes.c_void_p:
    return ctypes.c_void_p(t.data_ptr())


class _BatchNormSilu(torch.autograd.Function):
    @staticmethod
    def forward(ctx: object, x: Tensor, gain: Tensor, shift: Tensor, eps: float) -> tuple[Tensor, Tensor, Tensor]:
        b, c, h, w = x.shape
        rows = ctypes.c_long(b * h * w)
        mean, variance = torch.empty(c), torch.empty(c)
        library().moments(_p(x), rows, c, _p(mean), _p(variance))
        inverse = torch.rsqrt(variance + eps)
        a = gain.detach() * inverse
        y = torch.empty_like(x)
        shifted = shift.detach() - mean * a
        library().activate(_p(x), rows, c, _p(a), _p(shifted), _p(y))
        ctx.save_for_backward(x, gain, shift, mean, inverse)  # type: ignore[attr-defined]
        ctx.mark_non_differentiable(mean, variance)  # type: ignore[attr-defined]
        return y, mean, variance

    @staticmethod
    def backward(ctx: object, dy: Tensor, *_: Tensor) -> tuple[Tensor, Tensor, Tensor, None]:
        x, gain, shift, mean, inverse = ctx.saved_tensors  # type: ignore[attr-defined]
        b, c, h, w = x.shape
        dy = dy.to(torch.bfloat16).contiguous(memory_format=torch.channels_last)
        dx, dgain, dshift = torch.empty_like(x), torch.empty(c), torch.empty(c)
        library().back(_p(x), _p(dy), ctypes.c_long(b * h * w), c, _p(gain), _p(shift), _p(mean), _p(inverse),
                       _p(dgain), _p(dshift), _p(dx))  # fmt: skip
        return dx, dgain, dshift, None


def batch_norm_silu(x: Tensor, norm: nn.BatchNorm2d) -> Tensor:
    """What norm and then SiLU do in training, for x [b, c, h, w] in bfloat16; updates the running moments."""
    if x.shape[1] % 16:
        raise ValueError(f"{x.shape[1]} channels: fused.c takes multiples of 16 (--width, or --precision fp32)")
    x = x.contiguous(memory_format=torch.channels_last)
    y, mean, variance = _BatchNormSilu.apply(x, norm.weight, norm.bias, norm.eps)
    n = x.numel() // x.shape[1]
    with torch.no_grad():
        norm.running_mean.lerp_(mean, norm.momentum)
        norm.running_var.lerp_(variance * (n / max(n - 1, 1)), norm.momentum)
        norm.num_batches_tracked += 1
    return y
