# SPDX-License-Identifier: MIT
"""Configs of a plan, as `fabseq-tools new` chooses them."""

import contextlib
import dataclasses
import tempfile

from fabseq_tools.plan.steps import UNIT
from fabseq_tools.run.progress import Progress
from fabseq_tools.start import new_config
from fabseq_tools.start.choices import choose
from fabseq_tools.start.look import Found, Look

COARSE_ELEMENTS, COARSE_LAYERS, COARSE_ITERATIONS = 3000, 12, 25
AS_DRAWN = [0.0] * 3  # degrees about x, y and z
LEAST_ACROSS = 2.5  # elements of a coarse layer


@dataclasses.dataclass
class Made:
    """A config that was written to `path`; `remarks`, `warnings`, `found`: as choose() returns them; `size`:
    of the mesh's box."""

    path: str
    remarks: list
    warnings: list
    found: Found
    size: list


def words_for(arguments, scale, rotate, **more):
    """Words of the command `new` for the part of a plan."""
    words = [arguments.part, "--machine", arguments.machine, "--unit", UNIT, "--scale", repr(scale), "--sequence", "guided",
             f"--rotate={','.join(map(repr, rotate))}", "--program", arguments.program]
    given = {"material": arguments.material, "keep": arguments.keep} | more
    for name, value in given.items():
        if value is True:
            words.append(f"--{name}")
        elif value:
            words += [f"--{name}", str(value)]
    return words


@contextlib.contextmanager
def looking(words):
    """The options of `new`, settled, and the part as the program sees it."""
    options = new_config.parsed(words)
    new_config.settle_machine(options)
    with tempfile.TemporaryDirectory() as folder, Progress("plan") as progress:
        yield options, Look(options, folder, progress)


def coarse_config(arguments, path, scale, rotate, **more):
    """Writes one with some thousand elements and layers thick enough for them, which are simulated in
    seconds and judged as they are."""
    words = words_for(arguments, scale, rotate, elements=COARSE_ELEMENTS, iterations=COARSE_ITERATIONS, **more)
    with looking(words) as (options, look):
        first = look.first()
        bead, options.bead_height = options.bead_height, None
        edge = (first.volume / COARSE_ELEMENTS) ** (1 / 3)
        beads = max(1, round(max(first.geodesic / COARSE_LAYERS, LEAST_ACROSS * edge) / bead))
        options.thickness = beads * bead
        return written(options, look, path)


def full_config(arguments, path, scale, rotate, **more):
    """Writes one of as many elements as a run of so many minutes allows, with beads."""
    words = words_for(arguments, scale, rotate, elements=arguments.elements, iterations=arguments.iterations,
                      minutes=arguments.minutes, **more)
    with looking(words) as (options, look):
        return written(options, look, path)


def written(options, look, path):
    entries, remarks, warnings, found = choose(options, look)
    new_config.write(options, entries, path)
    return Made(path, remarks, warnings, found, look.size)
