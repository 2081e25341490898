# SPDX-License-Identifier: MIT
"""fabseq-tools compensate moves a part against its displacement: what remains falls."""

import csv
import json
import os

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOGeometry import vtkSTLReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

import run_fabseq
from mesh_test import HIGH, LOW, bar, box_triangles, stl_text
from read_outputs import read_result
from run_fabseq import FabseqTest
from small_parts import hook_3d, plate_2d, post_on_substrate

COMMAND = "compensate"


class CompensateTest(FabseqTest):
    def setUp(self):
        super().setUp()
        with open(os.path.join(self.directory, "bar.stl"), "w", encoding="utf-8") as file:
            file.write(stl_text(box_triangles(LOW, HIGH)))

    def compensate(self, run, *words):
        """The content of compensation.json."""
        done = self.run_tool(COMMAND, run.output, *words)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with open(run.path("compensated/compensation.json"), encoding="utf-8") as file:
            record = json.load(file)
        with open(run.path("compensated/compensation.csv"), encoding="utf-8", newline="") as file:
            self.assertEqual([{key: float(cell) for key, cell in row.items()} for row in csv.DictReader(file)], record["rounds"])
        self.assertIn(f"round {record['best_round']}; its coordinates", done.stdout.splitlines()[-1])
        return record

    def points(self, run):
        """Points of the compensated mesh, how they were moved, and what remains; the STL file is closed."""
        readers = vtkXMLPolyDataReader(), vtkSTLReader()
        for reader, form in zip(readers, ("vtp", "stl")):
            reader.SetFileName(run.path(f"compensated/compensated.{form}"))
            reader.Update()
        mesh, data = (reader.GetOutput() for reader in readers)
        triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        edges = np.sort(np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
        self.assertTrue(np.all(np.unique(edges, axis=0, return_counts=True)[1] == 2))
        points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
        corners = vtk_to_numpy(data.GetPoints().GetData())
        for end in (np.min, np.max):
            np.testing.assert_allclose(end(corners, axis=0), end(points, axis=0), atol=1e-5)
        moved_by, remains = (vtk_to_numpy(mesh.GetPointData().GetArray(name)) for name in ("moved_by", "remains"))
        return points, moved_by, remains

    def test_what_shrinks_freely(self):
        """One layer that is released shrinks as a whole, around the middle of its foot. In the file the bar
        is in inches, and its y is up on the plate."""
        config = bar(scale=25.4, rotate=[["x", 90]])
        config["domain"] = {"element": 63.5, "unit": "mm"}
        config["layers"] = {"count": 1}
        config["material"] = {"inherent_strain": [-0.01, -0.02, -0.03, 0, 0, 0]}
        config["objective"][0]["after_release"] = True
        run = self.simulate(config)
        record = self.compensate(run, "--iterations", 2, "--finer-check", "--", "-tolerance", "1e-10")
        self.assertEqual([record[key] for key in ("state", "unit", "mesh", "coordinates", "best_round")],
                         ["after the release", "mm", "mesh", "those of bar.stl", 2])
        lengths = [row["rms"] for row in record["rounds"]]
        self.assertLess(lengths[1], 0.04 * lengths[0])
        self.assertLess(lengths[2], 0.04 * lengths[1])
        self.assertEqual([row["round"] for row in record["finer_grid"]], [0, 2])
        np.testing.assert_allclose(record["finer_grid"][0]["rms"], lengths[0], rtol=1e-6)  # no matter how fine
        self.assertLess(record["finer_grid"][1]["rms"], 1e-3 * lengths[0])
        points, moved_by, remains = self.points(run)
        drawn, foot = points - moved_by, np.array([0.5 * (LOW + HIGH)[0], LOW[1], 0.5 * (LOW + HIGH)[2]])
        np.testing.assert_allclose([drawn.min(axis=0), drawn.max(axis=0)], [LOW, HIGH], atol=1e-5)
        strain = np.array([0.01, 0.03, 0.02])  # of the file's axes
        np.testing.assert_allclose(points, foot + (drawn - foot) / (1 - strain), atol=1e-3)
        self.assertAlmostEqual(np.linalg.norm(remains, axis=1).max() * 25.4, record["rounds"][2]["largest"], places=5)
        self.assertLess(np.linalg.norm(remains, axis=1).max(), 1e-3)
        self.assertGreater(len(points), 2 * (60 * 20 + 20 * 10 + 60 * 10) / 2.5**2)  # edges of an element, at most

    def test_bar_as_built(self):
        """Several layers on the plate. Round 0 is the run itself, and all rounds have its grid."""
        run = self.simulate(bar())
        record = self.compensate(run, "--as-built", "--ranks", 2, "--fill", "grey", "--output", run.path("compensated"))
        first, *_, last = [row["rms"] for row in record["rounds"]]
        self.assertLess(last, 0.1 * first)
        self.assertEqual(record["rounds"][0]["elements_differ"], 0)
        self.assertGreater(record["rounds"][0]["rms_fitted"], record["rounds"][-1]["rms_fitted"])
        self.assertLess(record["rounds"][-1]["rms_at_plate"], 1e-6)
        own, field = (read_result(run)["displacement"], self.field(run, "round_0", "displacement"))
        np.testing.assert_allclose(field[:5, 1:-1, 1:-1], own, atol=1e-5 * np.abs(own).max())
        np.testing.assert_array_equal(self.field(run, "round_0", "layer")[:4, 1:-1, 1:-1], read_result(run)["layer"])

    def test_layers_that_a_constraint_counts(self):
        """All rounds have as many layers as the run, though they have no constraints that say so; a sharpness
        below that of so many layers means nothing to binary ones."""
        config = bar()
        config |= {"layers": {"count": "auto"}, "constraints": [{"type": "layer_thickness", "target": 2}],
                   "projection": {"max": 8}}
        run = self.simulate(config)
        self.assertEqual(run.json("config.json")["layers"]["count"], "auto")
        record = self.compensate(run, "--iterations", 1, "--finer-check")
        self.assertEqual(record["rounds"][0]["elements_differ"], 0)
        for folder in ("round_0", "round_1", "finer_1"):
            self.assertEqual(len(run.json(f"compensated/{folder}/summary.json")["layers"]), 5)
        np.testing.assert_array_equal(self.field(run, "round_0", "layer")[:4, 1:-1, 1:-1], read_result(run)["layer"])

    def test_sub_parts(self):
        """The planes of a hook in two sub-parts stay where they are, although the box grows: the first round,
        which nothing has moved, has the run's own layers, of two beads each."""
        config = hook_3d()
        config["layers"] = {"type": "multi_planar", "subparts": 2, "thickness": 0.25, "passes": 2,
                            "angles": [[1.5, 0.0], [1.0, 0.3]], "angle_bounds": [0, 1.5708]}
        config["constraints"], config["objective"] = [], config["objective"][:1]
        run = self.simulate(config)
        record = self.compensate(run, "--iterations", 2)
        self.assertEqual(record["rounds"][0]["elements_differ"], 0)
        own, first = read_result(run), self.field(run, "round_0", "layer")
        room = np.subtract(first.shape, own["layer"].shape)
        self.assertTrue(room.any())
        self.assertEqual(*(len(np.unique(layer)) for layer in (first, own["layer"])))
        moved = self.field(run, "round_0", "density") > 0
        np.testing.assert_array_equal(first[moved], own["layer"][own["density"] > 0])
        self.assertLess(record["rounds"][-1]["rms"], 0.5 * record["rounds"][0]["rms"])

    @staticmethod
    def field(run, folder, name):
        with h5py.File(run.path(f"compensated/{folder}/result.h5"), "r") as file:
            return file[name][:]

    def test_parts_without_mesh(self):
        """A hook of shapes, and a post on a substrate, the height of whose foot stays."""
        record = self.compensate(run := self.simulate(hook_3d()))
        self.assertEqual([record[key] for key in ("mesh", "state", "coordinates")],
                         ["elements", "as built", "those of the config"])
        self.assertLess(record["rounds"][-1]["rms"], 0.3 * record["rounds"][0]["rms"])
        self.points(run)
        post = post_on_substrate()
        post["material"] = {"inherent_strain": [-0.01, -0.01, -0.01, 0, 0, 0]}
        record = self.compensate(run := self.simulate(post), "--tolerance", 1)
        self.assertEqual((len(record["rounds"]), record["state"]), (1, "after the release"))
        record = self.compensate(run, "--iterations", 2)
        self.assertLess(record["rounds"][-1]["rms"], 0.3 * record["rounds"][0]["rms"])
        points, moved_by, _ = self.points(run)
        foot = (points - moved_by)[:, 2] < 0.35
        self.assertTrue(foot.any())
        self.assertEqual(np.abs(moved_by[foot, 2]).max(), 0)
        self.assertGreater(np.abs(moved_by[~foot, 2]).max(), 0)

    def test_errors(self):
        turning, straight = post_on_substrate(), self.simulate(bar()).output
        wall = plate_2d()
        for words, expected in (([self.simulate(turning).output], "/material/inherent_strain turns"),
                                ([self.simulate(wall).output], "allowed: a run in three"),
                                ([self.directory], "config.json is missing"),
                                ([straight, "--factor", 0], "--factor: found 0; allowed: above 0"),
                                ([straight, "--iterations", 0], "--iterations: found 0"),
                                ([straight, "--tolerance", -1], "--tolerance: found -1"),
                                ([straight, "--fill", "black"], "--fill: found black"),
                                ([straight, "--fill", 2], "--fill: found 2; allowed: a share above 0"),
                                ([straight, "--program", "nothing"], "nothing: no such program")):
            done = self.run_tool(COMMAND, *words)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertTrue(done.stderr.startswith("fabseq-tools compensate: "), done.stderr)
            self.assertIn(expected, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)


if __name__ == "__main__":
    run_fabseq.main()
