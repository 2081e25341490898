# SPDX-License-Identifier: MIT
"""Coarsens a voxel part: mean over blocks of voxels, threshold, largest piece.

Reads dataset `density_grey` (or `density`, where there is none) with axes [z][y][x] from INPUT, takes the
mean over blocks of FACTOR^3 voxels, keeps the blocks at or above THRESHOLD, and of those the largest
face-connected piece. Writes it as dataset `density` (0 or 1, uint8, axes [z][y][x]) to OUTPUT, the form that
`"part": {"voxels": ...}` of a config reads.

    fabseq-tools coarsen configs/parts/topopt_cantilever_40x40x60.h5 \\
        configs/parts/demo_part_20x20x30.h5 2 0.5
"""

import h5py
import numpy as np
from scipy import ndimage

from fabseq_tools.run.command_line import RunError, count, number, parser_of

COMMAND = "coarsen"


def main(words):
    arguments = parse_arguments(words)
    with h5py.File(arguments.input, "r") as file:
        name = arguments.dataset or ("density_grey" if "density_grey" in file else "density")
        if name not in file:
            raise RunError(f"{arguments.input}: no dataset '{name}'")
        grey = file[name][()].astype(float)
        spacing = file["density"].attrs.get("spacing") if "density" in file else None
        origin = str(file.attrs.get("origin", ""))

    part = block_mean(grey, arguments.factor) >= arguments.threshold
    if not part.any():
        raise RunError(f"no block reaches the threshold {arguments.threshold}")
    pieces, _ = ndimage.label(part)
    numbers, sizes = np.unique(pieces[part], return_counts=True)
    density = (pieces == numbers[sizes.argmax()]).astype(np.uint8)

    with h5py.File(arguments.output, "w") as file:
        dataset = file.create_dataset("density", data=density)
        dataset.attrs["order"] = "[z][y][x], x fastest"
        if spacing is not None:
            dataset.attrs["spacing"] = np.asarray(spacing) * arguments.factor
        step = f"mean over {arguments.factor}^3 voxels, threshold {arguments.threshold}, largest piece"
        file.attrs["origin"] = f"{origin}; {step}" if origin else step

    nz, ny, nx = density.shape
    print(f"{arguments.output}: {nx} x {ny} x {nz} voxels, {density.sum()} filled ({density.mean():.3f}), "
          f"{density[0].sum()} on the plate z-, {len(sizes) - 1} smaller pieces dropped "
          f"({part.sum() - sizes.max()} voxels)")


def parse_arguments(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("input", help="HDF5 file of the fine part")
    parser.add_argument("output", help="HDF5 file to write")
    parser.add_argument("factor", type=count, help="voxels an edge of a block; divides every axis")
    parser.add_argument("threshold", type=number("above 0, up to 1", lambda value: 0 < value <= 1),
                        help="least mean density of a filled block, 0 to 1")
    parser.add_argument("--dataset", help="dataset to read (default: density_grey, else density)")
    arguments = parser.parse_args(words)
    return arguments


def block_mean(density, factor):
    """Mean over blocks of factor^3 voxels; every axis must be a multiple of the factor."""
    if any(length % factor for length in density.shape):
        raise RunError(f"the factor {factor} does not divide the shape {density.shape}")
    nz, ny, nx = (length // factor for length in density.shape)
    return density.reshape(nz, factor, ny, factor, nx, factor).mean(axis=(1, 3, 5))
