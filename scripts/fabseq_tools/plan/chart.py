# SPDX-License-Identifier: MIT
"""The chart of a plan's page: tilt and pause of each layer."""

import io

import matplotlib.pyplot as plt

from fabseq_tools.plot.drawing import OPTIMIZED, PLANAR, plain_text, tidy


def chart_of_layers(layers):
    """As SVG. `layers`: with `layer`, `tilt` (the largest, degrees) and `pause` (seconds, None: none is long
    enough)."""
    numbers = [layer["layer"] for layer in layers]
    with plain_text():
        figure, (above, below) = plt.subplots(2, 1, figsize=(7.6, 3.4), sharex=True, layout="constrained")
        above.step(numbers, [layer["tilt"] for layer in layers], where="mid", color=OPTIMIZED)
        above.set_ylabel("largest tilt, °")
        above.set_ylim(bottom=0)
        below.bar(numbers, [layer["pause"] or 0.0 for layer in layers], width=1.0, color=PLANAR)
        below.set_ylabel("pause, s")
        below.set_xlabel("layer")
        endless = [layer["layer"] for layer in layers if layer["pause"] is None]
        if endless:
            below.set_title(f"no pause is long enough after {len(endless)} layers: the plate is too hot", fontsize=9)
        tidy((above, below))
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
        plt.close(figure)
    return text.getvalue().partition("\n<!DOCTYPE")[2].partition(">\n")[2]
