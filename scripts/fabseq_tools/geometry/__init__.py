# SPDX-License-Identifier: MIT
"""Grids, shapes, surfaces and bodies of parts, and what is made of them; draws nothing."""
