# SPDX-License-Identifier: Apache-2.0
"""Files that come with the program, from where this module was built or installed."""
import os
from pathlib import Path

from ._core import Error

_DETECTOR = Path("configs", "detector", "ydd.yaml")


def default_detector() -> str:
    """What a Slam without a detector means: YDD_DETECTOR, else the network that comes along."""
    named = os.environ.get("YDD_DETECTOR")
    if named:
        return named
    here = Path(__file__).resolve().parent  # in a wheel, below PREFIX/lib/.../dist-packages, in CLONE/build/python
    places = [folder / "share" / "ydd-slam" for folder in (here, *here.parents)]
    places += here.parents
    for place in places:
        if (place / _DETECTOR).is_file():
            return str(place / _DETECTOR)
    raise Error(
        f"there is no detector file {_DETECTOR} beside {here}: give one as detector, name it in the environment "
        "variable YDD_DETECTOR, or give None"
    )
