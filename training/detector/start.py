# SPDX-License-Identifier: Apache-2.0
"""Begins a training with the weights of an exported network of ours (same layout, batch norm folded in)."""
from __future__ import annotations

import pathlib

import onnx
import torch
from onnx import numpy_helper
from torch import Tensor, nn

from .model import Conv, Yolo


def weights(file: pathlib.Path) -> dict[str, Tensor]:
    """By the names of Yolo, without those of the export's wrapper."""
    found = {t.name: numpy_helper.to_array(t) for t in onnx.load(str(file)).graph.initializer}
    return {k.removeprefix("net."): torch.from_numpy(v.copy()) for k, v in found.items()}


def start_from(net: Yolo, file: pathlib.Path, pictures: Tensor) -> None:
    take(net, weights(file), pictures, file)


@torch.no_grad()
def take(net: Yolo, w: dict[str, Tensor], pictures: Tensor, file: pathlib.Path) -> None:
    """Every norm gets the moments that its convolution has on `pictures`, and the gain and shift that undo
    them: the network answers as the exported one, which `file` holds, did and can be trained on."""
    hooks = []
    for name, m in net.named_modules():
        if isinstance(m, Conv):
            if f"{name}.conv.weight" not in w or f"{name}.conv.bias" not in w:
                raise SystemExit(f"{file}: has no {name}; take a network that detector.export wrote")
            if w[f"{name}.conv.weight"].shape != m.conv.weight.shape:
                raise SystemExit(f"{file}: {name} has another width; --width and --depth must be the file's")
            m.conv.weight.copy_(w[f"{name}.conv.weight"])
            hooks.append(m.conv.register_forward_hook(_unfold(m, w[f"{name}.conv.bias"])))
    for k, head in enumerate(net.heads):
        head.weight.copy_(w[f"heads.{k}.weight"]), head.bias.copy_(w[f"heads.{k}.bias"])
    net.eval()
    net(pictures)
    for h in hooks:
        h.remove()
    net.train()


def _unfold(m: Conv, bias: Tensor):  # noqa: ANN202
    def hook(_: nn.Module, __: tuple, out: Tensor) -> None:
        n = m.norm
        variance, mean = torch.var_mean(out, (0, 2, 3), unbiased=False)
        n.running_mean.copy_(mean), n.running_var.copy_(variance)
        n.weight.copy_((variance + n.eps).sqrt()), n.bias.copy_(bias + mean)

    return hook
