# SPDX-License-Identifier: MIT
"""What a picture shows, judged by its pixels."""

from matplotlib import image


def drawn(path, rows=1, columns=1, inner=(0.08, 0.92, 0.2, 0.95)):
    """Shares of the pixels that are coloured or nearly black, in the inner part of each of `rows` times
    `columns` equal panels, line by line: frames and labels lie outside, grids are pale, so that empty axes
    come to next to nothing.

    inner: top, bottom, left and right of the inner part, relative to the panel.
    """
    pixels = image.imread(path)[..., :3]
    height, width = pixels.shape[0] / rows, pixels.shape[1] / columns
    shares = []
    for row in range(rows):
        for column in range(columns):
            top, bottom = (int((row + part) * height) for part in inner[:2])
            left, right = (int((column + part) * width) for part in inner[2:])
            panel = pixels[top:bottom, left:right]
            marked = (panel.max(axis=-1) - panel.min(axis=-1) > 0.25) | (panel.max(axis=-1) < 0.35)
            shares.append(float(marked.mean()))
    return shares


def filled(path, top=0.0, bottom=1.0, columns=1):
    """Shares of pixels that are not white in `columns` equal columns of the picture between two heights."""
    pixels = image.imread(path)[..., :3]
    band = pixels[int(top * len(pixels)):int(bottom * len(pixels))].min(axis=-1) < 0.95
    edges = [round(k * band.shape[1] / columns) for k in range(columns + 1)]
    return [float(band[:, left:right].mean()) for left, right in zip(edges, edges[1:])]


def coloured(path, top=0.0, bottom=1.0, columns=1):
    """Shares of clearly coloured pixels in `columns` equal columns of the picture between two heights."""
    pixels = image.imread(path)[..., :3]
    band = pixels[int(top * len(pixels)):int(bottom * len(pixels))]
    clear = band.max(axis=-1) - band.min(axis=-1) > 0.25
    edges = [round(k * clear.shape[1] / columns) for k in range(columns + 1)]
    return [float(clear[:, left:right].mean()) for left, right in zip(edges, edges[1:])]
