# SPDX-License-Identifier: Apache-2.0
"""Deterministic runs give the same bytes as the program."""
import subprocess
from pathlib import Path

import pytest

import ydd_slam

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "office_crowd"
FRAMES = 40


def run_program(binary, out, *arguments):
    subprocess.run(
        [binary, "run", SAMPLE, "--out", out, "--deterministic", "--max-frames", str(FRAMES), "--quiet", *arguments],
        check=True,
        capture_output=True,
    )


@pytest.mark.parametrize("variant", ["evidence", "full"])
def test_with_the_network_that_comes_along(binary, tmp_path, variant):
    run_program(binary, tmp_path, "--dynamic", variant)
    sequence = ydd_slam.open_sequence(SAMPLE, max_frames=FRAMES)
    with ydd_slam.Slam(sequence.camera, {"deterministic": True, "dynamics.variant": variant}) as slam:
        for picture in sequence:
            slam.process(picture)
    assert slam.trajectory().text() == (tmp_path / "trajectory.tum").read_text()
    assert slam.keyframe_trajectory().text() == (tmp_path / "keyframes.tum").read_text()


def test_with_recorded_boxes_and_the_configuration_of_the_run(binary, tmp_path):
    run_program(
        binary, tmp_path, "--detections", SAMPLE / "detections.jsonl", "--set", "orb.levels=6", "--dynamic", "full"
    )
    sequence = ydd_slam.open_sequence(SAMPLE, max_frames=FRAMES)
    with ydd_slam.Slam(
        sequence.camera, config=str(tmp_path / "config.yaml"), detector=str(SAMPLE / "detections.jsonl")
    ) as slam:
        for picture in sequence:
            slam.process(picture)
    assert slam.trajectory().text() == (tmp_path / "trajectory.tum").read_text()


def test_with_threads_it_tracks_as_well(tmp_path):
    sequence = ydd_slam.open_sequence(SAMPLE, max_frames=FRAMES)
    with ydd_slam.Slam(sequence.camera, autosave=str(tmp_path / "map.ydd")) as slam:
        states = [slam.process(picture).state for picture in sequence]
    assert states == ["tracking"] * FRAMES
    assert ydd_slam.ate(sequence.groundtruth, slam.trajectory()).rmse_m < 0.05
