# SPDX-License-Identifier: Apache-2.0
"""A YOLOv5-style detector: model, data, training, export, evaluation."""
