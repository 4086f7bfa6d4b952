# SPDX-License-Identifier: Apache-2.0
"""The package as such: what it exports, its stubs and texts."""
import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import ydd_slam

ROOT = Path(__file__).resolve().parents[2]
STUB = Path(ydd_slam.__file__).with_name("__init__.pyi")


LISTED = ("__init__", "__len__", "__getitem__", "__iter__", "__next__", "__call__", "__enter__", "__exit__")
ITERATORS = ("SimulatedFrames",)  # in the stubs an Iterator


def members(body):
    """Functions and names of a part of the stub: from each name to what stands for it, several if overloaded."""
    out = {}
    for node in body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            out.setdefault(node.name, []).append(node)
        elif isinstance(node, ast.AnnAssign):
            out[node.target.id] = [node]
    return {name: nodes for name, nodes in out.items() if not name.startswith("_") or name in LISTED}


def is_property(node):
    return isinstance(node, ast.FunctionDef) and any(getattr(d, "id", "") == "property" for d in node.decorator_list)


def arguments(function):
    """Names with defaults: those in order, those by name alone, and whether any others are taken."""
    ordered, given = function.args.args, function.args.defaults
    defaults = [None] * (len(ordered) - len(given)) + [ast.literal_eval(d) for d in given]
    named = [(a.arg, ast.literal_eval(d)) for a, d in zip(function.args.kwonlyargs, function.args.kw_defaults)]
    pairs = [(a.arg, d, i >= len(ordered) - len(given)) for i, (a, d) in enumerate(zip(ordered, defaults))]
    return [p for p in pairs if p[0] != "self"], named, function.args.kwarg is not None


def declared(thing, name):
    """What the text of a bound function declares, as functions without bodies."""
    lines = re.findall(rf"^(?:\d+\. )?({re.escape(name)}\(.*\) -> .*)$", thing.__doc__, re.MULTILINE)
    return [ast.parse(f"def {line}: ...").body[0] for line in lines if "*args" not in line]


def check_function(stubbed, thing, name):
    there = declared(thing, name.rpartition(".")[2])
    assert len(there) == len(stubbed), name
    for mine, bound in zip(stubbed, there):
        if name.rpartition(".")[2].startswith("__") and not name.endswith("__init__"):
            assert len(mine.args.args) == len(bound.args.args), name  # Python calls these by position
        else:
            assert arguments(mine) == arguments(bound), name
        returned = ast.unparse(bound.returns)
        if returned.startswith("ydd_slam.") and not returned.endswith(ITERATORS):
            assert ast.unparse(mine.returns) == returned.removeprefix("ydd_slam."), name


def test_stubs_have_every_name_and_signature():
    stub = members(ast.parse(STUB.read_text()).body)
    assert set(stub) == set(ydd_slam.__all__)
    for name, nodes in stub.items():
        thing = getattr(ydd_slam, name)
        if isinstance(nodes[0], ast.FunctionDef):
            check_function(nodes, thing, name)
        elif isinstance(nodes[0], ast.ClassDef) and name != "Error":
            check_class(members(nodes[0].body), thing, name)


def check_class(stubbed, cls, name):
    there = {n for n in vars(cls) if not n.startswith("_") or n in LISTED}
    made_by_others = "__init__" not in stubbed
    assert set(stubbed) == there - ({"__init__"} if made_by_others else set()), name
    if made_by_others:
        with pytest.raises(TypeError):
            cls()
    for member, nodes in stubbed.items():
        bound = vars(cls)[member]
        if isinstance(bound, property):
            assert is_property(nodes[0]) == (bound.fset is None), f"{name}.{member}"
        else:
            check_function(nodes, getattr(cls, member), f"{name}.{member}")


def test_everything_public_has_a_text():
    for name in ydd_slam.__all__:
        thing = getattr(ydd_slam, name)
        if name == "RULES":
            assert "RULES" in ydd_slam.__doc__
            continue
        assert thing.__doc__, name
        if not isinstance(thing, type) or name == "Error":
            continue
        assert thing.__module__ == "ydd_slam"
        assert "_core" not in repr(thing)
        for member, bound in vars(thing).items():
            if member.startswith("_"):
                continue
            signature = re.compile(r"^(\d+\. )?\w+\(.*\)( -> .*)?$|^Overloaded function\.$", re.MULTILINE)
            text = signature.sub("", (bound if isinstance(bound, property) else getattr(thing, member)).__doc__ or "")
            assert len(text.strip()) > 3, f"{name}.{member} has no text"


def test_importing_loads_numpy_and_nothing_else():
    code = "import sys, numpy; before = set(sys.modules); import ydd_slam; print(sorted(set(sys.modules) - before))"
    told = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert {name.split(".")[0] for name in ast.literal_eval(told)} - {"atexit"} == {"ydd_slam"}


def test_the_example_of_the_package_runs():
    text = ydd_slam.__doc__.split("    import ydd_slam", 1)[1].split("\n\nSlam  ", 1)[0]
    code = "import ydd_slam" + text.replace("\n    ", "\n").replace(
        '"samples/office_crowd"', repr(str(ROOT / "samples" / "office_crowd")) + ", max_frames=4"
    )
    told = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert told.count("tracking") == 4 and float(told.split()[-1]) < 0.05


def test_notebooks_are_as_their_scripts_are():
    subprocess.run([sys.executable, ROOT / "tools" / "make-notebooks", "--check"], check=True)
    notebooks = sorted((ROOT / "python" / "examples").glob("*.ipynb"))
    assert len(notebooks) == 3
    for file in notebooks:
        cells = json.loads(file.read_text())["cells"]
        assert cells[0]["cell_type"] == "markdown" and cells[0]["source"][0].startswith("# ")
        code = "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "code")
        compile(code, file.name, "exec")
        assert "sys.argv" not in code and "__file__" not in code
