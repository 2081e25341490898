# SPDX-License-Identifier: MIT
"""What the scripts that draw with Matplotlib share: colours, the look of axes, the picture as a file."""

import matplotlib

INK, SOFT_INK, GRID, ALLOWED = "#22262b", "#6b727b", "#e6e8eb", "#e3f0ea"
OPTIMIZED, PLANAR = "#1f6f8b", "#b0762b"


def tidy(axes):
    """A pale grid behind the curves, no frame at top and right."""
    for axis in axes:
        axis.grid(color=GRID)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)


def plain_text():
    """Within a with statement, texts are drawn as they stand, and SVG pictures hold them as texts. The latter
    have the same bytes each time."""
    return matplotlib.rc_context({"text.parse_math": False, "svg.fonttype": "none", "svg.hashsalt": "fabseq"})


def save(figure, path, dpi):
    figure.savefig(path, dpi=dpi, metadata={"Date": None} if str(path).endswith(".svg") else None)
    print(path)
