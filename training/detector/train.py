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
import multiprocessing
import os
import pathlib
import time

import cv2
import numpy as np
import torch
import torch.distributed as dist
from torch import Tensor, nn

from .classes import CLASSES
from .data import Augmenter, Frames, Sample, letterboxed, size
from .distil import lessons, teachers
from .files import whole, write_whole
from .fused import library
from .loss import LossWeights, loss
from .model import Yolo
from .start import start_from

FIELDS = ("step", "lr", "box", "objectness", "classes", "distilled", "seconds", "cpu_seconds")
SHARES = {"rendered": 0.46, "photograph": 0.47, "real": 0.07}  # of the pictures drawn


def rate(step: int, args: argparse.Namespace) -> float:
    if step < args.warmup:
        return args.lr * (step + 1) / args.warmup
    left = args.steps - step
    if left >= args.decay:
        return args.lr
    return args.lr * (0.02 + 0.98 * 0.5 * (1 - math.cos(math.pi * left / args.decay)))


def batch(samples: list[Sample]) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Images [b, 3, h, w] RGB 0..1; targets image, class, cx, cy, w, h; regions image, x0, y0, x1, y1; which
    images are real."""
    x = torch.from_numpy(np.stack([s.image[..., ::-1] for s in samples])).permute(0, 3, 1, 2).float() / 255
    targets, regions = [], []
    for i, s in enumerate(samples):
        c, b = s.boxes[:, :1], s.boxes[:, 1:]
        centre, side = (b[:, :2] + b[:, 2:]) / 2, b[:, 2:] - b[:, :2]
        targets.append(np.column_stack([np.full(len(c), i), c, centre, side]))
        regions.append(np.column_stack([np.full(len(s.ignore), i), s.ignore[:, 1:]]))
    t = lambda rows: torch.from_numpy(np.concatenate(rows).astype(np.float32))
    return x, t(targets), t(regions), torch.tensor([i for i, s in enumerate(samples) if s.real], dtype=torch.long)


def draw(augmenters: list[Augmenter], args: argparse.Namespace, step: int, rank: int) -> list[Sample]:
    """The samples of one worker for one step: all of one size, as many as cost the same at every size."""
    a = augmenters[int(np.random.default_rng([args.seed, step]).integers(len(augmenters)))]
    smallest, calm = min(b.w * b.h for b in augmenters), args.steps - step < args.decay // 4
    rng = np.random.default_rng([args.seed, step, rank])
    return [a.draw(rng, calm) for _ in range(round(args.batch * smallest / (a.w * a.h)))]


def optimiser(nets: nn.ModuleList, args: argparse.Namespace) -> torch.optim.Optimizer:
    """Weight decay for convolutions only."""
    heavy = [p for p in nets.parameters() if p.ndim > 1]
    light = [p for p in nets.parameters() if p.ndim <= 1]
    groups = [{"params": heavy, "weight_decay": args.weight_decay}, {"params": light, "weight_decay": 0.0}]
    return torch.optim.AdamW(groups, lr=args.lr, betas=(0.9, 0.99))


class Trainee:
    """The network, its running average, the heads that learn from the teacher, the optimiser; or a resumed one."""

    def __init__(self, args: argparse.Namespace, frames: Frames):
        self.net = Yolo(len(CLASSES), args.width, args.depth).to(memory_format=torch.channels_last).train()
        self.teachers = teachers(self.net.channels, args.teacher, args.distil)
        self.step, last = 0, args.run / "last.pt"
        if args.start and not last.exists():
            start_from(self.net, args.start, views(frames, args.seed, 48))
        self.ema = copy.deepcopy(self.net).eval()
        self.both = nn.ModuleList([self.net, self.teachers])
        self.optimiser = optimiser(self.both, args)
        if last.exists():
            state = torch.load(last, map_location="cpu")
            self.net.load_state_dict(state["net"]), self.ema.load_state_dict(state["ema"])
            self.teachers.load_state_dict(state["teachers"])
            self.optimiser.load_state_dict(state["optimiser"])
            self.step = state["step"]


def views(frames: Frames, seed: int, n: int) -> Tensor:
    """Some pictures of the training as they are, at the smallest size."""
    chosen = np.random.default_rng(seed).choice(len(frames), min(n, len(frames)), replace=False)
    return batch([letterboxed(frames.sample(int(k)), 320, 256) for k in chosen])[0]


@torch.no_grad()
def average(ema: nn.Module, net: nn.Module, step: int) -> None:
    d = min(0.999, (1 + step) / (20 + step))
    for (k, e), v in zip(ema.state_dict().items(), net.state_dict().values()):
        if e.dtype.is_floating_point:
            e.mul_(d).add_(v, alpha=1 - d)
        else:
            e.copy_(v)


def save(path: pathlib.Path, step: int, t: Trainee, args: argparse.Namespace) -> None:
    state = {
        "step": step, "net": t.net.state_dict(), "ema": t.ema.state_dict(), "optimiser": t.optimiser.state_dict(),
        "teachers": t.teachers.state_dict(),
        "width": args.width, "depth": args.depth, "options": {k: str(v) for k, v in vars(args).items()},
    }  # fmt: skip
    with whole(path) as tmp:
        torch.save(state, tmp)


def draw_curve(log: pathlib.Path, out: pathlib.Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    rows = list(csv.DictReader(log.open()))
    steps = [int(r["step"]) for r in rows]
    fig, ax = plt.subplots(figsize=(7, 4))
    for name in ("box", "objectness", "classes", "distilled"):
        ax.plot(steps, [float(r[name]) for r in rows], label=name)
    ax.set(xlabel="step", ylabel="loss", yscale="log")
    ax.legend()
    fig.tight_layout()
    fig.savefig(out, dpi=100)
    plt.close(fig)


def share_gradients(net: nn.Module, workers: int) -> None:
    """Every worker gets the mean of all."""
    if workers == 1:
        return
    for p in net.parameters():  # a worker without real pictures taught the other heads nothing
        p.grad = torch.zeros_like(p) if p.grad is None else p.grad
    grads = [p.grad for p in net.parameters() if p.grad is not None]
    flat = torch.cat([g.reshape(-1) for g in grads])
    dist.all_reduce(flat)
    for g, part in zip(grads, flat.split([g.numel() for g in grads])):
        g.copy_(part.view_as(g)).div_(workers)


class Log:
    """log.csv, and the same lines to read; the mean of the losses since the last line. Resumed at `step`, lines
    of steps that are done again fall away."""

    def __init__(self, file: pathlib.Path, step: int):
        before = file.read_text().splitlines()[1:] if step and file.exists() else []
        done = [line for line in before if line.count(",") == len(FIELDS) - 1 and int(line.split(",")[0]) <= step]
        write_whole(file, "\n".join([",".join(FIELDS), *done, ""]))
        self.file, self.parts = file.open("a", newline=""), []
        self.out = csv.writer(self.file, lineterminator="\n")
        self.wall, self.cpu = time.time(), time.process_time()

    def write(self, step: int, lr: float) -> None:
        row = [step, f"{lr:.6f}", *(f"{m:.5f}" for m in np.mean(self.parts, 0))]
        row += [f"{time.time() - self.wall:.0f}", f"{time.process_time() - self.cpu:.0f}"]
        self.out.writerow(row), self.file.flush()
        print(*row, flush=True)
        self.parts = []


def work(rank: int, frames: Frames, args: argparse.Namespace) -> None:
    """One worker: its own samples, the same weights as the others."""
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    torch.manual_seed(args.seed)
    if args.workers > 1:
        where = f"file://{(args.run / 'workers').resolve()}"
        dist.init_process_group("gloo", init_method=where, rank=rank, world_size=args.workers)
    t = Trainee(args, frames)
    augmenters = [Augmenter(frames, *size, SHARES) for size in args.sizes]
    log = Log(args.run / "log.csv", t.step) if rank == 0 else None
    for step in range(t.step, args.steps):
        for g in t.optimiser.param_groups:
            g["lr"] = rate(step, args)
        x, targets, regions, real = batch(draw(augmenters, args, step, rank))
        with torch.autocast("cpu", torch.bfloat16, enabled=args.precision == "bf16"):
            features = t.net.features(x)
            outputs = t.net.answers(features)
            some = real[: len(x) // 4]  # teachers cost as much as the network
            apart = lessons(t.teachers, x[some], [f[some] for f in features], step < args.warmup)
        total, parts = loss(outputs, targets, regions, LossWeights())
        total = total / len(x)
        total, parts = total + apart, (*parts, float(apart.detach()))
        t.optimiser.zero_grad(set_to_none=True)
        total.backward()
        share_gradients(t.both, args.workers)
        nn.utils.clip_grad_norm_(t.both.parameters(), args.clip)
        t.optimiser.step()
        if log is None:
            continue
        average(t.ema, t.net, step)
        log.parts.append(parts)
        if (step + 1) % args.every == 0 or step + 1 == args.steps:
            log.write(step + 1, rate(step, args))
            save(args.run / "last.pt", step + 1, t, args)


def train(args: argparse.Namespace) -> None:
    args.run.mkdir(parents=True, exist_ok=True)
    (args.run / "workers").unlink(missing_ok=True)
    library()
    frames = Frames(args.frames, args.photographs)
    print(f"{len(frames)} pictures: " + ", ".join(f"{len(frames.of(k))} {k}" for k in SHARES), flush=True)
    others = [
        multiprocessing.get_context("fork").Process(target=work, args=(k, frames, args)) for k in range(1, args.workers)
    ]
    for o in others:
        o.start()
    work(0, frames, args)
    for o in others:
        o.join()
    draw_curve(args.run / "log.csv", args.run / "curve.png")


def main() -> None:
    os.environ.setdefault("GLOO_SOCKET_IFNAME", "lo")
    ap = argparse.ArgumentParser(description=__doc__)
    a = ap.add_argument
    a("--run", type=pathlib.Path, required=True)
    a("--frames", type=pathlib.Path, nargs="*", default=[], help="folders of rendered and other frames")
    a("--photographs", type=pathlib.Path, nargs="*", default=[], help="folders of SET/NAME.jpg (detector.fill)")
    a("--start", type=pathlib.Path, help="our own network as ONNX to begin with instead of nothing")
    a("--teacher", type=pathlib.Path, help="folder of the teachers: learn their soft answers too")
    a("--distil", type=float, nargs=2, default=(0.7, 0.06), help="weight of that, of the COCO and the body-head-hand one")
    a("--steps", type=int, default=10000)
    a("--decay", type=int, default=5000)
    a("--warmup", type=int, default=300)
    a("--batch", type=int, default=16, help="pictures of the smallest size that a worker takes a step")
    a("--sizes", type=size, nargs="+", default=[(320, 256), (320, 256), (416, 320)], help="one is drawn for every step")
    a("--workers", type=int, default=2, help="processes of one thread")
    a("--precision", choices=("bf16", "fp32"), default="bf16", help="fp32 for processors without bfloat16")
    a("--clip", type=float, default=0.6, help="largest norm of a gradient")
    a("--lr", type=float, default=1.5e-3)
    a("--weight-decay", type=float, default=0.02)
    a("--width", type=float, default=0.25)
    a("--depth", type=float, default=0.33)
    a("--seed", type=int, default=1)
    a("--every", type=int, default=50, help="steps between log lines and checkpoints")
    train(ap.parse_args())


if __name__ == "__main__":
    main()
