# SPDX-License-Identifier: MIT
"""Picture of a calibration: measured against simulated points, and where on the part they differ."""

import matplotlib.pyplot as plt
import numpy as np

from fabseq_tools.plot.drawing import INK, OPTIMIZED, PLANAR, SOFT_INK, plain_text, save, tidy

COLOURS = OPTIMIZED, PLANAR, INK  # of the axes
DOTS = 150  # per inch
MOST_DRAWN = 20000  # points of a part


def draw_calibration(parts, fit, path):
    """A row for each part. On the left each measured value, without what a rigid motion explains of it, over
    the simulated one; on the right the points, coloured by the difference."""
    with plain_text():
        figure, axes = plt.subplots(len(parts), 2, figsize=(11.0, 4.6 * len(parts)), squeeze=False, constrained_layout=True)
        for (values, places), part, equations, rest in zip(axes, parts, fit.equations, fit.rests):
            drawn = np.random.default_rng(1).permutation(len(rest))[:MOST_DRAWN]
            unit = part.config["domain"].get("unit")
            unit = f", {unit}" if unit else ""
            draw_values(values, part, equations, rest, fit, drawn, unit)
            draw_places(figure, places, equations.points[drawn], rest[drawn], unit)
            if len(parts) > 1:
                values.set_title(part.path, fontsize=9, loc="left")
        save(figure, path, DOTS)
        plt.close(figure)


def draw_values(axis, part, equations, rest, fit, drawn, unit):
    measured = equations.values - equations.along @ equations.motion(fit.factors)
    simulated = measured - rest
    along = np.abs(equations.directions).argmax(axis=1)
    for number, colour in zip(range(equations.points.shape[1]), COLOURS):
        its = drawn[along[drawn] == number]
        label = f"mostly along {'xyz'[number]}" if part.measurement.moves else f"along {'xyz'[number]}"
        axis.plot(simulated[its], measured[its], ".", ms=4, color=colour, alpha=0.6, label=label)
    ends = [min(simulated.min(), measured.min()), max(simulated.max(), measured.max())]
    axis.plot(ends, ends, color=SOFT_INK, lw=1.0)
    what = "distance from the drawing" if part.measurement.moves else "displacement"
    axis.set_xlabel(f"simulated {what}{unit}")
    axis.set_ylabel(f"measured{unit}")
    axis.legend(frameon=False, fontsize=8)
    axis.text(0.98, 0.02, f"left of the measurement: {100 * fit.left():.3g} %", transform=axis.transAxes, ha="right", fontsize=9,
              color=SOFT_INK)
    tidy([axis])


def draw_places(figure, axis, points, rest, unit):
    """Seen along the shortest edge of the part's box."""
    across, up = sorted(np.argsort(-np.ptp(points, axis=0), kind="stable")[:2])
    largest = max(np.abs(rest).max(), 1e-300)
    order = np.argsort(np.abs(rest), kind="stable")  # the largest on top
    points, rest = points[order], rest[order]
    dots = axis.scatter(points[:, across], points[:, up], c=rest, s=9, cmap="RdBu_r", vmin=-largest, vmax=largest)
    axis.set_xlabel(f"{'xyz'[across]}{unit}")
    axis.set_ylabel(f"{'xyz'[up]}{unit}")
    axis.set_aspect("equal", "datalim")
    figure.colorbar(dots, ax=axis, label=f"measured less simulated{unit}", shrink=0.8)
    tidy([axis])
