#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Optimizes the parts of studies/flow_cases.json with the linear process and with plastic flow, both with the
part's temperature, and prints a table of what plastic flow says of the layers of both.

    figures/optimized_with_flow.py [CASE...] [--ranks N] [--output output/flow] [--cases FILE.json] [--table]
                                   [--finer] [-- PROGRAM OPTIONS]

All rows are of binary layers at nominal positions, simulated with plastic flow. A length is the root mean
square of the skin's distance from the drawing, with --finer also of the same layers with each element
divided into eight. Seconds are those of one iteration and of the whole optimization. Cases with settings of
guided layers are optimized in those. A run that was interrupted goes on where it was, one that is done is
only looked at again; --table runs nothing.
"""

import os
import statistics

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import run_script
from fabseq_tools.run.read_run import read_history

from built import parse_cases, parser_of_cases, print_cases, rounds_of
from fabseq_tools.run.check_words import inner, result_of
from fabseq_tools.run.words import number
from fabseq_tools.study.comparison import BINARY
from fabseq_tools.study.families import Families, heights_of
from heat_and_plasticity.bricks import Bricks
from heat_and_plasticity.finer import finer_settings

HEAD = ("part", "layers", "as built", "released", "class", "s per iteration", "s")
FINER_HEAD = (*HEAD[:4], "as built, finer", "released, finer", *HEAD[4:])
NOMINAL = {"process.deposition": "nominal"}
FLOW = NOMINAL | {"process.model": "elastoplastic"}
MODELS = {"optimized, linear": ("linear", NOMINAL), "optimized, with flow": ("flow", FLOW)}


def main():
    parser = parser_of_cases(__doc__, "flow")
    parser.add_argument("--finer", action="store_true", help="also on a grid twice as fine")
    arguments, cases = parse_cases(parser)

    def rows(name):
        rounds = rounds_of(cases, name, arguments)
        for layers, judgement, run, seconds in judged(rounds, cases[name].get("guided")):
            lengths = lengths_of(run) + (lengths_of(finer(rounds, judgement)) if arguments.finer else [])
            yield [layers, *lengths, inner("verdict", "words")(run.summary[result_of(run)]), *seconds]
    print_cases(arguments, cases, FINER_HEAD if arguments.finer else HEAD, rows)


def judged(rounds, guided):
    """Layers, name of the simulation, its result and seconds of each of a part's rows. `guided`: settings of
    guided layers; None: the config's own."""
    families = Families(rounds.config, rounds.target_thickness(), {"guided": guided})
    height = heights_of(rounds.run(*families.one_layer().run()))
    planar = families.planar("", "", families.up, height(families.up))
    yield "planar", "planar", rounds.run("planar", planar.settings | FLOW | BINARY, "simulate"), ["–", "–"]
    layers_of = {} if guided is None else families.guided().settings
    for layers, (name, model) in MODELS.items():
        rounds.run(name, layers_of | model)
        design = os.path.join(rounds.path(name), "result.h5")
        judgement = f"{name}_judged"
        run = rounds.run(judgement, layers_of | FLOW | BINARY, "simulate", ["-design", design])
        yield layers, judgement, run, seconds_of(rounds.path(name))


def finer(rounds, judgement):
    """The simulation of the layers of another one, with each element divided into eight."""
    name = f"{judgement}_finer"
    settings = finer_settings(Bricks(rounds.path(judgement)), rounds.path(f"{name}.h5"))
    measured = [term for term in rounds.config["objective"] if term["type"] == "distortion"]
    return rounds.run(name, FLOW | BINARY | {"objective": measured, "constraints": []} | settings, "simulate")


def seconds_of(directory):
    seconds = [line["seconds"]["total"] for line in read_history(directory)]
    return [number(statistics.median(seconds[1:])), number(sum(seconds))]


def lengths_of(run):
    """The cells of its skin's lengths."""
    block = run.summary[result_of(run)]
    lengths = [inner("finished", state, "skin", "rms")(block) for state in ("as_built", "released")]
    return ["–" if value is None else number(value) for value in lengths]


if __name__ == "__main__":
    run_script(main)
