# SPDX-License-Identifier: Apache-2.0
"""The examples run, as scripts and as notebooks."""
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "python" / "examples"
SAMPLE = ROOT / "samples" / "office_crowd"


def run_example(name, *arguments):
    return subprocess.run(
        [sys.executable, EXAMPLES / name, SAMPLE, *map(str, arguments)], check=True, capture_output=True, text=True
    ).stdout


def test_own_detector():
    told = run_example("own_detector.py", 10)
    assert told.count("tracking") == 10 and "body_depth" in told
    assert float(re.search(r"ATE ([\d.]+) cm", told)[1]) < 5


def test_map_cloud(tmp_path):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "map.png"
    told = run_example("map_cloud.py", 10, picture)
    assert picture.read_bytes().startswith(b"\x89PNG") and int(re.search(r"(\d+) points of a cloud", told)[1]) > 1000


def test_ablation():
    told = run_example("ablation.py", 6)
    assert len(re.findall(r"ATE +[\d.]+ cm, \d+ points rejected", told)) == 6


@pytest.mark.parametrize(
    "name, told", [("own_detector", "ATE "), ("map_cloud", "image/png"), ("ablation", "surrounded")]
)
def test_notebooks_are_executed_where_there_is_jupyter(tmp_path, name, told):
    """As Jupyter does it. Without it their code has been run above: it is that of the scripts."""
    for module in ("nbconvert", "ipykernel", "matplotlib"):
        pytest.importorskip(module)
    text = (EXAMPLES / f"{name}.ipynb").read_text()
    short = text.replace("../../samples/office_crowd", str(SAMPLE)).replace("frames = 30", "frames = 4")
    assert str(SAMPLE) in short and "frames = 4" in short
    notebook = tmp_path / f"{name}.ipynb"
    notebook.write_text(short)
    command = [sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--inplace", notebook]
    subprocess.run(command, check=True, capture_output=True)
    outputs = [output for cell in json.loads(notebook.read_text())["cells"] for output in cell.get("outputs", [])]
    assert told in json.dumps(outputs)
