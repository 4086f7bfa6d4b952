#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A detector of one's own: any function from a picture to boxes, here what is near.

    own_detector.py SEQUENCE [FRAMES]

Put your network where `look` is: it gets an RgbdFrame and gives (class, box, score) or Detection with
a mask. It works on a thread of its own while features are extracted.
"""
import sys

import numpy as np

import ydd_slam


def look(frame):
    """What is nearer than 1.6 m is a person: not a good detector, but one of ten lines."""
    near = (frame.depth_m > 0) & (frame.depth_m < 1.6)
    rows, columns = np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))
    if near.mean() < 0.02:
        return []
    box = (columns[0], rows[0], columns[-1] + 1, rows[-1] + 1)
    return [ydd_slam.Detection("person", box, 0.8, mask=near)]


def main() -> None:
    sequence = ydd_slam.open_sequence(sys.argv[1], max_frames=int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    with ydd_slam.Slam(sequence.camera, detector=look) as slam:
        for picture in sequence:
            frame = slam.process(picture)
            gone = np.bincount(frame.rejected.rule, minlength=len(ydd_slam.RULES))
            rules = ", ".join(f"{n} {ydd_slam.RULES[i]}" for i, n in enumerate(gone) if n)
            print(f"{frame.index:4d} {frame.state}: {len(frame.kept)} points kept; rejected: {rules or 'none'}")
    if sequence.groundtruth:
        print(f"ATE {ydd_slam.ate(sequence.groundtruth, slam.trajectory()).rmse_m * 100:.2f} cm")


if __name__ == "__main__":
    main()
