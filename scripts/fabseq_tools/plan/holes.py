# SPDX-License-Identifier: MIT
"""The third step of a plan: what the part stands on, and the holes whose roofs no layers carry."""

from fabseq_tools.plan.configs import coarse_config
from fabseq_tools.run.check_words import percent
from fabseq_tools.run.words import quantity

TOLD = "a hole of", "what lies in"  # begin what a coarse config says of the part, and not of its elements
NARROW = 0.05  # of the box's foot: below, a part may tip over


def settle_holes(steps, part, turned):
    """The coarse config of the part as it is built: turned, its holes closed or open."""
    arguments = steps.arguments
    path = steps.path("coarse", f"{arguments.name}.json")

    def made(fill):
        return coarse_config(arguments, path, part["scale"], turned["rotate"], **{"fill-holes": fill})

    fill, config = bool(arguments.fill_holes), None
    if arguments.fill_holes is None:
        config = made(False)
        holes = holes_of(config)
        if holes:
            listed = "\n".join(f"  {words}" for words in holes)
            fill = steps.choose(f"no layers carry the roofs of\n{listed}\nclose them, to be drilled afterwards (y, n)?", "yn", "n") == "y"
    if config is None or fill:
        config = made(fill)
    found = contact_of(config)
    closed = [words for words in config.remarks if words.startswith("closed")]
    open_ones = holes_of(config)
    line = f"stands on {quantity(found['area'], 'mm²')} of the plate"
    line += f", in {found['standing']} pieces" if found["standing"] > 1 else ""
    line += f"; {percent(found['share_hanging'])} of it lies in the air and is left out" if found["hanging"] else ""
    line += f"; {count_of(closed)} closed, to be drilled" if closed else ""
    line += f"; {count_of(open_ones)} stay{'s' * (len(open_ones) == 1)} open that no layers carry (--fill-holes closes)" if open_ones else ""
    line += "" if closed or open_ones else "; no hole that layers cannot carry"
    narrow = found["area"] < NARROW * found["foot"]
    warnings = [f"the part stands on {percent(found['area'] / found['foot'])} of the area below it: clamp it, or turn it (--rotate)"]
    return {"line": line, "warnings": warnings * narrow + [text for text in config.warnings if text.startswith(TOLD)], "config": path, "rotate": turned["rotate"],
            "scale": part["scale"], "density": part["density"], "fill_holes": fill, "holes": open_ones, "closed": closed} | found


def holes_of(made):
    """In words, those that stay open."""
    return [text.partition(": no layers")[0] for text in made.warnings if text.startswith("a hole of")]


def count_of(holes):
    return f"{len(holes)} hole{'s' * (len(holes) != 1)}"


def contact_of(made):
    """Area on the plate and of the box's foot, in mm²; pieces that stand and that hang."""
    found = made.found
    return {"area": found.contact * found.edge**2, "foot": made.size[0] * made.size[1], "standing": found.standing,
            "hanging": found.hanging, "share_hanging": found.share_hanging}
