# SPDX-License-Identifier: Apache-2.0
"""Files that are there as a whole or not at all: a stage that is stopped goes on with what is missing."""
from __future__ import annotations

import contextlib
import os
import pathlib
from collections.abc import Iterator


@contextlib.contextmanager
def whole(path: pathlib.Path) -> Iterator[pathlib.Path]:
    """Where to write what becomes `path` when all of it is written."""
    tmp = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    yield tmp
    tmp.rename(path)


def write_whole(path: pathlib.Path, text: str) -> None:
    with whole(path) as tmp:
        tmp.write_text(text)
