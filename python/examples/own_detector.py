#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # A detector of your own
# Any function from a picture to boxes or silhouettes is a detector: YOLO of any version, SAM, or the
# ten lines below. It is called on a thread of its own while feature points are extracted.
# %% [script]
"""A detector of one's own: any function from a picture to boxes, here what is near.

own_detector.py [RECORDING [FRAMES]]
"""
import sys

# %%
from pathlib import Path

import numpy as np

import ydd_slam

recording = "../../samples/office_crowd"  # whatever `ydd-slam run` takes
frames = 30  # 0: all of it
# %% [script]
recording = Path(__file__).resolve().parent / recording
if len(sys.argv) > 1:
    recording, frames = sys.argv[1], 0
if len(sys.argv) > 2:
    frames = int(sys.argv[2])
# %% [markdown]
# Put your network in the place of `look`. It gets an `RgbdFrame`: `frame.colour` is (height, width, 3)
# of `uint8`, blue green red, and `frame.depth_m` (height, width) of `float32` in metres, 0 where there
# is no reading; both are views, nothing is copied. It gives a list of `(class, (x0, y0, x1, y1), score)`
# in pixels, or of `Detection`, which may have a mask.


# %%
def look(frame):
    """What is nearer than 1.6 m is a person: no good detector, but a short one."""
    near = (frame.depth_m > 0) & (frame.depth_m < 1.6)
    if near.mean() < 0.02:
        return []
    return [ydd_slam.Detection("person", score=0.8, mask=near)]  # the box is that round the mask


# %% [markdown]
# What the detector finds decides *where* something may move; the rules of the method decide which
# feature points lie on it. `frame.rejected.rule` has one of `ydd_slam.RULES` for each point that went.
# %%
sequence = ydd_slam.open_sequence(recording, max_frames=frames)
with ydd_slam.Slam(sequence.camera, detector=look) as slam:
    for picture in sequence:
        frame = slam.process(picture)
        gone = np.bincount(frame.rejected.rule, minlength=len(ydd_slam.RULES))
        rules = ", ".join(f"{n} {ydd_slam.RULES[i]}" for i, n in enumerate(gone) if n)
        print(f"{frame.index:4d} {frame.state}: {len(frame.kept)} points kept; rejected: {rules or 'none'}")
# %% [markdown]
# How far off it was, where the recording has a ground truth:
# %%
if sequence.groundtruth:
    print(f"ATE {ydd_slam.ate(sequence.groundtruth, slam.trajectory()).rmse_m * 100:.2f} cm")
