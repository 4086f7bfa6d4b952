# SPDX-License-Identifier: Apache-2.0
"""The wheel of the tree: installed by pip into a virtual environment, it runs on its own."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

import ydd_slam

ROOT = Path(__file__).resolve().parents[2]


def test_the_wheel_is_installed_and_finds_its_network(tmp_path):
    pytest.importorskip("ensurepip")
    build = Path(ydd_slam.__file__).resolve().parents[2]
    wheel = subprocess.run(
        [sys.executable, ROOT / "tools" / "make-wheel", build], check=True, capture_output=True, text=True
    ).stdout.strip()
    environment = tmp_path / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", environment], check=True)
    python = environment / "bin" / "python"
    subprocess.run([python, "-m", "pip", "install", "-q", "--no-index", "--no-deps", wheel], check=True)
    clean = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "YDD_DETECTOR")}
    code = (
        "import ydd_slam, ydd_slam._files as f; s = ydd_slam.open_sequence(%r, max_frames=3);"
        "slam = ydd_slam.Slam(s.camera); print(f.default_detector(), [slam.process(p).state for p in s])"
        % str(ROOT / "samples" / "office_crowd")
    )
    told = subprocess.run([python, "-c", code], check=True, capture_output=True, text=True, env=clean, cwd=tmp_path)
    assert str(environment) in told.stdout and told.stdout.count("tracking") == 3
    subprocess.run([python, "-m", "pip", "uninstall", "-q", "-y", "ydd-slam"], check=True)
    left = [p for p in environment.rglob("*ydd_slam*") if p.is_file()]
    assert left == []
