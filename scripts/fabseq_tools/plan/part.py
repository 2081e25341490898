# SPDX-License-Identifier: MIT
"""The first step of a plan: the part as drawn, and its unit."""

from fabseq_tools.geometry.placement import MILLIMETRES
from fabseq_tools.plan.configs import AS_DRAWN, looking, words_for
from fabseq_tools.plan.steps import UNIT
from fabseq_tools.run.read_run import read_config
from fabseq_tools.run.words import quantity
from fabseq_tools.start.config_text import plain
from fabseq_tools.start.materials import material_of
from fabseq_tools.start.new_config import LARGE, SMALL

ASKED = "mm", "cm", "m", "in", "ft"
PER_CM3 = 1e-3  # of a volume in mm³


def settle_part(steps):
    """Size and mass of the part, with the file's unit of length."""
    arguments, unit = steps.arguments, steps.arguments.unit
    if unit is None and steps.can_ask():
        with looking(words_for(arguments, 1.0, AS_DRAWN)) as (_, look):
            size = look.size
        unit = steps.choose(f"{arguments.part} measures {by(size)}; in which unit ({', '.join(ASKED)})?", ASKED, UNIT)
    unit = unit or UNIT
    scale = MILLIMETRES[unit]
    with looking(words_for(arguments, scale, AS_DRAWN)) as (options, look):
        first = look.first()
        material = plain([material_of(options)[0]])["material"]
    density = read_config(material["file"]).get("mass_density")
    mass = first.volume * density if density else None
    warnings = [] if SMALL <= max(look.size) <= LARGE else [
        f"the part is {by(look.size)} mm with its file in {unit}: is it in another unit (--unit)?"]
    line = f"{by(look.size)} mm, {quantity(PER_CM3 * first.volume, 'cm³')}"
    line += f", {quantity(mass, 'kg')}" if mass else ""
    line += f", with the file in {unit}{' (--unit)' * (arguments.unit is None)}"
    return {"line": line, "warnings": warnings, "scale": scale, "density": density}


def by(size):
    return " × ".join(f"{edge:.4g}" for edge in size)
