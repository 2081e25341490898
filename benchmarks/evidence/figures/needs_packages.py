# SPDX-License-Identifier: MIT
"""Finds a Python with the packages that the scripts of this folder need; they import this one first. Modules
of the tools come from fabseq_tools, a link beside this file."""

from fabseq_tools import find_python

find_python.require()
