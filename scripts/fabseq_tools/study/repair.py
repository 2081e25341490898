# SPDX-License-Identifier: MIT
"""Mends the binary layers of a run where they fail the machine's checks at few places.

    fabseq-tools repair RUN [--share 0.005] [--output DIR] [--ranks N] [--program build/release/fabseq]
                        [-- OPTIONS OF THE PROGRAM]

RUN is the output directory of an optimization or a simulation with curved layers. The tool does by hand what
an optimization with optimizer.repair_iterations does at its end: -task simulate -repair. The times of the
nodes around each place are changed, then single elements go to a later or an earlier layer. Layers are kept
only if fewer elements fail, and more in none of the checks. --share is the largest share of the part's
elements that may fail, and that may go to another layer (optimizer.repair_share, up to 0.1; default: that of
RUN).

What was wrong and what is left is printed. DIR (default: RUN/repaired, which is made anew) gets the files of
the simulation. Where repaired layers are kept, these are simulated, and summary.json has the block `repair`;
else the layers of RUN are simulated. A RUN that passes all checks is left as it is, and DIR is not written,
unless options behind -- may change the checks.
"""

import os

import h5py
import numpy as np

from fabseq_tools.run import verdict_words as verdicts
from fabseq_tools.run.check_words import percent, result_of
from fabseq_tools.run.command_line import RunError, between, count, parse, parser_of, require_program, run_program
from fabseq_tools.run.places import PROGRAM
from fabseq_tools.run.read_run import Run
from fabseq_tools.run.words import number, quantity

COMMAND = "repair"
LARGEST_SHARE = 0.1  # that the program allows
CHECKS = [name for name, _, _ in verdicts.FAULTS]


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("run")
    parser.add_argument("--share", type=between(0, LARGEST_SHARE), help="of the elements (default: as in RUN)")
    parser.add_argument("--output", metavar="DIR", help="default: RUN/repaired")
    parser.add_argument("--ranks", type=count, default=1)
    parser.add_argument("--program", default=PROGRAM)
    arguments = parse(parser, words)
    require_program(arguments.program)
    run = judged_run(arguments.run)
    if verdicts.verdict(run, result_of(run))["buildable"] and not arguments.rest:
        print(nothing_fails(run))
        return
    print(*told(simulate(arguments, run)), sep="\n")


def judged_run(directory):
    """Raises RunError for a run whose layers the program has not judged or cannot mend."""
    run = Run(directory, with_fields=False, simulations=True)
    if verdicts.class_of(verdicts.verdict_of(run.summary.get(result_of(run)))) is None:
        raise RunError(f"{os.path.join(directory, 'summary.json')}: {result_of(run)}: found no class of the verdict; "
                       "repeat the run")
    if run.config.get("layers", {}).get("type") == "multi_planar":
        raise RunError(f"{directory}: /layers/type is multi_planar, and such layers have no times to change; "
                       "allowed: curved layers")
    return run


def simulate(arguments, run):
    """The run of the repair."""
    output = arguments.output or os.path.join(arguments.run, "repaired")
    options = [*layers_of(run, os.path.join(arguments.run, "result.h5")), "-binary", "-repair", "-output", output]
    if arguments.share is not None:
        options += ["-set", f"optimizer.repair_share={arguments.share!r}"]
    if not arguments.output:
        options.append("-overwrite")  # another folder may hold another run
    run_program(arguments, os.path.join(arguments.run, "config.json"), "simulate", *options)
    found = Run(output, with_fields=False, simulations=True)
    found.directory = output
    return found


def layers_of(run, path):
    """The program's words for the layers that the run has judged: its design, or its times if a repair has
    changed them."""
    return ["-design" if "repair" not in run.summary and has_design(path) else "-sequence", path]


def has_design(path):
    with open_result(path) as file:
        return "design" in file


def open_result(path):
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise RunError(f"{path} cannot be read: {error}") from error


def told(run):
    """What came of a repair, as lines."""
    repair = run.summary.get("repair")
    if repair:
        return repaired(run, repair)
    verdict = verdicts.verdict(run, "simulated")
    return [nothing_fails(run) if verdict["buildable"] else f"{verdicts.in_short(verdict)}, not repaired: {why_not(run)}"]


def nothing_fails(run):
    return f"{verdicts.buildable(run, result_of(run))}, not repaired: no element fails a check"


def repaired(run, repair):
    before, moved = repair["before"], len(repair["moved"])
    earlier = verdicts.class_with_places(before["class"], before["places_in_all"])
    yield f"{verdicts.buildable(run, 'simulated')}; before the repair: {earlier}"
    yield f"{elements(repair['repaired'])} repaired, {moved:,} of them moved to another layer"
    state, skin = skin_of(run)
    yield (f"skin {state}: rms {number(skin['rms'])}, before {quantity(before['rms'], run.unit)}; "
           f"largest {number(skin['max'])}, before {quantity(before['largest'], run.unit)}")
    left = verdicts.place_lines(run.summary)
    yield "places left:" if left else "no place left"
    yield from (f"  {words}" for words in left)
    yield f"results in {run.directory}; go on with fabseq-tools report, paths"


def skin_of(run):
    """The state that the program compares, and the skin's deviation in it."""
    finished = run.summary["finished"]
    is_released = finished["released"] and any(term.get("after_release") for term in run.config["objective"])
    return ("after the release", finished["released"]["skin"]) if is_released else ("as built", finished["as_built"]["skin"])


def why_not(run):
    """Why layers that fail checks are not repaired."""
    share = run.config["optimizer"]["repair_share"]
    checks = (run.summary["checks"].get(name) or {} for name in CHECKS)
    failed = sum(sum(check.get("per_layer") or []) for check in checks)
    with open_result(os.path.join(run.directory, "result.h5")) as file:
        part = np.count_nonzero(file["density"][()] > 0)
    fail = f"{failed:,} failed check{'s' * (failed != 1)} in {part:,} elements"
    if failed > share * part:
        return f"found {fail}; allowed: {percent(share)} of the elements (--share)"
    return f"found {fail}, and no better layers within {percent(share)} of the elements (--share)"


def elements(number_of_them):
    return f"{number_of_them:,} element{'s' * (number_of_them != 1)}"
