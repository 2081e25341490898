#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A small picture of a finished optimization: layers and distorted shape, the best alternative beside
optimized.

    figures/small_picture.py RUN_DIR PICTURE.png [--width 960] [--bytes 80000]

Left to right: layers of the best alternative, optimized layers, and the distorted shapes of both, drawn as by
`fabseq-tools overview`. The picture has as many colours and pixels as fit into the bytes. Without a display
it is drawn in memory.
"""

import io

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import parser_of, run_script

import numpy as np
from PIL import Image

from fabseq_tools.plot import overview
from fabseq_tools.run.read_run import Run
from fabseq_tools.plot.virtual_display import ensure_display

COLOURS = (64, 32, 16)
GAP = 12  # pixels of the drawn pictures between two of them


def main():
    arguments = parser_of_picture(__doc__, "PICTURE.png", 960, 80000).parse_args()
    run = Run(arguments.directory)
    ensure_display()
    images = of_one_height([image for pictures in overview.pictures_of(run) for image in pictures.images])
    gap = np.full((images[0].shape[0], GAP, 3), 255, np.uint8)
    side_by_side = np.hstack([piece for image in images for piece in (image, gap)][:-1])
    with open(arguments.picture, "wb") as file:
        file.write(compressed(side_by_side, arguments.width, arguments.bytes))


def of_one_height(images):
    """Scaled to the lowest of them."""
    height = min(image.shape[0] for image in images)
    return [np.asarray(resized(Image.fromarray(image), round(image.shape[1] * height / image.shape[0]), height))
            for image in images]


def parser_of_picture(documentation, picture, width, most_bytes):
    """The words of a script that draws a run into a file of limited size."""
    parser = parser_of(documentation)
    parser.add_argument("directory", metavar="RUN_DIR")
    parser.add_argument("picture", metavar=picture)
    parser.add_argument("--width", type=int, default=width, help="pixels (default: %(default)s)")
    parser.add_argument("--bytes", type=int, default=most_bytes, help="size of the file at most (default: %(default)s)")
    return parser


def compressed(image, width, most_bytes):
    """PNG of at most so many bytes: first with fewer colours, then with fewer pixels."""
    whole = Image.fromarray(np.ascontiguousarray(image))

    def encodings(of_width):
        small = resized(whole, of_width)
        for colours in COLOURS:
            stream = io.BytesIO()
            small.quantize(colours, dither=Image.Dither.NONE).save(stream, "png", optimize=True)
            yield stream.getvalue()
    return first_that_fits(encodings, width, most_bytes)


def resized(image, width, height=None):
    """`height`: by default as the width is."""
    return image.resize((width, height or max(1, round(width * image.height / image.width))), Image.Resampling.LANCZOS)


def first_that_fits(encodings, width, most_bytes):
    """The first of encodings(width) of at most so many bytes; with ever smaller widths, if none is."""
    while True:
        for encoded in encodings(width):
            if len(encoded) <= most_bytes or width < 64:
                return encoded
        width = int(0.85 * width)


if __name__ == "__main__":
    run_script(main)
