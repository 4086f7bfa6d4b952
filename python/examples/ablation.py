#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # What each part of the method is worth
# An ablation in ten lines: the error with one switch off at a time. Any option of `ydd-slam options`
# can be a switch.
# %% [script]
"""What each part of the method is worth, in ten lines: the error with one switch off at a time.

ablation.py [RECORDING [FRAMES]]
"""
import sys
from pathlib import Path

# %%
import ydd_slam

recording = "../../samples/office_crowd"  # with a ground truth
frames = 30  # 0: all of it
# %% [script]
recording = Path(__file__).resolve().parent / recording
if len(sys.argv) > 1:
    recording, frames = sys.argv[1], 0
if len(sys.argv) > 2:
    frames = int(sys.argv[2])
# %% [markdown]
# With `deterministic` two runs give the same trajectory, byte for byte, and the same as the program: what
# differs below is due to the switch alone.
# %%
sequence = ydd_slam.open_sequence(recording, max_frames=frames)
for switch in ["none", "connected", "bridging", "hidden_bodies", "surrounded", "enabled"]:
    options = {"deterministic": True, "dynamics": {"variant": "full"}}
    if switch != "none":
        options["dynamics"]["refinement"] = {switch: False}
    with ydd_slam.Slam(sequence.camera, options) as slam:
        rejected = sum(len(slam.process(picture).rejected) for picture in sequence)
    error_m = ydd_slam.ate(sequence.groundtruth, slam.trajectory()).rmse_m
    print(f"without {switch:14} ATE {error_m * 100:6.2f} cm, {rejected} points rejected")
