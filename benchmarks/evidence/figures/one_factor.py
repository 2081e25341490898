#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Tells what one factor, fitted to one part, brings on others, with plastic flow, against CalculiX.

    figures/one_factor.py [--output output/with_heat] [--table]

OUTPUT is the folder of with_heat.py, which has to be run first. `fabseq-tools calibrate` fits one factor,
on the elongation or on the yield stress with its hardening, to the arm in planar layers: displacements of
C3D8I after the release, in a frame of their own. All parts are simulated with it, and also with a factor
fitted to each part's own planar layers.

Leaves OUTPUT/one_factor.json and the runs beside those of with_heat.py, and prints tables. What is there is
not run again. --table runs nothing.
"""

import os

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import parse, parser_of, run_command, run_script, write_json
from fabseq_tools.run.places import PROGRAM, ROOT

import numpy as np

from fabseq_tools.geometry.rigid_motions import without_rigid_motion
from fabseq_tools.run.read_run import read_json
from heat_and_plasticity import steel
from heat_and_plasticity.bricks import Bricks
from heat_and_plasticity.compared import BRICKS, FLOW, relative
from heat_and_plasticity.tables import print_factor_tables
from with_heat import RUNS, Study, moved_of, set_words

FITTED, CASES, KINDS = "arm", ("arm", "wall", "cross", "tee"), ("elongation", "yield")
TRUTH = BRICKS[0]
TOOL = os.path.join(ROOT, "scripts", "fabseq-tools")


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--output", default=os.path.join("output", "with_heat"))
    parser.add_argument("--table", action="store_true", help="only of what is there")
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", PROGRAM))
    arguments = parse(parser)
    if not arguments.table:
        write_json(os.path.join(arguments.output, "one_factor.json"), figures(arguments))
    print_factor_tables(read_json(arguments.output, "one_factor.json"))


def figures(arguments):
    """Factors {case: {kind: the record of calibrate}}, and errors {case: {sequence: {column: error}}}."""
    factors = {case: {kind: calibrated(arguments, case, kind) for kind in KINDS} for case in CASES}
    return {"factors": factors, "errors": {case: errors(arguments, case, factors) for case in CASES}}


def calibrated(arguments, case, kind):
    """What calibrate finds for the planar layers of a case."""
    folder = os.path.join(arguments.output, case)
    output, table = os.path.join(folder, f"calibrated_{kind}"), os.path.join(folder, "planar_measured.csv")
    if not os.path.exists(os.path.join(output, "calibration.json")):
        with np.load(folder + ".npz") as fields:
            np.savetxt(table, np.hstack([fields["planar/points"], fields[f"planar/{TRUTH}"]]), delimiter=",",
                       header="x,y,z,ux,uy,uz", comments="")
        run_command([TOOL, "calibrate", os.path.join(folder, "planar_flow"), table, "--released", "--rigid", "--factor", kind,
                     "--program", arguments.program, "--output", output])
    return read_json(output, "calibration.json")


def errors(arguments, case, factors):
    """Of each sequence without a factor, and with each kind of factor, the fitted part's and its own."""
    study, found = Study(arguments, case), {}
    with np.load(study.output + ".npz") as file:
        fields = dict(file)
    for sequence in study.sequences:
        theirs = fields[f"{sequence}/{TRUTH}"]
        found[sequence] = {"none": relative(fields[f"{sequence}/{FLOW}"], theirs)}
        for kind in KINDS:
            for name, of in ((f"{FITTED}'s", FITTED), ("own", case)):
                ours = moved_with(study, sequence, kind, factors[of][kind])
                found[sequence][f"{kind}, {name}"] = relative(ours, theirs)
    return found


def moved_with(study, sequence, kind, record):
    """Displacement of the part's nodes with a factor, without rigid motions."""
    steels = {f"material.{key}": value for key, value in steel.flow_material().items()}
    settings = RUNS[FLOW] | {key: (record["factor"] * np.array(steels[key])).tolist() for key in record["factored"]}
    directory = study.run(f"{sequence}_flow_{kind}_{record['factor']:.4g}", "simulate", "-binary", *study.words_of(sequence),
                          *set_words(settings))
    bricks = Bricks(directory)
    nodes = bricks.part_nodes()
    return without_rigid_motion(moved_of(directory)[nodes], bricks.positions[nodes])


if __name__ == "__main__":
    run_script(main)
