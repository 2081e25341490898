# SPDX-License-Identifier: MIT
"""Whether factors that were found can be meant, and what else the measurement may be."""

import numpy as np

from fabseq_tools.calibration.column_names import AXES
from fabseq_tools.calibration.points_frame import RATIOS, turned_axes
from fabseq_tools.calibration.strain_factors import fit_factors
from fabseq_tools.geometry.placement import millimetres_of, name_of_unit
from fabseq_tools.run.command_line import RunError

RANGE = 0.05, 5.0        # of factors that a material may have
ZERO = 1e-3              # a factor that is none
MOST_LEFT = 0.2          # of the measurement, what a model that is right leaves
LARGEST_STRAIN = 0.1     # of any metal
LITTLE_LEFT = 0.02       # of the measurement: as much that no other reading is looked for
CLEARLY = 0.5            # of what is left: by how much another reading has to be better to be named
ALIKE = 0.9              # of what the first of some readings leaves: how much less a later one has to leave
MOST_LOOKED_AT = 600     # points, for other readings


class FitChecks:
    """Of the Fit of some parts, whose factors are `name`. `scale`: factors by axis; `parts` have
    `measurement` and `fields`, by whether the part is released ([a][b][z][y][x][axis]); empty where these are
    not known, so that nothing else is tried. `of_others`: what displacements in another unit would be."""

    name, of_others = "strain_scale", "it would be {}"

    def __init__(self, parts, fit, scale, determined, arguments):
        self.parts, self.fit, self.scale, self.determined, self.arguments = parts, fit, scale, determined, arguments
        self.unit = parts[0].config["domain"].get("unit")

    def refuse_nothing(self):
        """Raises a RunError where no strain is found."""
        zero = [AXES[axis] for axis in np.flatnonzero(self.determined & ~(self.scale > ZERO))]
        if not zero:
            return
        values = self.fit.strained
        roots = np.ones(len(self.fit.factors))
        if rms(values) < ZERO * rms(roots @ (roots @ self.fit.forms)):
            reason = "the measured points do not differ from the drawing, as nominal ones do"
        else:
            reason = "the part does not move as the model says" + self.words_of_other()
        raise RunError(f"{self.place_of(zero)}: found 0; allowed: above 0; {reason}")

    def place_of(self, axes):
        """What is wrong, with the axes that it is wrong along."""
        return f"{self.name} along {', '.join(axes)}"

    def warnings(self):
        """What the user should know, a text each."""
        outside = self.words_outside()
        result = [outside + self.words_of_unit()] if outside else []
        left = self.fit.left()
        other = self.words_of_other() if left > LITTLE_LEFT else ""
        if left > MOST_LEFT:
            result.append(f"the differences are {100 * left:.3g} % of the measurement; usual: up to {100 * MOST_LEFT:g} %; these "
                          f"factors do not explain it{other}")
        elif other:
            result.append(f"the differences are {100 * left:.3g} % of the measurement{other}")
        name, largest = self.largest_strain()
        if largest > LARGEST_STRAIN:
            result.append(f"{name}: found up to {largest:.3g}; usual: up to {LARGEST_STRAIN:g}, no per cent")
        return result

    def words_outside(self):
        """Which factors no material has, "" if none."""
        outside = [f"{self.scale[axis]:.4g} along {AXES[axis]}" for axis in np.flatnonzero(self.determined)
                   if not RANGE[0] <= self.scale[axis] <= RANGE[1]]
        return f"{self.name}: found {', '.join(outside)}; usual: {RANGE[0]:g} to {RANGE[1]:g}" if outside else ""

    def largest_strain(self):
        """What it is of, and its number."""
        strain = [largest_number(part.config.get("material", {}).get("inherent_strain", 0.0)) for part in self.parts]
        return "inherent strain with these factors", max(strain) * self.scale[self.determined].max(initial=0.0)

    def enlargements(self):
        """How many times larger than simulated the measured displacements are."""
        return self.scale[self.determined]

    def words_of_unit(self):
        """The unit that displacements may be in."""
        of_config = millimetres_of(self.unit)
        if of_config is None or any(part.measurement.moves for part in self.parts):
            return ""
        factors = self.enlargements()
        for ratio in RATIOS:
            name = name_of_unit(of_config / ratio)
            if name and np.all((factors / ratio >= RANGE[0]) & (factors / ratio <= RANGE[1])):
                found = ", ".join(f"{factor / ratio:.4g}" for factor in factors)
                return (f"; with displacements in {name}{f' beside points in {self.unit}' * bool(self.unit)} "
                        + self.of_others.format(found))
        return ""

    def words_of_other(self):
        """The other reading of the measurement that leaves least, if it leaves clearly less."""
        best, words = CLEARLY * self.fit.left(), ""
        for name, measurements, released in self.readings():
            try:
                fit = fit_factors(measurements, [part.fields[released] for part in self.parts], self.arguments.rigid)
            except RunError:
                continue
            if fit.left() < best and np.all(fit.factors > ZERO):
                best, words = ALIKE * fit.left(), f"; {name} would leave {100 * fit.left():.3g} %"
        return words

    def readings(self):
        """(words, measurements, released) of what else may have been measured."""
        released = self.arguments.released
        if not all(part.fields for part in self.parts):
            return
        few = [part.measurement.picked(some(len(part.measurement.points))) for part in self.parts]
        if all((not released) in part.fields for part in self.parts):
            yield ("a part before its release (without --released)" if released else "a part after its release (--released)",
                   few, not released)
        if not any(measurement.moves for measurement in few):
            moved = [measurement.picked(np.nan_to_num(measurement.measured).any(1)) for measurement in few]
            count = sum(len(a.points) - len(b.points) for a, b in zip(few, moved))
            if count and all(len(measurement.points) for measurement in moved):
                yield "without the points whose displacement is exactly 0, as where nothing was measured, it", moved, released
        for name, matrix in turned_axes(few[0].points.shape[1]):
            ways = list(zip(*(measurement.turned(matrix) for measurement in few)))
            for way, what in zip(ways, ("points" if few[0].moves else "displacements", "points and displacements")):
                words = f"{what} whose axes {name} are the part's {', '.join(AXES[:len(matrix)])}"
                if what == "displacements" and np.array_equal(matrix, -np.eye(len(matrix))):
                    words = "displacements of the opposite sign"
                yield words, list(way), released


def some(count):
    return np.sort(np.random.default_rng(1).permutation(count)[:MOST_LOOKED_AT])


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


def largest_number(value):
    """The largest absolute number in what a config says of the strain."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return max(map(largest_number, value), default=0.0)
    return abs(float(value)) if isinstance(value, (int, float)) else 0.0
