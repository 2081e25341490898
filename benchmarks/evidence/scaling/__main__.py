# SPDX-License-Identifier: MIT
"""The command line of the scaling model."""

import dataclasses
import os
import sys
import tempfile

from ... import program_run
from ...program_run import parse_split
from . import __doc__ as documentation
from . import check
from .machine import Machine
from .predict import CASES, run_parts, run_predict


def parse_arguments():
    parser = program_run.parser_of(documentation, prog="PYTHONPATH=scripts python3 -m benchmarks.evidence.scaling")
    commands = parser.add_subparsers(dest="command", required=True)
    checks = commands.add_parser("check", help="counts of small runs beside the model's")
    program_run.add_program_option(checks)
    checks.add_argument("--cases", nargs="+", default=list(check.CASES), choices=list(check.CASES),
                        help="default: both")
    checks.add_argument("--splits", nargs="+", type=parse_split,
                        default=[(1, 4), (2, 4), (1, 16)], metavar="GxD", help="default: 1x4 2x4 1x16")
    checks.set_defaults(rest=[])
    predicts = commands.add_parser("predict", help="time over cores")
    predicts.add_argument("--plot", metavar="FILE")
    predicts.add_argument("--csv", metavar="FILE")
    predicts.add_argument("--before", metavar="FILE", help="a CSV of another prediction")
    predicts.add_argument("--measured", metavar="FILE", help="a CSV of strong_scaling.py, of the V-shape")
    parts = commands.add_parser("parts", help="what the time of splits is made of")
    parts.add_argument("--case", default="v_shape", choices=list(CASES))
    parts.add_argument("--splits", nargs="+", type=parse_split, default=[(1, 1)], metavar="GxD")
    for command in (checks, predicts, parts):
        command.add_argument("--plan", metavar="PROGRAM", help="default: build/release/benchmarks/scaling_plan",
                             default=os.path.join(os.path.dirname(program_run.PROGRAM), "benchmarks", "scaling_plan"))
    for command in (predicts, parts):
        for field in dataclasses.fields(Machine):
            command.add_argument("--" + field.name.replace("_", "-"), type=field.type,
                                 default=field.default, help="default: %(default)g")
    return parser.parse_args()


def main():
    options = parse_arguments()
    if options.command == "check":  # status 1 if not all messages are as many and as large as the model says
        with tempfile.TemporaryDirectory() as directory:
            library = check.build_library(directory)
            sys.exit(any([check.compare(options, case, *split, library)
                          for case in options.cases for split in options.splits]))
    on = Machine(**{field.name: getattr(options, field.name) for field in dataclasses.fields(Machine)})
    (run_predict if options.command == "predict" else run_parts)(options, on)


if __name__ == "__main__":
    sys.argv[0] = "benchmarks.evidence.scaling"  # what mistakes are named after
    program_run.run_script(main)
