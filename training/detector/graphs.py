# SPDX-License-Identifier: Apache-2.0
"""Runs the graph of an ONNX detector in PyTorch: batches, bfloat16, several times quicker than OpenCV.

Knows the nodes of YOLOv5 and YOLOX exports whose graph ends in the heads; weights are never trained."""
from __future__ import annotations

import ctypes
import pathlib

import numpy as np
import onnx
import torch
import torch.nn.functional as F
from onnx import helper, numpy_helper
from torch import Tensor

from .fused import library
from .networks import Network, Teachers


class Graph:
    """`run` takes [b, 3, H, W] and gives the outputs, largest map first."""

    def __init__(self, file: pathlib.Path):
        g = onnx.load(str(file)).graph
        self.weights = {t.name: torch.from_numpy(numpy_helper.to_array(t).copy()) for t in g.initializer}
        self.nodes = [(n.op_type, list(n.input), n.output[0], self._attributes(n)) for n in g.node]
        self.input, self.outputs = g.input[0].name, [o.name for o in g.output]
        for n in g.node:
            if n.op_type not in ("Conv", "Sigmoid", "Mul", "Concat", "Add", "MaxPool", "Resize", "Constant"):
                raise SystemExit(f"{file}: node {n.op_type} is not known here")
        self._find_silu()
        for name in {i[1] for op, i, _, _ in self.nodes if op == "Conv"}:
            self.weights[name] = self.weights[name].contiguous(memory_format=torch.channels_last)

    @staticmethod
    def _attributes(node: onnx.NodeProto) -> dict:
        return {a.name: helper.get_attribute_value(a) for a in node.attribute}

    def _find_silu(self) -> None:
        """x sigmoid(x) becomes one step; what nobody reads any more falls away."""
        sigmoid = {out: i[0] for op, i, out, _ in self.nodes if op == "Sigmoid"}
        for k, (op, i, out, _) in enumerate(self.nodes):
            if op == "Mul" and (sigmoid.get(i[1]) == i[0] or sigmoid.get(i[0]) == i[1]):
                x = i[0] if sigmoid.get(i[1]) == i[0] else i[1]
                self.nodes[k] = ("Silu", [x], out, {})
        read = {name for _, i, _, _ in self.nodes for name in i} | set(self.outputs)
        self.nodes = [n for n in self.nodes if n[2] in read and n[0] != "Constant"]

    @torch.no_grad()
    def run(self, x: Tensor) -> list[Tensor]:
        v = {self.input: x.contiguous(memory_format=torch.channels_last)}
        for op, i, out, a in self.nodes:
            v[out] = self._step(op, [v.get(n) for n in i], i, a)
        outs = [v[o].float() for o in self.outputs]
        return sorted(outs, key=lambda o: -o.shape[2])

    def _step(self, op: str, x: list, names: list[str], a: dict) -> Tensor:
        if op == "Conv":
            w, bias = self.weights[names[1]], self.weights[names[2]] if len(names) > 2 else None
            stride, pads = a.get("strides", [1, 1]), a.get("pads", [0, 0, 0, 0])
            return F.conv2d(x[0], w, bias, stride, pads[:2], 1, a.get("group", 1))
        if op == "Silu":
            return silu(x[0])
        if op == "Sigmoid":
            return torch.sigmoid(x[0].float())
        if op == "Concat":
            return torch.cat(x, a["axis"])
        if op == "MaxPool":
            return F.max_pool2d(x[0], a["kernel_shape"], a["strides"] if "strides" in a else 1, a["pads"][:2])
        if op == "Resize":
            return F.interpolate(x[0], scale_factor=2, mode="nearest")
        return x[0] + x[1] if op == "Add" else x[0] * x[1]


def silu(x: Tensor) -> Tensor:
    """x sigmoid(x), by fused.c where it can be."""
    c = x.shape[1]
    if x.dtype != torch.bfloat16 or c % 16 or not x.is_contiguous(memory_format=torch.channels_last):
        return F.silu(x)
    y, ones, zeros = torch.empty_like(x), torch.ones(c), torch.zeros(c)
    p = lambda t: ctypes.c_void_p(t.data_ptr())
    library().activate(p(x), ctypes.c_long(x.numel() // c), c, p(ones), p(zeros), p(y))
    return y


class GraphNetwork(Network):
    """A detector whose graph PyTorch runs, in bfloat16 unless told otherwise."""

    half = True

    def load(self, model: pathlib.Path) -> None:
        self.graph = Graph(model)

    def run(self, blob: np.ndarray) -> list[np.ndarray]:
        with torch.autocast("cpu", torch.bfloat16, enabled=self.half):
            return [o.numpy() for o in self.graph.run(torch.from_numpy(blob))]


class GraphTeachers(Teachers):
    network = GraphNetwork


class ExactNetwork(GraphNetwork):
    """In float: OpenCV's answers to 1e-5, in a third of its time."""

    half = False


class ExactTeachers(Teachers):
    network = ExactNetwork
