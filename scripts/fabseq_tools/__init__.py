# SPDX-License-Identifier: MIT
"""The tools around fabseq: pictures, tables, geometry and torch paths of runs, and what simulates in rounds.

A module with a COMMAND and a function main(words) is a command of `fabseq-tools`; entry.py finds it. A module
imports from its own package and from those before it in this order, never from one after it or beside it:

    run < geometry < plot < paths, calculix, calibration, orientation, start, study < report < plan

run: output directories, configs, command lines. geometry: grids, surfaces, bodies, layers. plot: pictures.
paths: torch paths. calculix: decks for another solver. calibration: measured parts. orientation: which way
up. start: first configs. study: one part within several limits, layers mended. report: pages for a browser.
plan: from a drawing and a machine to what is welded.
"""

import logging
import os

os.environ.setdefault("MPLBACKEND", "Agg")  # pictures go to files
logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)  # the first run would announce its font cache
