# SPDX-License-Identifier: Apache-2.0
"""Trains the detector: python3 -m detector.train --run RUN --frames DIR [DIR ...] --steps N

RUN gets last.pt (resumed from when it exists), log.csv and curve.png. The learning rate warms up,
stays, and falls as a cosine over the last --decay steps, so that a run may be lengthened: resume
with a larger --steps. Step k draws its samples with seed (--seed, k)."""
from __future__ import annotations

import argparse
import copy
import csv
import math
import pathlib
import time

import cv2
import numpy as np
import torch
from torch import Tensor, nn

from .classes import CLASSES
from .data import Augmenter, Frames, Sample
from .loss import LossWeights, loss
from .model import Yolo

FIELDS = ("step", "lr", "box", "objectness", "classes", "seconds", "cpu_seconds")


def rate(step: int, args: argparse.Namespace) -> float:
    if step < args.warmup:
        return args.lr * (step + 1) / args.warmup
    left = args.steps - step
    if left >= args.decay:
        return args.lr
    return args.lr * (0.02 + 0.98 * 0.5 * (1 - math.cos(math.pi * left / args.decay)))


def batch(augmenter: Augmenter, size: int, seed: int, step: int, calm: bool) -> tuple[Tensor, Tensor, Tensor]:
    """Images [b, 3, h, w] RGB 0..1; targets image, class, cx, cy, w, h; regions image, x0, y0, x1, y1."""
    rng = np.random.default_rng([seed, step])
    samples: list[Sample] = [augmenter.draw(rng, calm) for _ in range(size)]
    x = np.stack([s.image[..., ::-1].transpose(2, 0, 1) for s in samples]).astype(np.float32) / 255
    targets, regions = [], []
    for i, s in enumerate(samples):
        c, b = s.boxes[:, :1], s.boxes[:, 1:]
        centre, side = (b[:, :2] + b[:, 2:]) / 2, b[:, 2:] - b[:, :2]
        targets.append(np.column_stack([np.full(len(c), i), c, centre, side]))
        regions.append(np.column_stack([np.full(len(s.ignore), i), s.ignore[:, 1:]]))
    t = lambda rows: torch.from_numpy(np.concatenate(rows).astype(np.float32))
    return torch.from_numpy(x), t(targets), t(regions)


def optimiser(net: nn.Module, args: argparse.Namespace) -> torch.optim.Optimizer:
    """Weight decay for convolutions only."""
    heavy = [p for p in net.parameters() if p.ndim > 1]
    light = [p for p in net.parameters() if p.ndim <= 1]
    groups = [{"params": heavy, "weight_decay": args.weight_decay}, {"params": light, "weight_decay": 0.0}]
    return torch.optim.AdamW(groups, lr=args.lr, betas=(0.9, 0.99))


@torch.no_grad()
def average(ema: nn.Module, net: nn.Module, step: int) -> None:
    d = min(0.998, (1 + step) / (20 + step))
    for (k, e), v in zip(ema.state_dict().items(), net.state_dict().values()):
        if e.dtype.is_floating_point:
            e.mul_(d).add_(v, alpha=1 - d)
        else:
            e.copy_(v)


def save(path: pathlib.Path, step: int, net: nn.Module, ema: nn.Module, opt: torch.optim.Optimizer, args: argparse.Namespace) -> None:
    state = {
        "step": step, "net": net.state_dict(), "ema": ema.state_dict(), "optimiser": opt.state_dict(),
        "width": args.width, "depth": args.depth, "options": {k: str(v) for k, v in vars(args).items()},
    }  # fmt: skip
    tmp = path.with_suffix(".tmp")
    torch.save(state, tmp)
    tmp.rename(path)


def draw_curve(log: pathlib.Path, out: pathlib.Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    rows = list(csv.DictReader(log.open()))
    steps = [int(r["step"]) for r in rows]
    fig, ax = plt.subplots(figsize=(7, 4))
    for name in ("box", "objectness", "classes"):
        ax.plot(steps, [float(r[name]) for r in rows], label=name)
    ax.set(xlabel="step", ylabel="loss", yscale="log")
    ax.legend()
    fig.tight_layout()
    fig.savefig(out, dpi=100)
    plt.close(fig)


def train(args: argparse.Namespace) -> None:
    torch.manual_seed(args.seed)
    torch.set_num_threads(args.threads)
    cv2.setNumThreads(1)
    frames = Frames(args.frames)
    augmenter = Augmenter(frames, *args.size)
    print(f"{len(frames)} frames, {len(augmenter.real)} of them real", flush=True)
    net = Yolo(len(CLASSES), args.width, args.depth).train()
    ema = copy.deepcopy(net).eval()
    opt, start, last = optimiser(net, args), 0, args.run / "last.pt"
    args.run.mkdir(parents=True, exist_ok=True)
    if last.exists():
        state = torch.load(last, map_location="cpu")
        net.load_state_dict(state["net"]), ema.load_state_dict(state["ema"])
        opt.load_state_dict(state["optimiser"])
        start = state["step"]
    log = (args.run / "log.csv").open("a", newline="")
    out = csv.writer(log)
    if start == 0:
        out.writerow(FIELDS)
    t0, c0, parts = time.time(), time.process_time(), []
    for step in range(start, args.steps):
        for g in opt.param_groups:
            g["lr"] = rate(step, args)
        x, targets, regions = batch(augmenter, args.batch, args.seed, step, args.steps - step < args.decay // 2)
        total, p = loss(net(x), targets, regions, LossWeights())
        opt.zero_grad(set_to_none=True)
        total.backward()
        nn.utils.clip_grad_norm_(net.parameters(), 10.0 * args.batch / 16)
        opt.step()
        average(ema, net, step)
        parts.append(p)
        if (step + 1) % args.every == 0 or step + 1 == args.steps:
            mean = np.mean(parts, 0)
            row = [step + 1, f"{rate(step, args):.6f}", *(f"{m:.5f}" for m in mean)]
            row += [f"{time.time() - t0:.0f}", f"{time.process_time() - c0:.0f}"]
            out.writerow(row), log.flush()
            print(*row, flush=True)
            parts = []
            save(last, step + 1, net, ema, opt, args)
    draw_curve(args.run / "log.csv", args.run / "curve.png")


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__)
    a = ap.add_argument
    a("--run", type=pathlib.Path, required=True)
    a("--frames", type=pathlib.Path, nargs="+", required=True)
    a("--steps", type=int, default=4000)
    a("--decay", type=int, default=1500)
    a("--warmup", type=int, default=100)
    a("--batch", type=int, default=16)
    a("--size", type=int, nargs=2, default=[320, 256], help="width and height, multiples of 32")
    a("--lr", type=float, default=2e-3)
    a("--weight-decay", type=float, default=0.02)
    a("--width", type=float, default=0.25)
    a("--depth", type=float, default=0.33)
    a("--seed", type=int, default=1)
    a("--threads", type=int, default=2)
    a("--every", type=int, default=50, help="steps between log lines and checkpoints")
    train(ap.parse_args())


if __name__ == "__main__":
    main()
