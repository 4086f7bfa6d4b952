# SPDX-License-Identifier: Apache-2.0
"""The package as such: what it exports, its stubs and texts."""
import ast
import subprocess
import sys
from pathlib import Path

import ydd_slam

STUB = Path(ydd_slam.__file__).with_name("__init__.pyi")


def members_of_stub():
    """Names of the stub: those of the module, and those of each class."""
    module, classes = set(), {}
    for node in ast.parse(STUB.read_text()).body:
        if isinstance(node, ast.ClassDef):
            classes[node.name] = {
                n.name if isinstance(n, ast.FunctionDef) else n.target.id
                for n in node.body
                if isinstance(n, (ast.FunctionDef, ast.AnnAssign))
            }
            module.add(node.name)
        elif isinstance(node, ast.FunctionDef):
            module.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            module.add(node.target.id)
    return module, classes


def is_listed(name):
    return not name.startswith("_") or name in (
        "__init__",
        "__len__",
        "__getitem__",
        "__iter__",
        "__next__",
        "__call__",
    )


def test_stubs_name_exactly_what_there_is():
    module, classes = members_of_stub()
    assert {n for n in module if not n.startswith("_")} == set(ydd_slam.__all__)
    for name, stubbed in classes.items():
        if name.startswith("_"):
            continue
        there = {n for n, v in vars(getattr(ydd_slam, name)).items() if is_listed(n) and v is not None}
        assert {n for n in stubbed if is_listed(n)} == there - {"__init__"} | (stubbed & {"__init__"}), name


def test_everything_public_has_a_text():
    for name in ydd_slam.__all__:
        thing = getattr(ydd_slam, name)
        if name == "RULES":
            continue
        assert thing.__doc__, name
        if isinstance(thing, type):
            assert thing.__module__ == "ydd_slam"
            assert "_core" not in repr(thing)


def test_importing_loads_numpy_and_nothing_else():
    code = "import sys, numpy; before = set(sys.modules); import ydd_slam; print(sorted(set(sys.modules) - before))"
    told = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert {name.split(".")[0] for name in ast.literal_eval(told)} - {"atexit"} == {"ydd_slam"}


def test_the_example_of_the_package_runs():
    text = ydd_slam.__doc__.split("    import ydd_slam", 1)[1].split("\n\nSlam  ", 1)[0]
    code = "import ydd_slam" + text.replace("\n    ", "\n").replace(
        '"samples/office_crowd"',
        repr(str(Path(__file__).resolve().parents[2] / "samples" / "office_crowd")) + ", max_frames=4",
    )
    told = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert told.count("tracking") == 4 and float(told.split()[-1]) < 0.05
