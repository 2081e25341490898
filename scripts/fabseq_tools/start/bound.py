# SPDX-License-Identifier: MIT
"""How many elements a part may have."""

MOST_ELEMENTS = 50_000   # of the part: by default
PROGRAM_ALONE = 0.06     # GB of a run without elements


class Bound:
    """On elements (--elements), or on the memory of a run (--memory)."""

    def __init__(self, arguments, look):
        self.look, self.memory = look, arguments.memory
        self.elements = arguments.elements or MOST_ELEMENTS

    def words(self):
        if self.memory:
            return f"at most {self.memory:g} GB (--memory)"
        return f"at most {self.elements:,.0f} elements (--elements)"

    def fits(self, found):
        if self.memory:
            return self.memory_of(found) <= self.memory
        return self.look.counted(found) <= self.elements

    def memory_of(self, found):
        return found.memory * self.look.counted(found) / found.elements

    def usage(self, found):
        """Of the bound, as a share."""
        if self.memory:
            return max(self.memory_of(found) - PROGRAM_ALONE, 0.01) / max(self.memory - PROGRAM_ALONE, 0.01)
        return self.look.counted(found) / self.elements

    def edge_of(self, found):
        """The smallest edge within the bound, about."""
        return found.edge * self.usage(found) ** (1 / 3)
