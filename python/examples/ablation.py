#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What each part of the method is worth, in ten lines: the error with one switch off at a time.

    ablation.py SEQUENCE [FRAMES]
"""
import sys

import ydd_slam

SWITCHES = ["none", "connected", "bridging", "hidden_bodies", "surrounded", "enabled"]


def main() -> None:
    sequence = ydd_slam.open_sequence(sys.argv[1], max_frames=int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    for switch in SWITCHES:
        options = {"deterministic": True, "dynamics": {"variant": "full"}}
        if switch != "none":
            options["dynamics"]["refinement"] = {switch: False}
        with ydd_slam.Slam(sequence.camera, options) as slam:
            rejected = sum(len(slam.process(picture).rejected) for picture in sequence)
        error_m = ydd_slam.ate(sequence.groundtruth, slam.trajectory()).rmse_m
        print(f"without {switch:14} ATE {error_m * 100:6.2f} cm, {rejected} points rejected")


if __name__ == "__main__":
    main()
