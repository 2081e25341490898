#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How a part grows: planar layers beside the optimized ones of a run, as a moving picture.

    figures/moving_picture.py RUN_DIR PICTURE.gif [--width 840] [--bytes 3000000] [--seconds 6]

Both parts grow at the same pace, and the picture stands still at the end. Material that begins in the air is
red. The picture has as many pixels as fit into the bytes. Without a display it is drawn in memory.
"""

import io

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import run_script

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fabseq_tools.plot.render_part import VoxelPart, layer_colours, render
from fabseq_tools.plot.virtual_display import ensure_display
from fabseq_tools.run.read_run import Run
from small_picture import first_that_fits, parser_of_picture, resized

PIXELS = (1000, 900)      # of a drawn part
CAPTION = 110             # pixels below it
COLOURS = 128
HANGING = (215, 25, 28)
SEQUENCES = (("planar/", "planar layers"), ("", "optimized layers"))
FONT = "DejaVuSans.ttf"   # comes with Matplotlib


def main():
    parser = parser_of_picture(__doc__, "PICTURE.gif", 840, 3000000)
    parser.add_argument("--seconds", type=float, default=6.0, help="until both are done (default: %(default)s)")
    arguments = parser.parse_args()
    run = Run(arguments.directory)
    ensure_display()
    growing = [Growing(run, prefix, name) for prefix, name in SEQUENCES]
    steps = max(part.count for part in growing)
    frames = [Image.fromarray(np.hstack([part.frame((step + 1) / steps) for part in growing])) for step in range(steps)]
    with open(arguments.picture, "wb") as file:
        file.write(compressed(frames, arguments))


class Growing:
    """A sequence of a run, layer by layer."""

    def __init__(self, run, prefix, name):
        self.whole = VoxelPart(run.fields["density"], run.config["domain"]["size"], run.config["build_plate"])
        self.layer = run.fields[prefix + "layer"]
        self.hanging = run.fields[prefix + "hanging"] > 0
        self.count, self.name = int(self.layer.max()), name

    def frame(self, share):
        """The part when this share of the layers is done, with its caption: (height, width, 3) bytes."""
        done = round(share * self.count)
        built = (self.whole.density > 0) & (self.layer <= done)
        part = VoxelPart(built.astype(float), self.whole.size, self.whole.plate)
        colours = layer_colours(part, self.layer, self.count)
        colours[(self.hanging & built).ravel()[part.face_element]] = HANGING
        picture = render(part, face_colours=colours, pixels=PIXELS, frame=self.whole.nodes)
        return np.vstack([picture, self.caption(done, int((self.hanging & built).sum()))])

    def caption(self, done, in_the_air):
        image = Image.new("RGB", (PIXELS[0], CAPTION), "white")
        draw, font = ImageDraw.Draw(image), ImageFont.truetype(font_file(), 34)
        draw.text((PIXELS[0] / 2, 4), f"{self.name}: {done} of {self.count}", fill="black", font=font, anchor="ma")
        draw.text((PIXELS[0] / 2, 52), f"{in_the_air} elements began in the air", font=font, anchor="ma",
                  fill=HANGING if in_the_air else "black")
        return np.asarray(image)


def font_file():
    from matplotlib import get_data_path
    return f"{get_data_path()}/fonts/ttf/{FONT}"


def compressed(frames, arguments):
    """GIF of at most so many bytes."""
    def encodings(width):
        small = [resized(frame, width) for frame in frames]
        palette = small[-1].quantize(COLOURS, dither=Image.Dither.NONE)
        images = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in small]
        pace = round(1000 * arguments.seconds / len(images))
        stream = io.BytesIO()
        images[0].save(stream, "gif", save_all=True, append_images=images[1:], loop=0, optimize=True,
                       duration=[pace] * (len(images) - 1) + [3000])
        yield stream.getvalue()
    return first_that_fits(encodings, arguments.width, arguments.bytes)


if __name__ == "__main__":
    run_script(main)
