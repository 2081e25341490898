# SPDX-License-Identifier: MIT
"""A bar beside a rendered picture that tells which value a colour is."""

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

BAR_SHARE = 0.16  # of the whole picture's width, for the bar and its figures
LETTERS = 0.018   # of the height
DOTS = 100        # per inch: points of letters are 1/72 of it


def with_bar(picture, least, largest, name, words):
    """A picture (height, width, 3) bytes with a bar of the colour map `name` at its right side, from `least`
    to `largest`, with `words` along it."""
    height, width, _ = picture.shape
    figure = Figure(figsize=(round(width / (1.0 - BAR_SHARE)) / DOTS, height / DOTS), dpi=DOTS)
    canvas = FigureCanvasAgg(figure)
    figure.figimage(picture)
    axes = figure.add_axes((1.0 - 0.8 * BAR_SHARE, 0.2, 0.15 * BAR_SHARE, 0.6))
    bar = figure.colorbar(ScalarMappable(Normalize(least, largest), colormaps[name]), cax=axes)
    letters = LETTERS * height * 72 / DOTS
    bar.set_label(words, size=letters)
    bar.ax.tick_params(labelsize=letters)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()
