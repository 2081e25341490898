# SPDX-License-Identifier: MIT
"""Torch paths of the layers of a part, written and read."""
