#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Tables as spreadsheets and other programs write them: what is read, and what is refused with its place."""

import contextlib
import io
import os
import tempfile
import unittest

import h5py
import numpy as np

from fabseq_tools.calibration.measured_points import read_measurement
from fabseq_tools.paths import import_paths
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.tables import read_table

from fake_results import element_centres, node_coordinates
from layered_results import write_layers


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, content, name="table.csv"):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return path


class ReadTest(Folder):
    def test_what_is_read(self):
        semicolon = "X [mm];y [mm];z (mm);Layer\r\n1,5;-,25;2,5e1;3\r\n\r\n# no point\r\n1;2;3;4;\r\n"
        for content in (semicolon, "\ufeff" + semicolon, semicolon.encode("utf-16"), semicolon.encode("utf-16-le"),
                        "sep=;\n" + semicolon, b"\xfe\xff" + semicolon.encode("utf-16-be"), semicolon.replace(";", "\t"),
                        semicolon.replace("\r\n", "\r"), "x,y,z,layer\n1.5,-.25,25,3\n1,2,3,4\n",
                        'x,"y",z,layer,\n"1.5",-.25,25,3,\n1,2,3,4,\n',
                        "x y z layer\n1.5 -.25  25 3\n 1 2 3 4 \n", "  X [mm]  y (mm) z layer\n1,5 -,25 2,5e1 3\n1 2 3 4\n",
                        "//X Y Z Layer\n1.5 -.25 25 3\n1 2 3 4\n", "//X,Y,Z,Layer\n// remark\n1.5,-.25,25,3\n1,2,3,4\n",
                        "//x y z layer\n2\n1.5 -.25 25 3\n1 2 3 4\n", "# made up\n# x y z layer\n1.5 -.25 25 3\n1 2 3 4\n",
                        semicolon.replace("(mm)", "(µm)").encode("cp1252")):
            table = read_table(self.write(content))
            np.testing.assert_array_equal(table.numbers(["x", "y", "z", "layer"]), [[1.5, -0.25, 25, 3], [1, 2, 3, 4]])
        self.assertEqual(table.units, {"x": "mm", "y": "mm", "z": "µm"})

    def test_what_is_refused(self):
        for content, words in ((b"", "holds no points"), ("x,y\n", "holds no points"),
                               (os.urandom(3000) + b"\0\1\n", "is no text"),
                               (b"\x89HDF\r\n\x1a\n\0\0", "is no text"), (b"\xff\xfea", "is no text"),
                               ("x,y\n1,2\n1,2,3\n", "line 3: found 3 cells; allowed: 2"),
                               ("x,y\n1,5,2,5\n", "decimal commas need semicolons or tabs"),
                               ("x;y\n1;1.234,5\n", "line 2, column y: found '1.234,5'; allowed: a finite number"),
                               ("x;y\n1\n", "line 2, column y: found ''"), ("x,y\n1,inf\n", "found 'inf'"),
                               ("x,x,y\n1,2,3\n", "names 2 columns x; allowed: one"),
                               ("x y\n1 2\n1 2 3\n", "line 3: found 3 cells; allowed: 2"),
                               ("x y\n1 2\n1\n", "line 3: found 1 cells; allowed: 2"), ("//X Y\n", "holds no points"),
                               ("x y\n1 zwei\n", "line 2, column y: found 'zwei'"), ("1 2\n3 4\n", "names no column x, y"),
                               ("x,z\n1,2\n", "names no column y; needed: x, y"),
                               ('x,y\n1,"2\n', "line 2: found unexpected end of data; allowed: quotes")):
            with self.assertRaisesRegex(RunError, f"^{self.folder}/table.csv.*{words.replace('(', '.')}"):
                read_table(self.write(content)).numbers(["x", "y"])

    def test_units_of_measurements(self):
        path = self.write("x [cm];y [cm];ux [µm];uy\n1;2;300;0,5\n1;2;;0,5\n")
        measured = read_measurement(path, 2, "mm")
        np.testing.assert_allclose(measured.points, [[10, 20]] * 2)
        np.testing.assert_allclose(measured.displacements, [[0.3, 0.5], [np.nan, 0.5]])
        with self.assertRaisesRegex(RunError, "column x: found the unit 'cm'; allowed: none, as the config's is not known"):
            read_measurement(path, 2, "furlong")
        with self.assertRaisesRegex(RunError, "column x: found the unit 'parsec'; allowed: mm, "):
            read_measurement(self.write("x [parsec],y\n1,2\n"), 2, "mm")


class ImportTest(Folder):
    """A box of 40 x 20 x 8 mm in four planar layers, drawn lying in metres or as it stands."""

    COUNTS, SIZE = (20, 10, 8), (40.0, 20.0, 8.0)

    def run_of(self, scale=1.0):
        folder = os.path.join(self.folder, "run")
        z = node_coordinates(self.COUNTS, self.SIZE)[2] / self.SIZE[2]
        self.number = np.ceil(element_centres(self.COUNTS, self.SIZE)[2] / 2 - 1e-9)
        config = {"domain": {"size": self.SIZE, "elements": self.COUNTS, "unit": "mm"},
                  "run": {"mesh_placement": (scale * np.eye(3, 4)).tolist()}}
        return write_layers(folder, self.SIZE, np.ones(self.COUNTS[::-1], bool), 4, 1.0 - z, config=config, layer=self.number)

    def table(self, at, factor=1.0, header="x,y,z,layer", layers=(1, 2, 3, 4)):
        rows = [f"{factor * x:.9g},{factor * y:.9g},{factor * 2 * (n - 1 + at):.9g},{n}"
                for n in layers for y in range(1, 20, 3) for x in range(1, 40, 3)]
        return self.write("\n".join([header, *rows, ""]), "way points.csv")

    def run_import(self, path, *words):
        printed, said = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(said):
            import_paths.main([path, os.path.join(self.folder, "run"), *words])
        with h5py.File(os.path.join(self.folder, "way points_sequence.h5")) as file:
            share = (file["layer"][()] == self.number).mean()
        return share, printed.getvalue(), said.getvalue()

    def test_at(self):
        """Without columns of axis and height; where it is not said, it is noticed."""
        self.run_of()
        for at, share in ((0.5, 1.0), (1.0, 1.0), (0.0, 1.0)):
            found, printed, said = self.run_import(self.table(at), "--at", str(at))
            self.assertGreaterEqual(found, share, at)
            self.assertEqual(said, "")
        self.assertIn(f"-sequence '{self.folder}/way points_sequence.h5'", printed)
        for at, words in ((1.0, "at the top of the beads; --at 1"), (0.0, "at the bottom of the beads; --at 0")):
            found, _, said = self.run_import(self.table(at))
            self.assertLess(found, 0.99)
            self.assertIn(words, said)
        with self.assertRaisesRegex(RunError, "--at: found 1; allowed: 0.5 where there is one layer"):
            self.run_import(self.table(1.0, layers=(1,)), "--at", "1")

    def test_units(self):
        self.run_of()
        for factor, unit in ((1e-3, "m"), (1e3, "um"), (1 / 25.4, "in")):
            header = f"x [{unit}],y [{unit}],z [{unit}],layer"
            self.assertEqual(self.run_import(self.table(0.5, factor, header))[0], 1.0)
        for factor, words in ((1e3, "about 1000 times as far as the box, as in another unit"),
                              (1e-3, "about 1000 times as little")):
            with self.assertRaisesRegex(RunError, words):
                self.run_import(self.table(0.5, factor))
        self.run_of(1030.0)  # drawn in metres, 3 % larger than built
        self.assertEqual(self.run_import(self.table(0.5, 1 / 1.03, "x [mm],y [mm],z [mm],layer"))[0], 1.0)

    def test_blanks_between_cells(self):
        self.run_of()
        path = self.table(0.5)
        with open(path, encoding="utf-8") as file:
            text = file.read().replace(",", "  ")
        for header in ("x  y  z  layer", "//X Y Z Layer"):
            self.assertEqual(self.run_import(self.write(text.replace("x  y  z  layer", header), "way points.csv"))[0], 1.0)

    def test_half_a_layer(self):
        self.run_of()
        with self.assertRaisesRegex(RunError, "line 3, column layer: found '1.5'; allowed: a whole number"):
            self.run_import(self.write("x,y,z,layer\n1,1,1,1\n1,1,2,1.5\n", "way points.csv"))


if __name__ == "__main__":
    unittest.main()
