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

    fill = bool(arguments.fill_holes)
    config = made(fill)
    holes = holes_of(config)
    if arguments.fill_holes is None and holes:
        listed = "".join(f"\n  {words}" for words in holes)
        question = f"no layers carry the roofs of{listed}\nclose them, to be drilled afterwards (y, n)?"
        fill = steps.choose(question, "yn", "n") == "y"
        config = made(True) if fill else config
    found = contact_of(config) | {"holes": holes_of(config),
                                  "closed": [words for words in config.remarks if words.startswith("closed")]}
    warnings = [text for text in config.warnings if text.startswith(TOLD)]
    if found["area"] < NARROW * found["foot"]:
        warnings.insert(0, f"the part stands on {percent(found['area'] / found['foot'])} of the area below it: clamp it, or turn "
                        "it (--rotate)")
    return {"line": line_of(found), "warnings": warnings, "config": path, "rotate": turned["rotate"], "scale": part["scale"],
            "density": part["density"], "fill_holes": fill} | found


def line_of(found):
    closed, holes = found["closed"], found["holes"]
    line = f"stands on {quantity(found['area'], 'mm²')} of the plate"
    line += f", in {found['standing']} pieces" if found["standing"] > 1 else ""
    line += f"; {percent(found['share_hanging'])} of it lies in the air and is left out" if found["hanging"] else ""
    line += f"; {count_of(closed)} closed, to be drilled" if closed else ""
    if holes:
        line += f"; {count_of(holes)} stay{'s' * (len(holes) == 1)} open that no layers carry (--fill-holes closes)"
    return line if closed or holes else f"{line}; no hole that layers cannot carry"


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
