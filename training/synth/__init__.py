# SPDX-License-Identifier: Apache-2.0
"""Random office scenes with exact boxes, rendered for the training of the detector."""
