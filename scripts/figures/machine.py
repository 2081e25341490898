#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Runs the cases of configs/studies/machine_cases.json, without and with the limits of a machine, and prints
what the torch does not reach, tilts, local thickness and what the limits cost in distortion.

    scripts/figures/machine.py [CASE...] [--ranks N] [--output output/machine] [--table] [-- PROGRAM OPTIONS]

A case that was interrupted goes on where it was, one that is done is only looked at again; --table runs
nothing. Sequences have binary layers. Blocked is what the torch itself does not reach, without a clearance
that the optimizer kept. A length is the root of the first distortion. Local thickness is given relative to
the target, between its 1st and its 99th percentile, and the range of all of it.
"""

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import run_script

import numpy as np

from built import print_cases
from fabseq_tools.run.read_run import Run
from fabseq_tools.run.words import duration

HEAD = ("case", "sequence", "blocked", "beyond 45°", "beyond 60°", "largest tilt", "thickness, 1 to 99 %", "all", "length",
        "constraints", "time")


def main():
    print_cases(__doc__, "machine", HEAD, [],
                lambda cases, name, directory: rows(Run(directory), "like" not in cases.table[name]))


def rows(result, all_sequences):
    """The cells of the optimized sequence, and before it, if asked for, those of planar and start."""
    if all_sequences:
        yield sequence(result, "baseline", "planar/", "planar")
        yield sequence(result, "start", "start/", "start")
    satisfied = "satisfied" if result.summary["feasible"] else f"{result.summary['worst_constraint']:.2g} beyond"
    yield sequence(result, "binary", "", "optimized")[:-2] + [satisfied, duration(result.summary["seconds"]["total"])]


def sequence(result, block, prefix, name):
    built = result.fields["density"].ravel() > 0

    def field(of):
        return result.fields[prefix + of].ravel()[built]

    blocked = field("blocked") > result.config["tool"]["clearance"]
    tilt, thickness = field("tilt"), field("local_thickness") / result.thickness_constraint()["target"]
    least, *percentiles, largest = np.percentile(thickness, [0, 1, 99, 100])
    return [name, share(blocked), share(tilt > 45), share(tilt > 60), f"{tilt.max():.0f}°",
            " to ".join(f"{value:.2f}" for value in percentiles), f"{least:.2f} to {largest:.3g}",
            f"{result.length(block):.3g}", "", ""]


def share(marked):
    """Of the part's elements; a single element is not 0."""
    return "0" if not marked.any() else f"{100 * marked.mean():.2g} %"


if __name__ == "__main__":
    run_script(main)
