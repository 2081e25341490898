#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Runs published cases and puts their figures into the pages of results/cases.

    figures/reproduce.py CASE... [--all-2d] [--ranks N] [--output output/cases] [-- PROGRAM OPTIONS]
    figures/reproduce.py --list
    figures/reproduce.py --command CASE...       how the program is called, to start from
    figures/reproduce.py --pages                 writes all pages again, runs nothing

configs/published/cases.json holds the cases: a config each, and the keys of it that differ, or another case
that it is like, and the keys that differ from it. A case goes to OUTPUT/CASE; one that was interrupted goes
on where it was, one that is done is only looked at again. Then the geometric thickness of its layers is
measured (scripts/fabseq-tools thickness), and its pseudo-time is cut into other numbers of layers where
the case asks for that. Its rows in results/cases/cases.csv are written, and from that table cases.md and the
pages beside the table. A page that shows a picture of the case gets a new one;
--picture adds one.

Options of the program, such as -max_iterations 10, are for trials: give --results none with them.
"""

import json
import os
import shlex
import shutil
import sys

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import RunError, parse, parser_of, run_command, run_script
from fabseq_tools.run.places import PROGRAM, ROOT

from case_figures import rows_of
from case_pages import Pages
from fabseq_tools.geometry import geometric_thickness
from fabseq_tools.run.read_run import Run, read_json


def main():
    parser = parser_of(__doc__)
    parser.add_argument("names", nargs="*", metavar="CASE")
    parser.add_argument("--list", action="store_true", help="print the cases")
    parser.add_argument("--command", action="store_true", help="print the command of each case, run nothing")
    parser.add_argument("--pages", action="store_true", help="write the pages as the table of figures has them, run nothing")
    parser.add_argument("--picture", action="store_true", help="a picture of each, even if its page had none")
    parser.add_argument("--all-2d", action="store_true", help="all cases in two dimensions")
    parser.add_argument("--ranks", type=int, help="processes (default: the case's)")
    parser.add_argument("--output", default=os.path.join("output", "cases"), help="default: %(default)s")
    parser.add_argument("--cases", default=os.path.join(ROOT, "configs", "published", "cases.json"),
                        help="default: configs/published/cases.json")
    parser.add_argument("--results", default=os.path.join(ROOT, "benchmarks", "evidence", "cases.md"),
                        help="the page of all cases, or none (default: benchmarks/evidence/cases.md)")
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", PROGRAM))
    arguments = parse(parser)
    cases = Cases(arguments.cases)
    if arguments.list:
        for name in cases.table:
            case, width = cases[name], max(map(len, cases.table))
            print(f"{name:<{width}}  {'2D' if cases.is_flat(name) else '3D'}  [{case['source']}] {case['what']}")
        return
    if arguments.command:
        for name in chosen(cases, arguments):
            print(shlex.join(program_call(arguments.program, arguments.ranks or cases.ranks(name), cases.command(name))))
        return
    if arguments.pages:
        Pages(arguments.results, cases).write_again()
        return
    failed = [name for name in chosen(cases, arguments) if not reproduce(cases, name, arguments)]
    if failed:
        raise RunError(f"failed: {', '.join(failed)}")


class Cases:
    """The table of cases: a dictionary each, by name, in the order of the file."""

    def __init__(self, path):
        self.folder = os.path.dirname(os.path.abspath(path))
        self.table = read_json(self.folder, os.path.basename(path))

    def __getitem__(self, name):
        if name not in self.table:
            raise RunError(f"{name}: no such case (--list names all)")
        case = self.table[name]
        if "like" not in case:
            return case
        other = self[case["like"]]
        return {**other, **case, "set": {**other.get("set", {}), **case.get("set", {})}}

    def config(self, name):
        return os.path.normpath(os.path.join(self.folder, self[name]["config"]))

    def ranks(self, name):
        return self[name].get("ranks", 2)

    def command(self, name):
        """The program's own words for a case, but for ranks and output."""
        words = ["-config", self.config(name), "-task", self[name].get("task", "optimize")]
        for key, value in self[name].get("set", {}).items():
            words += ["-set", f"{key}={value if isinstance(value, str) else json.dumps(value)}"]
        return words

    def is_flat(self, name):
        """Whether the case is two-dimensional. Configs have comments, so their text is looked at."""
        with open(self.config(name), encoding="utf-8") as file:
            size = file.read().split('"size"')[1].split("]")[0]
        return size.count(",") == 1


def chosen(cases, arguments):
    names = list(dict.fromkeys(arguments.names + [n for n in cases.table if arguments.all_2d and cases.is_flat(n)]))
    if not names:
        raise RunError("no case given (--list names all)")
    for name in names:
        _ = cases[name]
    if not os.access(arguments.program, os.X_OK):
        raise RunError(f"{arguments.program} is missing: scripts/setup.sh builds it")
    return names


def reproduce(cases, name, arguments):
    """One case with everything that follows; whether it worked."""
    case, directory = cases[name], os.path.join(arguments.output, name)
    simulates = case.get("task") == "simulate"
    ranks = arguments.ranks or cases.ranks(name)
    again = ["-overwrite"] if simulates else ["-restart", "auto"]
    try:
        run(arguments.program, ranks, [*cases.command(name), *again, "-output", directory, *arguments.rest])
        planes = read_json(directory, "config.json")["layers"]["type"] == "multi_planar"
        thickness = None if planes else geometric_thickness.write_record(directory)  # of planes it is given
        resliced = {count: reslice(arguments, ranks, directory, count) for count in case.get("reslice", [])}
        if arguments.results != "none":
            pages = Pages(arguments.results, cases)
            if not simulates and (arguments.picture or os.path.exists(pages.picture(name))):
                draw(directory, pages.picture(name))
            pages.record(name, rows_of(name, case, directory, thickness, resliced))
    except (RunError, OSError) as error:
        print(f"reproduce.py: {name}: {error}", file=sys.stderr)
        return False
    return True


def run(program, ranks, words):
    command = program_call(program, ranks, words)
    print(shlex.join(command), flush=True)
    run_command(command, capture=False)


def program_call(program, ranks, words):
    return ["mpirun", "-np", str(ranks), program, *words]


def reslice(arguments, ranks, directory, count):
    """As many planar layers, and the pseudo-time of a run cut into `count` layers, smooth and binary:
    summaries and geometric thickness."""
    sequence = ["-sequence", os.path.join(directory, "result.h5")]
    source = Run(directory, with_fields=False)
    planar_sequence = {"type": "planar", "direction": source.config["baseline"]["direction"]}
    planar = ["-set", "sequence=" + json.dumps(planar_sequence), "-set", "constraints=[]", "-set", "projection.max=auto"]
    constraint = source.thickness_constraint()
    target = constraint["target"] * source.layer_count() / count if constraint else None
    result = {}
    for kind, options in (("planar", planar), ("smooth", sequence), ("binary", [*sequence, "-binary"])):
        output = os.path.join(directory, f"layers_{count}_{kind}")
        run(arguments.program, ranks, ["-config", os.path.join(directory, "config.json"), "-task", "simulate", *options,
                                       "-layers", str(count), "-overwrite", "-output", output])
        result[kind] = read_json(output, "summary.json")
    result["thickness"] = geometric_thickness.write_record(output, target)
    return result


def draw(directory, picture):
    if not os.environ.get("DISPLAY") and not shutil.which("Xvfb"):
        print("reproduce.py: no picture: it needs a display, or Xvfb", file=sys.stderr)
        return
    run_command([sys.executable, os.path.join(ROOT, "benchmarks", "evidence", "figures", "small_picture.py"), directory, picture])


if __name__ == "__main__":
    run_script(main)
