# SPDX-License-Identifier: MIT
"""Compares planar, tilted, multi-planar, heat and guided layers of a part within one machine's limits.

    fabseq-tools compare-families PART.json [--subparts 2 3 4] [--step 20] [--azimuths 4] [--ranks 2]
                                  [--output DIR] [--program build/release/fabseq] [-- OPTIONS OF THE PROGRAM]

The limits are those of the config's tool: range of local thickness, largest tilt, torch; and nothing begins
in the air. The config needs a layer_thickness constraint. Constraints on the limits are added where the
config has none: those of a type that a kind of layers does not have are left out for it.

    planar               one simulation
    tilted planar        the best of a scan: tilts in steps of --step degrees up to the limit (60 without
                         one), to as many sides as --azimuths says; those that satisfy the checks first
    multi-planar         optimized, as many sub-parts as --subparts says, which start leaning to that side
    heat, guided         optimized; guided without the uniformity of layers

Planar layers have the target thickness. Optimizations take the config's own iterations; options behind -- go
to all runs (-- -max_iterations 60). Into DIR, by default output/PART_families, go families.json, .csv and
.png, and a folder for each run. A run that is done is not repeated, and one that was interrupted goes on.
"""

import os

from fabseq_tools.run.command_line import RunError, parse
from fabseq_tools.run.progress import Progress
from fabseq_tools.study import figures
from fabseq_tools.study.families import Families, heights_of
from fabseq_tools.study.families_picture import draw
from fabseq_tools.study.rounds import Rounds, parser_of_rounds

COMMAND = "compare-families"
FIRST = "layers", "layers"  # key and heading of a table's first column
STEPS = 1.0, 90.0           # degrees, of the scan


def main(words):
    parser = parser_of_rounds(__doc__, COMMAND, "PART.json", None)
    parser.add_argument("--subparts", type=int, nargs="*", default=[2, 3, 4], metavar="N", help="default: 2 3 4")
    parser.add_argument("--step", type=float, default=20.0, metavar="DEGREES", help="of the scan (default: %(default)s)")
    parser.add_argument("--azimuths", type=int, default=4, metavar="N", help="sides of the scan in 3D (default: %(default)s)")
    arguments = parse(parser, words)
    arguments.output = arguments.output or figures.folder_of(arguments.config, "families")
    if not STEPS[0] <= arguments.step <= STEPS[1]:
        raise RunError(f"--step: found {arguments.step:g}; allowed: {STEPS[0]:g} to {STEPS[1]:g}")
    for name, found in [("azimuths", arguments.azimuths), *(("subparts", count) for count in arguments.subparts)]:
        if not 1 <= found <= 100:
            raise RunError(f"--{name}: found {found}; allowed: 1 to 100")
    rounds = Rounds(arguments)
    target = rounds.target_thickness()
    comparison = Comparison(rounds, Families(rounds.config, target), target)
    rows = comparison.rows(arguments)
    if all("reason" in row for row in rows):
        raise RunError(f"no run came to an end: {rows[0]['reason']}")
    record = {"unit": rounds.config["domain"].get("unit") or "", "target": target, "scan": comparison.scan}
    path = os.path.join(arguments.output, "families")
    figures.print_table(rows, FIRST, record["unit"])
    figures.write_table(rows, record, path, FIRST)
    draw(rows, record, path)


class Comparison:
    """`scan`: rows of all tilted planar layers."""

    def __init__(self, rounds, families, target):
        self.rounds, self.families, self.target, self.scan = rounds, families, target, []

    def rows(self, arguments):
        families = self.families
        height = heights_of(self.run(families.one_layer()))
        rows = [self.row(families.planar("planar", "planar", families.up, height(families.up)))]
        best = self.best_of_scan(arguments, height)
        lean = families.up if best is None else best["direction"]
        rows += [best] if best else []
        rows += [self.row(families.multi_planar(count, lean)) for count in arguments.subparts]
        return rows + [self.row(families.heat()), self.row(families.guided())]

    def best_of_scan(self, arguments, height):
        """None where the limit is less than a step."""
        with Progress(f"{COMMAND}: tilted planar layers") as progress:
            directions = list(self.families.directions(arguments.step, arguments.azimuths))
            for number, (tilt, direction) in enumerate(progress.steps(directions, "direction")):
                name = f"tilted_{tilt:g}_{number % arguments.azimuths}"
                family = self.families.planar(f"tilted planar, {tilt:g} degrees", name, direction, height(direction))
                self.scan.append(self.row(family, say=False) | {"tilt": tilt, "direction": direction.tolist()})
        done = [row for row in self.scan if "reason" not in row]
        if not done:
            return self.scan[0] if self.scan else None
        return min(done, key=lambda row: (not row["satisfied"], row["objective"]))

    def row(self, family, say=True):
        """With the reason alone if the program refuses these layers, or fails."""
        if say:
            print(family.label, flush=True)
        row = {"layers": family.label, "folder": family.name}
        try:
            run = self.run(family)
        except RunError as error:
            if say:
                print(f"  {error}", flush=True)
            return row | {"reason": str(error)}
        return row | figures.row_of(run, self.target)

    def run(self, family):
        return self.rounds.run(family.name, family.settings, family.task)
