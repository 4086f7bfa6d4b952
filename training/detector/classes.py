# SPDX-License-Identifier: Apache-2.0
"""The classes of the detector, in the order of its outputs."""

CLASSES = (
    "person", "head", "hand", "chair", "monitor", "keyboard", "mouse",
    "cup", "bottle", "book", "laptop", "phone", "bag", "fan",
)  # fmt: skip


def by_class(options: list[str]) -> dict[str, float]:
    """CLASS=NUMBER of a command line."""
    return {name: float(number) for name, number in (o.split("=") for o in options)}
