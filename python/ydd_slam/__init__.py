# SPDX-License-Identifier: Apache-2.0
"""Visual RGB-D SLAM that keeps its bearings among moving people.

    import ydd_slam

    sequence = ydd_slam.open_sequence("samples/office_crowd")
    with ydd_slam.Slam(sequence.camera) as slam:
        for picture in sequence:
            frame = slam.process(picture)
            print(frame.state, len(frame.kept), len(frame.rejected), frame.tracks)
    print(ydd_slam.ate(sequence.groundtruth, slam.trajectory()).rmse_m)

Slam                 the system; gives a Frame for each picture, a Trajectory, a Map
Camera, RgbdFrame    what goes in: metres, camera frame x right, y down, z forward
Detection, Detector, RecordedDetections   boxes and masks
Map                  landmarks, keyframes and clouds as arrays
open_sequence        recordings of many kinds
simulate             a simulated world with exact truth, frame by frame
ate, rpe             errors of a Trajectory
Error                what every failure is: one line that tells what to do
RULES                names of the rules that reject a point; RejectedPoints.rule has their numbers

T_a_b maps coordinates of frame b to those of frame a. Arrays that are said to be shared are views
that nobody may write, and keep what they show alive. Nothing prints; warnings go to standard error.
"""
from ._core import (
    RULES,
    Ate,
    Camera,
    Detection,
    Detector,
    Error,
    ErrorStatistics,
    Frame,
    Frames,
    KeptPoints,
    Map,
    RecordedDetections,
    RejectedPoints,
    RgbdFrame,
    Rpe,
    SeenObject,
    Sequence,
    Slam,
    Track,
    Trajectory,
    __version__,
    ate,
    open_sequence,
    rpe,
    set_log_level,
    simulate,
)

__all__ = [
    "RULES",
    "Ate",
    "Camera",
    "Detection",
    "Detector",
    "Error",
    "ErrorStatistics",
    "Frame",
    "Frames",
    "KeptPoints",
    "Map",
    "RecordedDetections",
    "RejectedPoints",
    "RgbdFrame",
    "Rpe",
    "SeenObject",
    "Sequence",
    "Slam",
    "Track",
    "Trajectory",
    "ate",
    "open_sequence",
    "rpe",
    "set_log_level",
    "simulate",
]

# Without the simulator (Embree) these two are not there, and simulate() says so.
try:
    from ._core import SimulatedFrame, Simulation
except ImportError:
    pass
else:
    __all__ += ["SimulatedFrame", "Simulation"]
