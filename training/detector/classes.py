# SPDX-License-Identifier: Apache-2.0
"""The classes of the detector, in the order of its outputs."""

CLASSES = (
    "person", "head", "hand", "chair", "monitor", "keyboard", "mouse",
    "cup", "bottle", "book", "laptop", "phone", "bag", "fan",
)  # fmt: skip
