# SPDX-License-Identifier: Apache-2.0
"""The examples run."""
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "samples" / "office_crowd"


def run_example(name, *arguments):
    return subprocess.run(
        [sys.executable, ROOT / "python" / "examples" / name, SAMPLE, *map(str, arguments)],
        check=True,
        capture_output=True,
        text=True,
    ).stdout


def test_own_detector():
    told = run_example("own_detector.py", 10)
    assert told.count("tracking") == 10 and "body_depth" in told
    assert float(re.search(r"ATE ([\d.]+) cm", told)[1]) < 5


def test_map_cloud(tmp_path):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "map.png"
    told = run_example("map_cloud.py", picture, 10)
    assert picture.read_bytes().startswith(b"\x89PNG") and int(re.search(r"(\d+) points of a cloud", told)[1]) > 1000


def test_ablation():
    told = run_example("ablation.py", 6)
    assert len(re.findall(r"ATE +[\d.]+ cm, \d+ points rejected", told)) == 6
