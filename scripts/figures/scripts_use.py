# SPDX-License-Identifier: MIT
"""Lets the scripts of this folder import the modules of scripts/use; they import this one first."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "use"))
