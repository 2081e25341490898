# SPDX-License-Identifier: MIT
"""What the scripts that draw with Matplotlib share: colours, the look of axes, the picture as a file."""

import os

import matplotlib

from fabseq_tools.run.command_line import parser_of

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


def draw_directory(words, about, command, name, draw, dpi):
    """A command that draws what a directory holds. Its words are the directory, and --picture for another
    file than `name` in there. `draw` makes the figure of a directory."""
    parser = parser_of(about, command)
    parser.add_argument("directory", metavar="OUTPUT_DIR")
    parser.add_argument("--picture", metavar="FILE", help=f"picture to write (default: OUTPUT_DIR/{name})")
    arguments = parser.parse_args(words)
    with plain_text():
        save(draw(arguments.directory), arguments.picture or os.path.join(arguments.directory, name), dpi)
