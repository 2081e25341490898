#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Runs published cases and puts their figures into docs/results.

    scripts/figures/reproduce.py CASE... [--all-2d] [--ranks N] [--output output/cases] [-- PROGRAM OPTIONS]
    scripts/figures/reproduce.py --list

configs/cases.json holds the cases: a config each, and the keys of it that differ. A case goes to OUTPUT/CASE;
one that was interrupted goes on where it was, one that is done is only looked at again. Then the geometric
thickness of its layers is measured (scripts/use/geometric_thickness.py), its pseudo-time is cut into other
numbers of layers where the case asks for that, a small picture is drawn, and its page docs/results/CASE.md
and its row in docs/results.md are written.

Options of the program, such as -max_iterations 10, are for trials: give --results none with them.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "use"))

import case_table
import geometric_thickness
from read_run import Run, RunError, read_json

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# As in scripts/environment.sh; several mpirun side by side shall not share a core.
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="CASE")
    parser.add_argument("--list", action="store_true", help="print the cases")
    parser.add_argument("--all-2d", action="store_true", help="all cases in two dimensions")
    parser.add_argument("--ranks", type=int, help="processes (default: the case's)")
    parser.add_argument("--output", default=os.path.join("output", "cases"), help="default: %(default)s")
    parser.add_argument("--cases", default=os.path.join(ROOT, "configs", "cases.json"), help="default: configs/cases.json")
    parser.add_argument("--results", default=os.path.join(ROOT, "docs", "results.md"),
                        help="the overview, or none (default: docs/results.md)")
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", os.path.join(ROOT, "build", "release", "fabseq")))
    arguments, options = parser.parse_known_args(own_words())
    arguments.options = program_options(options, parser)
    try:
        cases = Cases(arguments.cases)
        if arguments.list:
            print(cases.listing())
            return
        names = chosen(cases, arguments)
    except RunError as error:
        sys.exit(f"reproduce.py: {error}")
    failed = [name for name in names if not reproduce(cases, name, arguments)]
    if failed:
        sys.exit(f"reproduce.py: failed: {', '.join(failed)}")


def own_words():
    """Words before `--`."""
    return sys.argv[1:sys.argv.index("--")] if "--" in sys.argv else sys.argv[1:]


def program_options(unknown, parser):
    if unknown:
        parser.error(f"unknown: {' '.join(unknown)} (options of the program go behind --)")
    return sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []


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
        return os.path.join(self.folder, self[name]["config"])

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

    def listing(self):
        width = max(map(len, self.table))
        return "\n".join(f"{name:<{width}}  {'2D' if self.is_flat(name) else '3D'}  [{case['source']}] {case['what']}"
                         for name, case in ((name, self[name]) for name in self.table))


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
    ranks = arguments.ranks or case.get("ranks", 2)
    again = ["-overwrite"] if simulates else ["-restart", "auto"]
    if not run(arguments.program, ranks, [*cases.command(name), *again, "-output", directory, *arguments.options]):
        return False
    try:
        planes = read_json(directory, "config.json")["layers"]["type"] == "multi_planar"
        thickness = None if planes else measure_thickness(directory)  # of planes it is given
        resliced = {count: reslice(arguments, ranks, directory, count) for count in case.get("reslice", [])}
        if arguments.results != "none":
            figures = case_table.figures_of(case, directory, thickness, resliced)
            os.makedirs(os.path.dirname(case_table.page_of(arguments.results, name)), exist_ok=True)
            picture = None if simulates else draw(directory, case_table.page_of(arguments.results, name))
            case_table.record(arguments.results, list(cases.table), name, case, figures, picture)
    except (RunError, OSError, subprocess.CalledProcessError) as error:
        print(f"reproduce.py: {name}: {error}", file=sys.stderr)
        return False
    return True


def run(program, ranks, words):
    command = ["mpirun", "-np", str(ranks), program, *words]
    print(" ".join(command), flush=True)
    return subprocess.run(command, env={**ENVIRONMENT, **os.environ}, check=False).returncode == 0


def measure_thickness(directory, target=None):
    record = geometric_thickness.measure(directory, target)
    with open(os.path.join(directory, "geometric_thickness.json"), "w", encoding="utf-8") as file:
        json.dump(record, file, indent=1)
        file.write("\n")
    return record


def reslice(arguments, ranks, directory, count):
    """As many planar layers, and the pseudo-time of a run cut into `count` layers, smooth and binary:
    summaries and geometric thickness."""
    sequence = ["-sequence", os.path.join(directory, "result.h5")]
    source = Run(directory, with_fields=False)
    planar_sequence = {"type": "planar", "direction": source.config["baseline"]["direction"]}
    planar = ["-set", "sequence=" + json.dumps(planar_sequence), "-set", "constraints=[]"]
    constraint = source.thickness_constraint()
    target = constraint["target"] * source.config["layers"]["count"] / count if constraint else None
    result = {}
    for kind, options in (("planar", planar), ("smooth", sequence), ("binary", [*sequence, "-binary"])):
        output = os.path.join(directory, f"layers_{count}_{kind}")
        words = ["-config", os.path.join(directory, "config.json"), "-task", "simulate", *options,
                 "-layers", str(count), "-overwrite", "-output", output]
        if not run(arguments.program, ranks, words):
            raise RunError(f"cut into {count} layers: the simulation failed")
        result[kind] = read_json(output, "summary.json")
    result["thickness"] = measure_thickness(output, target)
    return result


def draw(directory, page):
    """A small picture beside the page of the case; its path relative to that."""
    if not os.environ.get("DISPLAY") and not shutil.which("Xvfb"):
        print("reproduce.py: no picture: it needs a display, or Xvfb", file=sys.stderr)
        return None
    picture = page.removesuffix(".md") + ".png"
    subprocess.run([sys.executable, os.path.join(ROOT, "scripts", "figures", "small_picture.py"), directory, picture], check=True)
    return os.path.basename(picture)


if __name__ == "__main__":
    main()
