# SPDX-License-Identifier: Apache-2.0
"""The file of measured figures (bench/results/results.json), for the scripts beside this one.

    {"format": "ydd-slam results 1",
     "groups": {GROUP: {"command", "commit", "date", "machine", "note",
                        "figures": {"SEQUENCE/VARIANT/QUANTITY": FIGURE}}}}

A FIGURE is {"unit", "better": "lower" | "higher", "median", "min", "max", "runs"}: the median of the
runs and their spread. `runs` may be missing where only the other three were kept. All three null: the
runs gave no figure (a camera that was lost, say). Each group says where it comes from, because groups
are measured on different days.
"""
import json
import os
import pathlib
import platform
import statistics
import subprocess
import tempfile

FORMAT = "ydd-slam results 1"
ROOT = pathlib.Path(__file__).resolve().parent.parent
DEFAULT_FILE = ROOT / "bench/results/results.json"

# Of a quantity's last word: unit, what is better, and the difference that nobody cares for.
UNITS = {
    "m": ("m", "lower", 1e-4),
    "deg": ("deg", "lower", 1e-3),
    "ms": ("ms", "lower", 0.02),
    "mb": ("MB", "lower", 1.0),
    "share": ("share", "higher", 0.005),
    "recall": ("share", "higher", 0.005),
    "precision": ("share", "higher", 0.005),
    "persons": ("share", "higher", 0.005),  # kept_in_persons
    "found": ("share", "higher", 0.005),
    "loops": ("count", "higher", 0.5),
    "false": ("count", "lower", 0.5),
    "places": ("count", "lower", 0.5),  # false_places
    "frames": ("frames", "lower", 0.5),
    "dropped": ("frames", "lower", 0.5),
    "speed": ("m/s", "lower", 0.01),  # an error of it
    "second": ("1/s", "higher", 0.5),  # frames_per_second
}
TIMES = ("ms", "1/s")  # figures that tell of the machine as well


class Unusable(Exception):
    """One line that names the file and what is wrong with it."""


def unit_of(name):
    """(unit, better, floor) of a figure by its name."""
    word = name.rsplit("/", 1)[-1].rsplit("_", 1)[-1]
    if word not in UNITS:
        raise Unusable(f"{name}: no unit is known for '{word}' (tools/ydd_results.py, UNITS)")
    return UNITS[word]


def figure(name, runs):
    """The figure of a series of runs, which may be empty."""
    unit, better, _ = unit_of(name)
    runs = [r for r in runs if r is not None]
    median = statistics.median(runs) if runs else None
    return {
        "unit": unit,
        "better": better,
        "median": median,
        "min": min(runs, default=None),
        "max": max(runs, default=None),
        "runs": runs,
    }


def check_figure(where, value):
    if not isinstance(value, dict) or value.get("better") not in ("lower", "higher"):
        raise Unusable(f"{where}: must be a figure with unit, better, median, min and max")
    three = [value.get(k, "missing") for k in ("median", "min", "max")]
    if all(v is None for v in three):
        return
    if not all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in three):
        raise Unusable(f"{where}: median, min and max must be numbers, or all three null")
    if not three[1] <= three[0] <= three[2]:
        raise Unusable(f"{where}: the median {three[0]} is not between min {three[1]} and max {three[2]}")


def load(path):
    """The document of a file, checked. Raises Unusable."""
    try:
        document = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    except OSError as e:
        raise Unusable(f"{path}: {e.strerror}") from e
    except ValueError as e:
        raise Unusable(f"{path}: no JSON: {e}") from e
    groups = document.get("groups") if isinstance(document, dict) else None
    if not isinstance(groups, dict):
        raise Unusable(f"{path}: no file of results (it has no 'groups'; tools/measure-results makes one)")
    for group, content in groups.items():
        if not isinstance(content, dict) or not isinstance(content.get("figures"), dict):
            raise Unusable(f"{path}: group '{group}' has no 'figures'")
        for name, value in content["figures"].items():
            check_figure(f"{path}: {group}/{name}", value)
    return document


def save(document, path):
    """One figure a line, whole or not at all."""
    parts = []
    for group, content in document["groups"].items():
        lines = [f'  "{k}": {json.dumps(v)}' for k, v in content.items() if k != "figures"]
        figures = ",\n".join(f"   {json.dumps(n)}: {json.dumps(f)}" for n, f in content["figures"].items())
        lines.append('  "figures": {\n' + figures + "\n  }")
        parts.append(f" {json.dumps(group)}: {{\n" + ",\n".join(lines) + "\n }")
    text = f'{{"format": {json.dumps(FORMAT)},\n"groups": {{\n' + ",\n".join(parts) + "\n}}\n"
    path = pathlib.Path(path)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as f:
            f.write(text)
            f.flush()
            os.fsync(f.fileno())
        os.chmod(name, path.stat().st_mode if path.exists() else 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def machine():
    """What figures of time depend on."""

    def first(file, key):
        try:
            for line in pathlib.Path(file).read_text().splitlines():
                if line.startswith(key):
                    return line.split(":", 1)[1].strip()
        except OSError:
            pass
        return "unknown"

    return {
        "processor": first("/proc/cpuinfo", "model name"),
        "cores": os.cpu_count(),
        "memory": first("/proc/meminfo", "MemTotal"),
        "system": f"{platform.system()} {platform.release()}",
    }


def commit():
    """The commit that is measured; '+' behind it when files differ from it."""

    def git(*arguments):
        try:
            done = subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True)
        except FileNotFoundError:  # no git here
            return None
        return done.stdout.strip() if done.returncode == 0 else None

    head = git("rev-parse", "--short=10", "HEAD")
    if head is None:
        return "unknown"
    return head + ("+" if git("status", "--porcelain", "--untracked-files=no") else "")
