# SPDX-License-Identifier: Apache-2.0
import os
from pathlib import Path

import pytest

import ydd_slam

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "samples" / "office_crowd"


@pytest.fixture(scope="session")
def binary() -> str:
    return os.environ["YDD_BINARY"]


@pytest.fixture(scope="session")
def sample() -> ydd_slam.Sequence:
    return ydd_slam.open_sequence(SAMPLE, max_frames=12)


@pytest.fixture(scope="session")
def boxes() -> ydd_slam.RecordedDetections:
    return ydd_slam.RecordedDetections(str(SAMPLE / "detections.jsonl"))


@pytest.fixture(scope="session")
def run(sample, boxes):
    """A short run over the sample: the system, and what became of each picture."""
    slam = ydd_slam.Slam(sample.camera, {"deterministic": True, "dynamics": {"variant": "full"}}, detector=boxes)
    frames = [slam.process(picture) for picture in sample]
    slam.finish()
    return slam, frames
