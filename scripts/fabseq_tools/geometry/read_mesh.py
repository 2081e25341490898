# SPDX-License-Identifier: MIT
"""The triangles of a mesh file as the program reads them. There is one reader: what is measured, cut or moved
here is the surface that was filled with elements."""

import os
import shutil
import tempfile

import numpy as np

from fabseq_tools.run.command_line import RunError, reason_of, run_command, write_json
from fabseq_tools.run.places import find_program

POINT, TRIANGLE = np.dtype("<f8"), np.dtype([("count", "u1"), ("corners", "<i4", 3)])  # of the program's PLY files


def read_mesh(path):
    """Corners of triangles (n, 3, 3) in the file's own coordinates. Raises RunError with the program's line
    for a file that it refuses."""
    program = find_program()
    if shutil.which(program) is None:
        raise RunError(f"{program}: no such program, which reads {path}; FABSEQ_PROGRAM in the environment names another")
    with tempfile.TemporaryDirectory() as folder:
        config = os.path.join(folder, "surface.json")
        write_json(config, {"part": {"mesh": {"file": os.path.abspath(path), "place": "as_is"}}})
        try:
            run_command([program, "-config", config, "-task", "surface", "-output", folder])
        except RunError as error:
            raise RunError(reason_of(error).replace("/part/mesh/file: ", "", 1)) from error
        points, triangles = read_surface(os.path.join(folder, "surface.ply"))
    return points[triangles]


def read_surface(path):
    """Points (n, 3) and triangles (m, 3) of a file that -task surface has written."""
    with open(path, "rb") as file:
        head, _, data = file.read().partition(b"end_header\n")
    counts = [int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element ")]
    points = np.frombuffer(data, POINT, 3 * counts[0]).reshape(-1, 3)
    triangles = np.frombuffer(data, TRIANGLE, counts[1], points.nbytes)["corners"]
    return points, triangles
