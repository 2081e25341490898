# SPDX-License-Identifier: MIT
"""Holes whose roofs no sequence within the tilt can carry, as -task check names them, and what fills them."""

import dataclasses
import re

from fabseq_tools.start.config_text import Entry
from fabseq_tools.start.look import NUMBERS, point

HOLE = re.compile(rf"^hole: {NUMBERS} to {NUMBERS}, its roof spans (.*?), which", re.MULTILINE)
IN_THE_AIR = re.compile(rf"^in the air: {NUMBERS} to {NUMBERS}", re.MULTILINE)


@dataclasses.dataclass
class Hole:
    low: list
    high: list
    span: str  # with its unit

    def words(self, unit):
        size = " x ".join(f"{b - a:.3g}" for a, b in zip(self.low, self.high))
        centre = ",".join(f"{(a + b) / 2:.4g}" for a, b in zip(self.low, self.high))
        return f"a hole of {size} {unit} near [{centre}], whose roof spans {self.span}"

    def box(self):
        return {"box": {"min": self.low, "max": self.high}}


def stock_of(arguments, printed):
    """The entry that closes the holes of a part of which -task check has `printed` this, where there are any
    and --fill-holes asks for it, else None; what there is to tell, and warnings."""
    limit = f"{arguments.max_tilt:g} degrees"
    holes = [Hole(point(low), point(high), span) for low, high, span in HOLE.findall(printed)]
    warnings = [f"what lies in [{low}] to [{high}] is carried by no layers within {limit}: turn the part (fabseq-tools orient), "
                "or let the table tilt further" for low, high in IN_THE_AIR.findall(printed)]
    if not arguments.fill_holes:
        return None, [], [f"{hole.words(arguments.unit)}: no layers within {limit} carry it; --fill-holes closes it"
                          for hole in holes] + warnings
    if not holes:
        return None, [f"holes: layers within {limit} carry every roof, or a bead bridges it: none is closed"], warnings
    boxes = [hole.box() for hole in holes]
    return (Entry("stock", boxes[0] if len(boxes) == 1 else {"union": boxes},
                  f"Fills holes whose roofs no layers within {limit} carry (--fill-holes): machining stock, to be drilled."),
            [f"closed, to be drilled: {hole.words(arguments.unit)}" for hole in holes], warnings)
