# SPDX-License-Identifier: MIT
"""The machine that a new config names, as the program reads its file."""

from fabseq_tools.run.check_words import ANY_TILT
from fabseq_tools.run.machine import keys_of_machine, machine_of, torch_tilts


class Machine:
    """`file`: value of the config's key `machine`. `target`: thickness of layers of one bead, or as the
    command line has it. `tilts`: whether the torch stands on the layers. Raises RunError with the program's
    line."""

    def __init__(self, arguments):
        self.file, self.unit = machine_of(arguments.machine), arguments.unit
        found = keys_of_machine(arguments.program, self.file, self.unit, arguments.thickness or arguments.bead_height)
        self.tool, self.target = found["tool"], found["layers"]["target"]
        self.max_tilt = self.tool.get("max_tilt", ANY_TILT)
        self.tilts, self.has_torch = torch_tilts(self.tool), "profile" in self.tool

    def words(self):
        """What follows from its file, in a line."""
        tool, words = self.tool, self.tool.get("name", "the machine")
        words += f": tilt up to {self.max_tilt:g} degrees" + (" of a torch that follows the layers" if self.tilts else
                                                              " of layers below an upright torch")
        words += f", beads {tool['bead_width']:g} {self.unit} wide and {tool['bead_height']:g} high"
        if "thickness" in tool:
            least, most = (self.target * end for end in tool["thickness"])
            words += f", layers of {self.target:g} that are {least:.3g} to {most:.3g} thick in places"
        return words
