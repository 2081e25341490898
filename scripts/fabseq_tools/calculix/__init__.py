# SPDX-License-Identifier: MIT
"""The simulation of a run as a problem for CalculiX, and its solution compared."""
