#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Meshes come from the program: distances are those from the surface that was filled with elements."""

import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

from fabseq_tools.geometry import read_mesh
from fabseq_tools.geometry.nearest_surface import mesh_surface
from fabseq_tools.run.command_line import RunError

from run_fabseq import PROGRAM
from small_meshes import box_triangles
from three_mf_files import write_prusa_slicer

TOP = 21.8
BLOCK = np.array(list(box_triangles((0, 0, 0), (30, 20, TOP))))
POINTS = np.array([(3, 4, TOP), (27, 17, TOP), (30, 9, 20), (14, 0, 21)])  # of its surface
PLACED = np.array([[0, 0, 2, 1], [2, 0, 0, -3], [0, 2, 0, 5]], float)


class ReadMeshTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.addCleanup(mock.patch.stopall)
        mock.patch.dict(os.environ, FABSEQ_PROGRAM=PROGRAM).start()

    def write(self, name, triangles, form="{:g}", weight=1):
        """Text of STL, or of OBJ with weights, by which coordinates are divided."""
        path, points = os.path.join(self.folder, name), np.reshape(triangles, (-1, 3))
        words = [" ".join(form.format(x) for x in point) for point in points * weight]
        if name.endswith(".obj"):
            lines = [f"v {vertex} {weight}" for vertex in words]
            lines += [f"f {3 * n + 1} {3 * n + 2} {3 * n + 3}" for n in range(len(words) // 3)]
        else:
            lines = ["solid part"]
            for n in range(0, len(words), 3):
                lines += ["facet normal 0 0 0", "outer loop", *("vertex " + vertex for vertex in words[n:n + 3]), "endloop",
                          "endfacet"]
        text = "\n".join([*lines, ""])
        Path(path).write_text(text.replace(".", ",") if "comma" in name else text, encoding="utf-8")
        return path

    def assert_on(self, path, points):
        surface = mesh_surface(path, PLACED)
        places, _, distances = surface.nearest(points @ PLACED[:, :3].T + PLACED[:, 3])
        np.testing.assert_allclose(distances, 0.0, atol=1e-5, err_msg=path)
        np.testing.assert_allclose(places, points @ PLACED[:, :3].T + PLACED[:, 3], atol=1e-5)

    def test_surfaces(self):
        for name, form, weight in (("comma.stl", "{:g}", 1), ("comma_e.stl", "{:.3e}", 1), ("weight.obj", "{:g}", 4),
                                   ("UPPER.STL", "{:g}", 1)):
            self.assert_on(self.write(name, BLOCK, form, weight), POINTS)

    def test_bodies_that_are_inside_out(self):
        """Both are solid: normals of both point outward, as the program turns them."""
        other = np.array(list(box_triangles((20, 0, 0), (50, 20, TOP))))
        corners = read_mesh.read_mesh(self.write("flip.stl", np.concatenate([BLOCK, other[:, ::-1]])))
        volume = np.einsum("ni,ni->", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2]) / 6.0
        self.assertAlmostEqual(volume, 2 * 30 * 20 * TOP, places=1)

    def test_negative_volumes_of_slicers(self):
        path = os.path.join(self.folder, "part.3mf")
        write_prusa_slicer(path, ("ModelPart", BLOCK),
                           ("NegativeVolume", np.array(list(box_triangles((10, 5, -1), (20, 15, 30))))))
        self.assert_on(path, np.concatenate([POINTS, [(10, 7, 3), (20, 9, 15), (13, 15, 10)]]))
        inside = mesh_surface(path, np.eye(3, 4)).nearest(np.array([(15, 10, TOP), (15, 10, 30)]))[2]
        np.testing.assert_allclose(inside, [5, np.hypot(5, 30 - TOP)], rtol=1e-5)

    def test_files_that_the_program_refuses(self):
        path = self.write("part.stl", BLOCK[:1] * np.inf)
        with self.assertRaisesRegex(RunError, r"^'.*part.stl': "):
            mesh_surface(path, PLACED)
        with self.assertRaisesRegex(RunError, r"^'.*none.stl': cannot be opened"):
            mesh_surface(os.path.join(self.folder, "none.stl"), PLACED)

    def test_no_program(self):
        with mock.patch.dict(os.environ, FABSEQ_PROGRAM="/nowhere/fabseq"):
            with self.assertRaisesRegex(RunError, "^/nowhere/fabseq: no such program, which reads part.stl"):
                mesh_surface("part.stl", PLACED)


if __name__ == "__main__":
    unittest.main()
