# SPDX-License-Identifier: MIT
"""A part in several orientations."""
