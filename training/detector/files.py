# SPDX-License-Identifier: Apache-2.0
"""Files that are there as a whole or not at all: a stage that is stopped goes on with what is missing."""
from __future__ import annotations

import os
import pathlib


def write_whole(path: pathlib.Path, text: str) -> None:
    tmp = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    tmp.write_text(text)
    tmp.rename(path)
