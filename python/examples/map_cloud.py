#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A map as a point cloud in matplotlib, from above, with the keyframes and what connects them.

    map_cloud.py MAP|SEQUENCE PICTURE.png [FRAMES]
"""
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import ydd_slam


def map_of(place: str, frames: int) -> ydd_slam.Map:
    if Path(place).is_file():
        return ydd_slam.Map.load(place)
    sequence = ydd_slam.open_sequence(place, max_frames=frames)
    with ydd_slam.Slam(sequence.camera) as slam:
        for picture in sequence:
            slam.process(picture)
    return slam.map


def main() -> None:
    the_map = map_of(sys.argv[1], int(sys.argv[3]) if len(sys.argv) > 3 else 0)
    points, colours = the_map.dense_cloud(voxel_m=0.03)
    cameras = the_map.keyframe_poses[:, :3, 3]
    plt.figure(figsize=(8, 8))
    # World: x right, y down, z forward. From above that is x and z.
    plt.scatter(points[:, 0], points[:, 2], s=1, c=colours[:, ::-1] / 255)
    for a, b, shared in the_map.covisibility:
        plt.plot(*cameras[[a, b]][:, [0, 2]].T, color="green", alpha=min(1, shared / 200), linewidth=0.5)
    plt.plot(cameras[:, 0], cameras[:, 2], "b.-", linewidth=1, label="keyframes")
    plt.axis("equal")
    plt.xlabel("x [m]")
    plt.ylabel("z [m]")
    plt.legend()
    plt.savefig(sys.argv[2], dpi=100)
    print(f"{the_map}: {len(points)} points of a cloud in {sys.argv[2]}")


if __name__ == "__main__":
    main()
