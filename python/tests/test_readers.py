# SPDX-License-Identifier: Apache-2.0
"""Recordings, trajectories and their errors, and the simulator."""
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import ydd_slam
from ydd_slam import Error, Trajectory

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "office_crowd"


def test_a_sequence_is_read_in_order_and_at_random(sample):
    assert len(sample) == 12 and sample.name == "office_crowd"
    frames = list(sample)
    assert [f.index for f in frames] == list(range(12))
    assert [f.stamp_ns for f in frames] == list(sample.stamps_ns)
    assert (sample[-1].colour == frames[-1].colour).all() and (sample[3].depth_m == frames[3].depth_m).all()
    assert frames[0].colour.shape == (480, 640, 3) and frames[0].grey.shape == (480, 640)
    assert frames[0].depth_m.dtype == np.float32 and not frames[0].depth_m.flags.writeable
    assert len(sample.groundtruth) >= 12
    with pytest.raises(IndexError):
        sample[12]


def test_a_broken_picture_is_skipped_or_raised(tmp_path, capfd):
    folder = tmp_path / "broken"
    shutil.copytree(SAMPLE, folder, ignore=shutil.ignore_patterns("mask"))
    names = sorted((folder / "rgb").iterdir())
    names[1].write_bytes(b"no picture")
    sequence = ydd_slam.open_sequence(folder, max_frames=3)
    assert [f.index for f in sequence] == [0, 2]
    assert "skipped" in capfd.readouterr().err
    frames = sequence.frames(strict=True)
    assert next(frames).index == 0
    with pytest.raises(Error, match=names[1].name):
        next(frames)
    assert next(frames).index == 2
    with pytest.raises(StopIteration):
        next(frames)
    with pytest.raises(Error, match=names[1].name):
        sequence[1]


def test_what_cannot_be_opened_is_one_line(tmp_path):
    for call in (
        lambda: ydd_slam.open_sequence(tmp_path / "missing"),
        lambda: ydd_slam.open_sequence(SAMPLE, camera="no_such_camera"),
        lambda: ydd_slam.open_sequence(SAMPLE, first=3),
        lambda: Trajectory.load("missing.txt"),
        lambda: ydd_slam.RecordedDetections("missing.jsonl"),
        lambda: ydd_slam.Detector("missing.yaml"),
    ):
        with pytest.raises(Error) as raised:
            call()
        assert str(raised.value) and "\n" not in str(raised.value)


def test_what_fails_carries_the_line_of_the_program(binary, sample, tmp_path):
    broken = {"camera.yaml": "Camera.fx: 500\n", "options.yaml": "orb:\n  levels: 99\n", "boxes.jsonl": '{"broken'}
    broken |= {"office.ydd": "no map\n", "two.txt": "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"}
    for name, text in broken.items():
        (tmp_path / name).write_text(text)
    at = {name: str(tmp_path / name) for name in broken}
    quiet = ("--detector", "none", "--out", tmp_path / "out")
    slam = lambda **how: ydd_slam.Slam(sample.camera, **({"detector": None} | how))
    for call, command in (
        (lambda: ydd_slam.open_sequence("missing"), ("run", "missing")),
        (lambda: ydd_slam.open_sequence(SAMPLE, "no_camera"), ("run", SAMPLE, "--camera", "no_camera", *quiet)),
        (
            lambda: ydd_slam.open_sequence(SAMPLE, at["camera.yaml"]),
            ("run", SAMPLE, "--camera", at["camera.yaml"], *quiet),
        ),
        (lambda: slam(config=at["options.yaml"]), ("run", SAMPLE, "--config", at["options.yaml"], *quiet)),
        (lambda: slam(detector=at["boxes.jsonl"]), ("run", SAMPLE, "--detections", at["boxes.jsonl"], *quiet[2:])),
        (lambda: slam(map=at["office.ydd"]), ("run", SAMPLE, "--map", at["office.ydd"], *quiet)),
        (lambda: ydd_slam.ate(at["two.txt"], at["two.txt"]), ("eval", at["two.txt"], at["two.txt"])),
    ):
        with pytest.raises(Error) as raised:
            call()
        told = subprocess.run([binary, *command], capture_output=True, text=True).stderr
        assert told.splitlines()[-1] == f"error: {raised.value}"


def test_errors_are_those_of_the_program(binary, sample, run, tmp_path):
    truth, found = sample.groundtruth, run[0].trajectory()
    file = tmp_path / "trajectory.txt"
    found.save(str(file))
    ate = ydd_slam.ate(truth, found)
    assert 0 < ate.rmse_m < 0.05 and len(ate.errors_m) == len(ate.pairs) == ate.statistics_m.count == 12
    assert ate.rmse_m == pytest.approx(np.sqrt((np.square(ate.errors_m)).mean()))
    rpe = ydd_slam.rpe(truth, found, delta=3, unit="frames")
    told = subprocess.run(
        [binary, "eval", SAMPLE / "groundtruth.txt", file, "--rpe-delta", "3", "--rpe-unit", "frames"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    assert f"{ate.rmse_m:.6f}" in told and f"{rpe.translation_m.rmse:.6f}" in told
    assert ydd_slam.ate(str(SAMPLE / "groundtruth.txt"), str(file)).rmse_m == pytest.approx(ate.rmse_m, abs=1e-8)
    # The alignment brings the estimate onto the truth.
    T = ate.T_groundtruth_estimate
    moved = found.positions @ T[:3, :3].T + T[:3, 3]
    errors = np.linalg.norm(moved[ate.pairs[:, 1]] - truth.positions[ate.pairs[:, 0]], axis=1)
    assert errors == pytest.approx(ate.errors_m)
    with pytest.raises(Error, match="at least 3 are needed"):
        ydd_slam.ate(truth, Trajectory(np.array([1, 2]), np.stack([np.eye(4)] * 2)))


def test_a_trajectory_of_arrays(tmp_path):
    poses = np.stack([np.eye(4)] * 3)
    poses[:, 0, 3] = [0, 1, 2]
    trajectory = Trajectory(np.array([10, 20, 30]), poses)
    assert (trajectory.poses == poses).all() and (trajectory.positions[:, 0] == [0, 1, 2]).all()
    assert list(trajectory.stamps_ns) == [10, 20, 30]
    for name, lines in (("tum", 3), ("kitti", 3), ("euroc", 4)):
        assert trajectory.text(name).count("\n") in (lines, 3), name
    with pytest.raises(Error, match="format"):
        trajectory.text("nmea")
    with pytest.raises(Error, match="not later"):
        Trajectory(np.array([10, 10, 30]), poses)
    with pytest.raises(Error, match="rigid"):
        Trajectory(np.array([10, 20, 30]), 2 * poses)
    with pytest.raises(Error, match="give"):
        Trajectory(np.array([10, 20]), poses)


def test_the_simulator_is_a_sequence_with_truth():
    options = {"frames": 4, "width": 160, "height": 120, "people": 2, "seed": 3}
    world = ydd_slam.simulate(options)
    frames = list(world)
    assert len(world) == len(frames) == 4
    assert (frames[2].frame.colour == world[2].frame.colour).all()
    assert frames[0].frame.colour.shape == (120, 160, 3) and frames[0].mask.shape == (120, 160)
    assert (world.groundtruth.poses[3] == frames[3].T_world_camera).all()
    assert all(isinstance(d, ydd_slam.Detection) for d in frames[0].detections) and frames[0].detections
    with pytest.raises(Error, match="people"):
        ydd_slam.simulate({"peopel": 2})


def test_cameras(tmp_path):
    assert "tum_fr3" in ydd_slam.Camera.presets()
    camera = ydd_slam.Camera.load("tum_fr3")
    assert camera.K[0, 0] == camera.fx_px and (camera.width_px, camera.height_px) == (640, 480)
    assert ydd_slam.Camera.load(str(SAMPLE / "camera.yaml")).fx_px > 0
    with pytest.raises(Error):
        ydd_slam.Camera.load("no_such_camera")
