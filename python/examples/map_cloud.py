#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # A map as a point cloud in matplotlib
# What the map holds comes as NumPy arrays: landmarks, keyframes, which keyframes see the same, and a
# dense cloud of all that stood still.
# %% [script]
"""A map as a point cloud in matplotlib, from above, with the keyframes and what connects them.

map_cloud.py [RECORDING|MAP.ydd [FRAMES [PICTURE.png]]]
"""
import sys

import matplotlib

matplotlib.use("Agg")
# %%
from pathlib import Path

import matplotlib.pyplot as plt

import ydd_slam

place = "../../samples/office_crowd"  # a recording, or a map that `ydd-slam run --save-map` wrote
frames = 30  # of a recording; 0: all of it
# %% [script]
place, picture_file = Path(__file__).resolve().parent / place, "map.png"
if len(sys.argv) > 1:
    place, frames = sys.argv[1], 0
if len(sys.argv) > 2:
    frames = int(sys.argv[2])
if len(sys.argv) > 3:
    picture_file = sys.argv[3]
# %%
if Path(place).suffix == ".ydd":
    the_map = ydd_slam.Map.load(place)
else:
    sequence = ydd_slam.open_sequence(place, max_frames=frames)
    with ydd_slam.Slam(sequence.camera) as slam:
        for picture in sequence:
            slam.process(picture)
    the_map = slam.map  # as it is now; it can be given to another: Slam(camera, map=the_map)
print(the_map)
# %% [markdown]
# The world's frame is that of the first camera: x right, y down, z forward, in metres. From above one
# sees x and z. Colours are blue green red, as OpenCV has them.
# %%
points, colours = the_map.dense_cloud(voxel_m=0.03)
cameras = the_map.keyframe_poses[:, :3, 3]
plt.figure(figsize=(8, 8))
plt.scatter(points[:, 0], points[:, 2], s=1, c=colours[:, ::-1] / 255)
for a, b, shared in the_map.covisibility:
    plt.plot(*cameras[[a, b]][:, [0, 2]].T, color="green", alpha=min(1, shared / 200), linewidth=0.5)
plt.plot(cameras[:, 0], cameras[:, 2], "b.-", linewidth=1, label="keyframes")
plt.axis("equal")
plt.xlabel("x [m]")
plt.ylabel("z [m]")
plt.legend()
# %% [script]
plt.savefig(picture_file, dpi=100)
print(f"{len(points)} points of a cloud in {picture_file}")
