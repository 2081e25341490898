#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools layers on layers with known areas and volumes, and tetrahedra that are cut."""

import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkTriangleFilter
from vtkmodules.vtkFiltersSources import vtkCylinderSource, vtkSphereSource
from vtkmodules.vtkIOGeometry import vtkSTLReader, vtkSTLWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from fabseq_tools.geometry import export_layers, mesh_inside, tetrahedra
from fabseq_tools.geometry.layer_bodies import LayeredPart

from fake_results import element_centres, node_coordinates
from layered_results import write_layers
from small_meshes import write_box

PROJECT = Path(__file__).resolve().parents[2]


def read(path):
    reader = vtkSTLReader() if path.endswith(".stl") else vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def triangles_of(data):
    """Corners of triangles (n, 3, 3)."""
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    return points[vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)]


def unpaired_edges(corners):
    """Edges that are not there in both directions alike, by the coordinates of their ends: none in a closed
    surface whose triangles all have their outside on the same side."""
    _, numbers = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    a, b, c = numbers.reshape(-1, 3).T
    keys, count = np.unique(np.stack([np.concatenate([a, b, c]), np.concatenate([b, c, a])]), axis=1, return_counts=True)
    there = {tuple(pair): n for pair, n in zip(keys.T, count) if pair[0] != pair[1]}
    return sum(there.get((t, s), 0) != n for (s, t), n in there.items())


def volume_within(corners):
    return np.einsum("ni,ni->", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2]) / 6.0


def cylinder(radius, height, centre):
    source = vtkCylinderSource()  # its axis is y
    source.SetRadius(radius)
    source.SetHeight(height)
    source.SetCenter(centre)
    source.SetResolution(90)
    return source


def write_stl(path, *sources):
    append, triangles, writer = vtkAppendPolyData(), vtkTriangleFilter(), vtkSTLWriter()
    for source in sources:
        append.AddInputConnection(source.GetOutputPort())
    triangles.SetInputConnection(append.GetOutputPort())
    writer.SetInputConnection(triangles.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()


class ExportLayersTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.run_directory, self.output = os.path.join(folder.name, "run"), os.path.join(folder.name, "out")

    def export(self, *formats, **options):
        part = LayeredPart(self.run_directory, **options)
        return export_layers.export(part, self.output, list(formats))

    def file(self, name):
        return read(os.path.join(self.output, name))

    def test_planar_layers_of_a_box(self):
        """Volumes and areas of slices of a box; the box begins elsewhere than at 0."""
        size, counts = (3.0, 2.0, 1.2), (12, 8, 10)
        height = node_coordinates(counts, size)[2] / size[2]
        config = {"domain": {"size": size, "elements": counts, "origin": [1.0, 5.0, -2.0], "unit": "mm"}}
        write_layers(self.run_directory, size, np.ones(counts[::-1], bool), 7, 1.0 - height, config=config)
        record = self.export("stl", "vtp")
        self.assertEqual((record["unit"], record["cut_off_at"]), ("mm", "elements"))
        self.assertEqual(len(record["layers"]), 7)
        for number, row in enumerate(record["layers"], start=1):
            self.assertAlmostEqual(row["volume"], 7.2 / 7, places=9)
            self.assertAlmostEqual(row["area"], 12.0 + 10.0 * 1.2 / 7, places=9)
            self.assertEqual(row["open_edges"], 0)
            np.testing.assert_allclose(row["bounds"], [[1, 5, -2 + 1.2 * (number - 1) / 7], [4, 7, -2 + 1.2 * number / 7]])
        for row in record["interfaces"]:
            self.assertAlmostEqual(row["area"], 6.0, places=9)
        data = self.file("layer_003.vtp").GetPointData()
        np.testing.assert_allclose(vtk_to_numpy(data.GetArray("thickness")), 1.2 / 7)
        np.testing.assert_allclose(vtk_to_numpy(data.GetArray("direction")), np.tile((0, 0, 1), (data.GetNumberOfTuples(), 1)),
                                   atol=1e-12)

    def test_the_last_layer_holds_what_is_later(self):
        """Its thickness at a point reaches to there: 1.5 is the time at the top of the box."""
        size, counts = (3.0, 2.0, 1.2), (6, 4, 10)
        time = 1.5 * node_coordinates(counts, size)[2] / size[2]
        write_layers(self.run_directory, size, np.ones(counts[::-1], bool), 4, 1.0 - time)
        record = self.export("vtp")
        np.testing.assert_allclose([row["volume"] for row in record["layers"]], [1.2] * 3 + [3.6])
        data = self.file("layer_004.vtp").GetPointData()
        times, thickness = (vtk_to_numpy(data.GetArray(name)) for name in ("time", "thickness"))
        np.testing.assert_allclose(thickness, (np.maximum(times, 1.0) - 0.75) / 1.25)
        self.assertAlmostEqual(times.max(), 1.5)

    def test_spherical_layers_of_a_cube(self):
        """Areas of spheres inside, their thickness and normals; bodies closed and oriented, also as STL."""
        counts, size = (20, 20, 20), (1.0, 1.0, 1.0)
        radius = np.sqrt(sum(x**2 for x in node_coordinates(counts, size)))
        write_layers(self.run_directory, size, np.ones(counts, bool), 6, 1.0 - radius / 1.8)
        record = self.export("stl", "vtp")
        self.assertAlmostEqual(record["volume"], 1.0, places=9)
        for row in record["interfaces"][:3]:
            self.assertAlmostEqual(row["area"] / (0.5 * math.pi * (0.3 * row["layer"])**2), 1.0, delta=0.01)
        for row in record["layers"]:
            corners = triangles_of(self.file(row["files"][0]))
            self.assertEqual(unpaired_edges(corners), 0, row["files"][0])
            self.assertAlmostEqual(volume_within(corners), row["volume"], places=6)
        inner = self.file("interface_002.vtp")
        points, arrays = vtk_to_numpy(inner.GetPoints().GetData()), inner.GetPointData()
        normals = points / np.linalg.norm(points, axis=1)[:, None]
        np.testing.assert_allclose(np.einsum("ni,ni->n", normals, vtk_to_numpy(arrays.GetArray("direction"))), 1.0, atol=2e-3)
        np.testing.assert_allclose(vtk_to_numpy(arrays.GetArray("thickness")), 0.3, rtol=0.01)
        np.testing.assert_allclose(vtk_to_numpy(arrays.GetArray("time")), 2 / 6, atol=2e-4)

    def test_neighbours_share_their_interface(self):
        counts, size = (9, 8, 10), (1.0, 1.0, 1.0)
        x, y, z = node_coordinates(counts, size)
        built = element_centres(counts, size)[2] + 0.3 * element_centres(counts, size)[0] < 0.9
        write_layers(self.run_directory, size, built, 5, 1.0 - 0.9 * (0.2 * x + 0.1 * np.sin(5 * y) + z) / 1.4)
        record = self.export("stl")
        shapes = {row["layer"]: {frozenset(map(tuple, t)) for t in triangles_of(self.file(row["files"][0]))}
                  for row in record["layers"]}
        for row in record["interfaces"]:
            between = {frozenset(map(tuple, t)) for t in triangles_of(self.file(row["files"][0]))}
            self.assertEqual(between, shapes[row["layer"]] & shapes[row["layer"] + 1])
        self.assertAlmostEqual(record["volume"] / record["volume_of_elements"], 1.0, delta=1e-3)

    def test_stairs_become_a_slope(self):
        """Below the diagonal of a box: the surface is a plane, and no point leaves it far."""
        counts, size = (20, 6, 20), (2.0, 0.6, 2.0)
        x, _, z = element_centres(counts, size)
        height = node_coordinates(counts, size)[2] / 2.0
        write_layers(self.run_directory, size, z < x, 4, 1.0 - height)
        part = LayeredPart(self.run_directory)
        faces, _, other = part.body.triangles()
        points = part.body.points[np.unique(faces[other == -1])]
        self.assertLess((points[:, 2] - points[:, 0]).max(), 0.1)
        slope = np.abs(points[:, 2] - points[:, 0]) / math.sqrt(2)
        self.assertTrue(np.all(slope[slope < 0.07] < 0.045), slope[slope < 0.07].max())

    def mesh_run(self, path, scale, shift):
        """Two cylinders that overlap, in inches in the file."""
        write_stl(path, cylinder(1.0, 1.0, (0, 0, 0)), cylinder(0.5, 2.0, (0, 0.5, 0)))
        size, counts = (2 * scale, 2 * scale, 2 * scale), (20, 20, 20)
        x, y, z = element_centres(counts, (2, 2, 2))
        built = (np.hypot(x - 1, y - 1) < 1) & ((z < 1) | (np.hypot(x - 1, y - 1) < 0.5))
        height = node_coordinates(counts, (2, 2, 2))[2] / 2
        # The file's y is up: (x, y, z) of the config is (z, x, y) of the file, scaled and moved.
        matrix = np.column_stack([scale * np.eye(3)[:, [1, 2, 0]], shift + scale * np.array([1, 1, 0.5])])
        config = {"domain": {"size": size, "elements": counts, "origin": list(shift), "unit": "mm"},
                  "part": {"mesh": {"file": path}}, "run": {"mesh_placement": matrix.tolist()}}
        write_layers(self.run_directory, size, built, 8, 1.0 - height, config=config)

    def test_an_open_mesh(self):
        """Bodies end in the plane of an open end, however it lies to the elements."""
        tube = cylinder(0.5, 1.5, (0, 0, 0))
        tube.CappingOff()
        path = os.path.join(os.path.dirname(self.run_directory), "tube.stl")
        write_stl(path, tube)
        size, counts = (2.0, 2.0, 2.0), (20, 20, 20)
        matrix = np.array([[math.cos(0.5), math.sin(0.5), 0], [0, 0, -1], [-math.sin(0.5), math.cos(0.5), 0]])
        place = np.stack(element_centres(counts, size), axis=-1) - 1
        along = place @ matrix  # in the file's axes, of which y is the tube's
        built = (np.abs(along[..., 1]) < 0.75) & (np.hypot(along[..., 0], along[..., 2]) < 0.5)
        config = {"domain": {"size": size, "elements": counts}, "part": {"mesh": {"file": path}},
                  "run": {"mesh_placement": np.column_stack([matrix, [1, 1, 1]]).tolist()}}
        write_layers(self.run_directory, size, built, 8, 1.0 - node_coordinates(counts, size)[2] / 2, config=config)
        record = self.export("vtp")
        self.assertAlmostEqual(record["volume"] / (0.25 * 45 * math.sin(2 * math.pi / 90) * 1.5), 1.0, delta=5e-3)
        self.assertLess(record["distance_from_mesh"]["largest"], 0.02)

    def test_a_part_from_a_mesh(self):
        """Volume, sharp edges and the file's own coordinates, where bodies overlap."""
        path = os.path.join(os.path.dirname(self.run_directory), "part.stl")
        self.mesh_run(path, 25.4, np.array([7.0, -3.0, 0.0]))
        record = self.export("vtp", "stl")
        self.assertEqual((record["coordinates"], record["unit"], record["frame"]), ("those of part.stl", "in", "drawing"))
        segment = 0.5 * 90 * math.sin(2 * math.pi / 90)  # of a polygon's area, in place of pi
        self.assertAlmostEqual(record["volume"] / (segment * 1.25), 1.0, delta=2e-3)
        self.assertLess(record["distance_from_mesh"]["largest"], 0.02)  # elements are 0.1 wide
        bounds = np.array([row["bounds"] for row in record["layers"]])
        np.testing.assert_allclose(bounds[:, 0].min(axis=0), [-1, -0.5, -1], atol=1e-3)
        np.testing.assert_allclose(bounds[:, 1].max(axis=0), [1, 1.5, 1], atol=1e-3)
        for row in record["layers"]:
            self.assertEqual(row["open_edges"], 0)
            self.assertEqual(unpaired_edges(triangles_of(self.file(row["files"][1]))), 0)
        arrays = self.file("layer_002.vtp").GetPointData()
        np.testing.assert_allclose(vtk_to_numpy(arrays.GetArray("thickness")), 0.25, rtol=1e-9)
        np.testing.assert_allclose(vtk_to_numpy(arrays.GetArray("direction"))[:, 1], 1.0, rtol=1e-9)

    def test_points_inside_a_mesh(self):
        """Against the solid angle, with overlapping bodies, a cavity, and all inside out."""
        corners = [triangles_of(cut) for cut in self.bodies()]
        corners[2] = corners[2][:, ::-1]  # a cavity
        corners = np.concatenate(corners)
        axes = [np.linspace(-1.1, 1.1, 12), np.linspace(-0.6, 1.6, 13), np.linspace(-1.07, 1.08, 14)]
        grid = np.stack(np.meshgrid(*axes[::-1], indexing="ij")[::-1], axis=-1)
        expected = np.array([abs(winding_number(point, corners)) > 0.5 for point in grid.reshape(-1, 3)])
        for turned in (corners, corners[:, ::-1]):
            found = mesh_inside.inside(turned, axes)
            self.assertLess((found.ravel() != expected).sum(), 3)  # points of the grid on the surface

    @staticmethod
    def bodies():
        ball = vtkSphereSource()
        ball.SetRadius(0.25)
        ball.SetCenter(0.5, 0, 0.3)
        for source in (cylinder(1.0, 1.0, (0, 0, 0)), cylinder(0.5, 2.0, (0, 0.5, 0)), ball):
            triangles = vtkTriangleFilter()
            triangles.SetInputConnection(source.GetOutputPort())
            triangles.Update()
            yield triangles.GetOutput()

    def test_multi_planar_layers(self):
        """Two sub-parts of a box, the upper one in layers along x."""
        counts, size = (12, 6, 12), (1.2, 0.6, 1.2)
        z = element_centres(counts, size)[2] / size[2]
        table = [{"volume": 1.0, "subpart": 1, "slab": slab} for slab in (1, 2, 3)]
        table += [{"volume": 1.0, "subpart": 2, "slab": slab} for slab in (1, 2, 3, 4, 5, 6)]
        config = {"layers": {"type": "multi_planar", "subparts": 2, "timestamps": [0.5], "thickness": 0.2}}
        write_layers(self.run_directory, size, np.ones(counts[::-1], bool), table, time=z, config=config,
                     angles=[[math.pi / 2, 0.0], [0.0, 0.0]])
        record = self.export("vtp")
        volumes = [row["volume"] for row in record["layers"]]
        np.testing.assert_allclose(volumes, [1.2 * 0.6 * 0.2] * 3 + [0.2 * 0.6 * 0.6] * 6, rtol=1e-6)
        self.assertTrue(all(row["open_edges"] == 0 for row in record["layers"]))
        self.assertEqual([row["subpart"] for row in record["layers"]], [1] * 3 + [2] * 6)
        # In a drawing that is in metres, and lying: its x is up.
        drawing = os.path.join(os.path.dirname(self.run_directory), "part.stl")
        write_box(drawing, (1.2e-3, 1.2e-3, 0.6e-3))
        config |= {"domain": {"size": size, "elements": counts, "unit": "mm"}, "part": {"mesh": {"file": drawing}},
                   "run": {"mesh_placement": [[0, 1000, 0, 0], [0, 0, 1000, 0], [1000, 0, 0, 0]]}}
        write_layers(self.run_directory, size, np.ones(counts[::-1], bool), table, time=z, config=config,
                     angles=[[math.pi / 2, 0.0], [0.0, 0.0]])
        record = self.export("vtp")
        self.assertEqual(record["unit"], "m")
        np.testing.assert_allclose(record["layers"][1]["heights"], [2e-4, 4e-4])
        np.testing.assert_allclose(record["interfaces"][1]["height"], 4e-4)
        np.testing.assert_allclose(record["layers"][1]["print_direction"], [1, 0, 0], atol=1e-12)
        np.testing.assert_allclose(record["layers"][4]["print_direction"], [0, 1, 0], atol=1e-12)

    def test_program(self):
        counts, size = (4, 4, 4), (1.0, 1.0, 1.0)
        write_layers(self.run_directory, size, np.ones(counts, bool), 3, 1.0 - node_coordinates(counts, size)[2])
        command = ["/usr/bin/python3", PROJECT / "scripts/fabseq-tools", "layers", self.run_directory, "--format", "stl"]
        done = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        self.assertIn("3 layers, 2 interfaces", done)
        with open(os.path.join(self.run_directory, "layers", "layers.json"), encoding="utf-8") as file:
            self.assertEqual(len(json.load(file)["interfaces"]), 2)
        refused = subprocess.run([*command, "--of", "start"], capture_output=True, text=True, check=False)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("has no start sequence; allowed here: optimized", refused.stderr)
        write_layers(self.run_directory, size[:2], np.ones(counts[:2], bool), 3, 1.0 - node_coordinates(counts[:2], size[:2])[1])
        refused = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertIn("allowed: a run in three", refused.stderr)


class TetrahedraTest(unittest.TestCase):
    def test_cuts_keep_the_volume_and_match(self):
        """Random values, some of them 0: no volume is lost, none is turned, and each side is closed."""
        random = np.random.default_rng(3)
        body = tetrahedra.of_grid([np.arange(6.0)] * 3, np.ones((5, 5, 5), bool))
        for number in range(1, 4):
            values = np.round(random.normal(size=len(body.points)), 1)
            values, _ = body.cut(values)
            body.label += body.side(values) * 10**number
        self.assertAlmostEqual(body.volumes().sum(), 125.0)
        self.assertGreater(body.volumes().min(), 0.0)
        faces, own, _ = body.triangles()
        for label in np.unique(own):
            self.assertEqual(unpaired_edges(body.points[faces[own == label]]), 0)
            self.assertAlmostEqual(volume_within(body.points[faces[own == label]]), body.volumes()[body.label == label].sum())


def winding_number(point, corners):
    """By the solid angles of triangles."""
    a = corners - point
    lengths = np.linalg.norm(a, axis=2)
    above = np.einsum("ni,ni->n", a[:, 0], np.cross(a[:, 1], a[:, 2]))
    below = lengths.prod(axis=1) + sum((a[:, i] * a[:, (i + 1) % 3]).sum(axis=1) * lengths[:, (i + 2) % 3] for i in range(3))
    return np.arctan2(above, below).sum() / (2 * math.pi)


if __name__ == "__main__":
    unittest.main()
