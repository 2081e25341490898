#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Measured points as scanners and programs of measurement write them: what is read of them, what is left out,
and what is refused."""

import struct
import unittest

import numpy as np

from fabseq_tools.calibration.column_names import Roles
from fabseq_tools.calibration.measured_points import measurement_of, read_measurement
from fabseq_tools.calibration.point_files import read_obj, read_ply, read_stl
from fabseq_tools.calibration.points_frame import PointsFrame, turned_axes
from fabseq_tools.run.command_line import RunError

from tables_test import Folder

POINTS = np.array([[0.5, 1, 2], [3, 4, 5], [6, 7, 8.25]])
NAN, INF = float("nan"), float("inf")


def ply_text(rows, properties=("x", "y", "z"), more=""):
    lines = ["ply", "format ascii 1.0", f"element vertex {len(rows)}", *(f"property float {name}" for name in properties),
             "element face 1", "property list uchar int vertex_indices", "end_header",
             *(" ".join(map(repr, map(float, row))) for row in rows), "3 0 1 2", more]
    return "\n".join(lines).encode()


def ply_binary(rows, order="<", before=b""):
    """With a colour and, before the points, lists."""
    name = {"<": "little", ">": "big"}[order]
    lists = "element tags 2\nproperty list uchar short tag\nproperty char kind\n" if before else ""
    header = (f"ply\r\nformat binary_{name}_endian 1.0\ncomment x y z\n{lists}element vertex {len(rows)}\nproperty uchar red\n"
              "property double x\nproperty float y\nproperty double z\nend_header\n")
    return header.encode() + before + b"".join(struct.pack(order + "Bdfd", 200, *row) for row in rows)


def stl_binary(rows):
    corners = np.resize(np.array(rows, "<f4"), (2, 3, 3))
    return bytes(80) + struct.pack("<I", 2) + b"".join(bytes(12) + its.tobytes() + b"\0\0" for its in corners)


def stl_text(rows):
    return ("solid one\nfacet normal 0 0 1\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in rows)
            + "endloop\nendfacet\nendsolid one\n").encode()


class FilesTest(unittest.TestCase):
    def test_points_of_all_formats(self):
        lists = {order: struct.pack(order + "BhhbBb", 2, 7, 8, 1, 0, 1) for order in "<>"}
        for reader, content in ((read_ply, ply_text(POINTS)), (read_ply, ply_text(POINTS).replace(b"\n", b"\r\n")),
                                (read_ply, ply_binary(POINTS)), (read_ply, ply_binary(POINTS, ">")),
                                (read_ply, ply_binary(POINTS, "<", lists["<"])), (read_ply, ply_binary(POINTS, ">", lists[">"])),
                                (read_obj, b"o a\nv 0.5 1 2\nvn 0 0 1\nv 3 4 5 1.0\nv  6 7 8.25 0.1 0.2 0.3\nf 1 2 3\n"),
                                (read_stl, stl_text(POINTS)), (read_stl, stl_binary(POINTS))):
            found = measurement_of(reader("file", content), 3, "mm")
            np.testing.assert_array_equal(np.unique(found.points, axis=0), POINTS)
            self.assertIsNone(found.displacements)
            np.testing.assert_array_equal(measurement_of(reader("file", content), 2, "mm").points[:1], POINTS[:1, :2])

    def test_displacements_of_a_cloud(self):
        rows = np.hstack([POINTS, 0.1 * POINTS])
        found = measurement_of(read_ply("file", ply_text(rows, ["x", "y", "z", "dx", "dy", "dz"])), 3, "mm")
        np.testing.assert_allclose(found.displacements, 0.1 * POINTS)

    def test_what_is_no_number_is_left_out(self):
        """In every format, also without a word of it in the others."""
        for bad in (NAN, INF, -INF):
            rows = [POINTS[0], [bad, 1, 2], POINTS[1], [1, bad, bad], POINTS[2], [1, 2, bad]]
            obj = "".join(f"v {x} {y} {z}\n" for x, y, z in rows).encode()
            for reader, content, count in ((read_ply, ply_text(rows), 6), (read_ply, ply_binary(rows), 6), (read_obj, obj, 6),
                                           (read_ply, ply_binary(rows, ">"), 6), (read_stl, stl_text(rows), 6),
                                           (read_stl, stl_binary(rows), 6)):
                found = measurement_of(reader("file", content), 3, "mm")
                np.testing.assert_array_equal(found.points, POINTS)
                np.testing.assert_array_equal(found.numbers, [1, 3, 5])
                self.assertEqual(found.remarks, [f"file: 3 of {count} points left out: their positions are no numbers"])
        with self.assertRaisesRegex(RunError, "none of its 1 points can be used: their positions are no numbers"):
            measurement_of(read_ply("file", ply_text([[NAN, NAN, NAN]])), 3, "mm")

    def test_equal_points_and_those_that_were_not_found(self):
        rows = [[0, 0, 0], *POINTS, POINTS[1], [0, -0.0, 0]]
        found = measurement_of(read_ply("file", ply_text(rows)), 3, "mm")
        np.testing.assert_array_equal(found.points, POINTS)
        np.testing.assert_array_equal(found.numbers, [2, 3, 4])
        self.assertEqual([remark.partition("points ")[2] for remark in found.remarks],
                         ["left out: all of their numbers are 0, as of points that were not found",
                          "left out: equal to others, which count once"])
        # A single one is a point.
        self.assertEqual(len(measurement_of(read_ply("file", ply_text([[0, 0, 0], *POINTS])), 3, "mm").points), 4)

    def test_numbers_that_stand_for_nothing(self):
        """Such as programs write where they have none: left out with their count, whatever they are."""
        names = ["x", "y", "z", "dx", "dy", "dz"]
        for value in (-9999.0, 9999.0, 1e30, -32768.0):
            rows = np.hstack([POINTS, 0.01 * POINTS])
            rows[1, 3:] = value
            rows[2, 5] = value
            found = measurement_of(read_ply("file", ply_text(rows, names)), 3, "mm")
            self.assertEqual(len(found.points), 2, value)
            self.assertTrue(np.isnan(found.displacements[1, 2]))
            self.assertRegex(found.remarks[0], "1 of 3 points left out: their displacements are numbers such as -9999")
            rows = POINTS.copy()
            rows[1] = value
            self.assertEqual(len(measurement_of(read_ply("file", ply_text(rows)), 3, "mm").points), 2, value)

    def test_damaged_files(self):
        text, binary = ply_text(POINTS), ply_binary(POINTS)
        for reader, content, words in (
                (read_ply, b"", "no header"), (read_ply, text.partition(b"end_header")[0], "no header"),
                (read_ply, text.partition(b"6.0 7.0")[0], "found 2 of 3 points"), (read_ply, binary[:-1], "found 2 of 3 points"),
                (read_ply, text.replace(b"vertex 3", b"vertex 999999999999999999"), "of 999999999999999999 points"),
                (read_ply, binary.replace(b"vertex 3", b"vertex 999999999999999999"), "found 3 of 9+ points"),
                (read_ply, text.replace(b"vertex 3", b"vertex -3"), "'element vertex -3'"),
                (read_ply, text.replace(b"element vertex", b"element node"), "no element vertex"),
                (read_ply, text.replace(b"float z", b"quad z"), "'property quad z'"),
                (read_ply, text.replace(b"float z", b"float w"), "names no column of z; found: x, y"),
                (read_ply, text.replace(b"float z", b"list uchar int z"), "a list"),
                (read_ply, text.replace(b"ascii", b"zipped"), "'format zipped 1.0'"),
                (read_ply, text.replace(b"8.25", b"8,25"), "as point 3"), (read_ply, text.replace(b" 8.25", b""), "as point 3"),
                (read_ply, ply_binary(POINTS, "<", b"\xff"), "found an end before the points|of 3 points"),
                (read_ply, ply_text([]), "holds no points"), (read_obj, b"f 1 2 3\n", "holds no points"),
                (read_obj, b"v 1 2\n", "'v 1 2' in line 1"), (read_obj, b"v 1 2 a\n", "'v 1 2 a'"),
                (read_stl, stl_binary(POINTS)[:-1], "found 183 bytes"), (read_stl, b"", "found 0 bytes"),
                (read_stl, stl_text(POINTS)[:-20], "within a triangle"),
                (read_stl, stl_text(POINTS).replace(b"vertex 3.0 ", b"vertex "), "within a triangle")):
            with self.assertRaisesRegex(RunError, f"^file: .*({words})") as raised:
                measurement_of(reader("file", content), 3, "mm")
            self.assertNotIn("\n", str(raised.exception))


class TablesTest(Folder):
    def read(self, text, name="table.csv", **more):
        return read_measurement(self.write(text, name), 3, "mm", **more)

    def test_names_of_displacements(self):
        """By whatever usual name: they are displacements, and no scan."""
        expected = [0.25, -0.5, 1.5]
        for names in ("ux,uy,uz", "dx,dy,dz", "DX,DY,DZ", "d_x,d_y,d_z", "U1,U2,U3", "U-U1,U-U2,U-U3", "U_X,U_Y,U_Z",
                      "disp_x,disp_y,disp_z", "displacement:0,displacement:1,displacement:2",
                      "x displacement,y displacement,z displacement", "Dev X,Dev Y,Dev Z",
                      "deviation x,deviation y,deviation z", "x_dev,y_dev,z_dev", "\u0394X,\u0394Y,\u0394Z",
                      "delta x,delta y,delta z", "\u2206x,\u2206y,\u2206z", "diff.x,diff.y,diff.z", "dx_mm,dy_mm,dz_mm",
                      "error x [mm],error y [mm],error z [mm]"):
            found = self.read(f"x,y,z,{names}\n1,2,3,0.25,-0.5,1.5\n")
            np.testing.assert_array_equal(found.displacements, [expected], names)
            np.testing.assert_array_equal(found.points, [[1, 2, 3]], names)
        for names in ("x_nominal,y_nominal,z_nominal,x_actual,y_actual,z_actual", "nom x,nom y,nom z,meas x,meas y,meas z",
                      "x,y,z,x_measured,y_measured,z_measured", "X0,Y0,Z0,X,Y,Z", "Soll X,Soll Y,Soll Z,Ist X,Ist Y,Ist Z"):
            found = self.read(f"{names}\n1,2,3,1.25,1.5,4.5\n")
            np.testing.assert_array_equal(found.displacements, [expected], names)
            np.testing.assert_array_equal(found.points, [[1, 2, 3]], names)
        found = self.read("Points:0,Points:1,Points:2,x_nominal,y_nominal,z_nominal,dev x,dev y,dev z\n9,9,9,1,2,3,8,7,6\n")
        np.testing.assert_array_equal(found.displacements, [[8, 7, 6]])
        found = self.read("x_actual,y_actual,z_actual,dx,dy,dz\n1.25,1.5,4.5,0.25,-0.5,1.5\n")
        np.testing.assert_array_equal(np.hstack([found.points, found.displacements]), [[1, 2, 3, *expected]])

    def test_scans(self):
        expected = [[1, 2, 3], [4, 5.5, 6]]
        for text in ("x,y,z\n1,2,3\n4,5.5,6\n", "x y z\n1 2 3\n 4  5.5   6 \n", "//X Y Z\n1 2 3\n4 5.5 6\n",
                     "//X Y Z R G B\n2\n1 2 3 9 9 9\n4 5.5 6 9 9 9\n", "1 2 3\n4 5.5 6\n", "# x y z\n1 2 3\n4 5.5 6\n",
                     "# a scan of 3\n1;2;3\n4;5,5;6\n", "x\ty\tz\tnx\tny\tnz\n1\t2\t3\t0\t0\t1\n4\t5,5\t6\t0\t0\t1\n",
                     "Points:0,Points:1,Points:2\n1,2,3\n4,5.5,6\n", "x_actual,y_actual,z_actual\n1,2,3\n4,5.5,6\n",
                     "id,X Coord (mm),Y Coord (mm),Z Coord (mm)\n7,1,2,3\n8,4,5.5,6\n"):
            for name in ("scan.csv", "scan.txt", "scan.xyz", "scan.asc"):
                found = self.read(text, name)
                np.testing.assert_array_equal(found.points, expected, text)
                self.assertIsNone(found.displacements)

    def test_units(self):
        for text, more, factor in (("x,y,z\n1,2,3\n", {"own_unit": "m"}, 1000),
                                   ("x [m],y [m],z [m]\n1,2,3\n", {"own_unit": "cm"}, 1000),
                                   ("x_um,y_um,z_um\n1,2,3\n", {}, 1e-3), ("x,y,z\n1,2,3\n", {}, 1)):
            found = self.read(text, **more)
            np.testing.assert_allclose(found.points, factor * np.array([[1, 2, 3]]))
            self.assertEqual(found.has_units, factor != 1)
        with self.assertRaisesRegex(RunError, "--unit: found the unit 'parsec'; allowed: mm"):
            self.read("x,y,z\n1,2,3\n", own_unit="parsec")

    def test_what_is_no_number(self):
        text = "x,y,z,ux,uy,uz\n" + "".join(f"{word},2,3,1,1,1\n1,2,3,{word},1,1\n1,2,4,{word},{word},{word}\n"
                                            for word in ("", "nan", "NaN", "inf", "-inf", "n/a", "#N/A", "null", "-", "1.#QNAN"))
        found = self.read(text)
        np.testing.assert_array_equal(found.displacements, [[NAN, 1, 1]])
        self.assertEqual([remark.partition("csv: ")[2] for remark in found.remarks],
                         ["10 of 30 points left out: their positions are no numbers",
                          "10 of 20 points left out: their displacements are no numbers",
                          "9 of 10 points left out: equal to others, which count once"])

    def test_what_is_refused(self):
        for text, words in (("x,y,z,ux,uy\n1,2,3,1,1\n", r"no column of displacements along z \(uz\); found: ux, uy"),
                            ("x,y,ux,uy,uz\n1,2,1,1,1\n", "no column of z; found: x, y"),
                            ("x,y,z,ux,uy,uz,dx\n1,2,3,1,1,1,1\n", "2 columns of displacements along x .ux.: ux, dx"),
                            ("x,y,z,deviation\n1,2,3,1\n", "'deviation', which may be a displacement, but along no axis"),
                            ("x_nominal,y_nominal,z_nominal\n1,2,3\n", "nominal positions only"),
                            ("ux,uy,uz\n1,2,3\n", "names displacements and no column x, y, z"),
                            ("a,b,c\n1,2,3\n", "names no column x, y, z; found: a, b, c"),
                            ("1 2 3 4\n5 6 7 8\n", "names no column x, y, z"),
                            ("x y z\n1 2\n", "line 2: found 2 cells; allowed: 3"),
                            ("x,y,z\n1,2,3\n1,zwei,3\n", "line 3, column y: found 'zwei'; allowed: a number, or nothing"),
                            ("x,y,z\n1_0,2,3\n", "found '1_0'"), ("x,y,z\n", "holds no points"), ("", "holds no points")):
            with self.assertRaisesRegex(RunError, f"^{self.folder}/table.csv.*{words}"):
                self.read(text)

    def test_names_that_mean_something_else(self):
        for header in (["x", "y", "z", "red", "green", "blue"], ["x", "y", "z", "nx", "ny", "nz", "intensity", "C2M_distances"]):
            roles = Roles("file", header, 3)
            self.assertEqual((roles.points, roles.displacements, roles.unused), (["x", "y", "z"], None, header[3:]))


class FrameTest(unittest.TestCase):
    """A box of 60 x 20 x 20 as a part, with points on its surface."""

    BOX = np.array([[0.0, 0, 0], [60, 20, 10]])

    def setUp(self):
        random = np.random.default_rng(3)
        points = random.uniform(*self.BOX, (400, 3))
        axis = random.integers(0, 3, 400)
        points[np.arange(400), axis] = self.BOX[random.integers(0, 2, 400), axis]
        self.points = points

    def distances(self, points):
        inside = np.minimum(points - self.BOX[0], self.BOX[1] - points).min(1)
        outside = np.linalg.norm(np.maximum(np.maximum(self.BOX[0] - points, points - self.BOX[1]), 0), axis=1)
        return np.where(inside > 0, inside, outside)

    def refuse(self, points, unit="mm", has_units=False):
        PointsFrame(points, self.BOX, self.distances, 2.0, unit).refuse_others("scan.csv", has_units)

    def test_points_of_the_part(self):
        """Also of one face, of a corner, and with mistakes, which are for others to name."""
        face, few = self.points[self.points[:, 2] == 10], self.points.copy()
        few[:20] += 50.0
        for points in (self.points, self.points + 0.5, face, few, self.points[:2], 0.02 * self.points + [30, 10, 0]):
            self.refuse(points)

    def test_units(self):
        for ratio, unit, words in ((1e-3, "mm", "lengths 1000 times theirs would fit, as if they were in m;"),
                                   (0.1, "mm", "lengths 10 times theirs would fit, as if they were in cm;"),
                                   (1e3, "mm", "lengths 0.001 times theirs would fit, as if they were in µm;"),
                                   (1 / 25.4, "mm", "lengths 25.4 times theirs would fit, as if they were in in;"),
                                   (1e3, "m", "lengths 0.001 times theirs would fit, as if they were in mm;"),
                                   (1e-3, None, "lengths 1000 times theirs would fit, as if they were in m;"),
                                   (1e-3, "ells", "lengths 1000 times theirs would fit; allowed")):
            with self.assertRaisesRegex(RunError, "^scan.csv: found points that reach over .*" + words):
                self.refuse(ratio * self.points, unit)
        self.refuse(1e-3 * self.points, has_units=True)
        face = self.points[self.points[:, 2] == 10]
        with self.assertRaisesRegex(RunError, "1000 times"):
            self.refuse(1e-3 * face)

    def test_axes(self):
        for columns, signs, words in (([0, 2, 1], [1, 1, -1], "axes x, -z, y as its x, y, z .y is up."),
                                      ([0, 2, 1], [1, 1, 1], "axes x, z, y as its x, y, z .y is up."),
                                      ([1, 0, 2], [-1, 1, 1], "axes y, -x, z as its x, y, z; allowed")):
            with self.assertRaisesRegex(RunError, f"^scan.csv: found points off the part .* {words}"):
                self.refuse(self.points[:, columns] * signs)
        with self.assertRaisesRegex(RunError, "1000 times theirs .* besides, their axes x, -z, y"):
            self.refuse(1e-3 * self.points[:, [0, 2, 1]] * [1, 1, -1])

    def test_all_axes(self):
        for dimension, count in ((2, 7), (3, 47)):
            ways = turned_axes(dimension)
            self.assertEqual(len({name for name, _ in ways}), count)
            self.assertTrue(all(np.array_equal(matrix @ matrix.T, np.eye(dimension)) for _, matrix in ways))


if __name__ == "__main__":
    unittest.main()
