#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Elements, own nodes and the linear model of the study with heat and plastic flow
(benchmarks/evidence/figures/with_heat.py); CalculiX itself is not run."""

import contextlib
import io
import os
import tempfile
import unittest
from types import SimpleNamespace
from unittest import mock

import h5py
import numpy as np

from fabseq_tools.geometry.grid import node_positions
from heat_and_plasticity import mechanics, own_cooling, steel
from heat_and_plasticity.bricks import Bricks
from heat_and_plasticity.compared import BRICKS, FLOW, FLOWS, LINEAR, REFINED, best_gain, compared, gain
from heat_and_plasticity.finer import at_coarse_nodes, finer_settings
from heat_and_plasticity.mechanics import OwnNodes
from heat_and_plasticity.tables import print_factor_tables, print_tables

SIZE, COUNTS = [4.0, 2.0, 6.0], [2, 1, 3]


def column():
    """A plate of two elements, and on the left of it two layers of an element each."""
    layer = np.array([[[0, 0]], [[1, 0]], [[2, 0]]])
    solid = (layer > 0) | (np.arange(3)[:, None, None] == 0)
    positions = node_positions(SIZE, COUNTS)
    model = SimpleNamespace(positions=positions, solid=solid, layer=layer, size=SIZE, counts=COUNTS,
                            config={"domain": {"size": SIZE, "unit": "mm", "elements": COUNTS}},
                            supports=np.flatnonzero(positions[:, 2] == 0))
    with mock.patch("heat_and_plasticity.bricks.LayerModel", return_value=model):
        return Bricks("")


class HeatAndPlasticityTest(unittest.TestCase):
    def test_faces_in_the_air(self):
        """Sides, and tops of the plate but where the part stands; not its lower face."""
        bricks = column()
        faces = [list(bricks.open_faces(layer)) for layer in (0, 1, 2)]
        self.assertEqual([len(of) for of in faces], [8, 12, 16])
        self.assertNotIn((0, 1), faces[2])
        self.assertIn((0, 2), faces[0])
        self.assertNotIn((0, 2), faces[1])

    def test_layers_have_nodes_of_their_own(self):
        bricks = column()
        own = OwnNodes(bricks)
        self.assertEqual(len(own.tied), 8)  # four below each layer
        self.assertTrue(np.all(own.layer[own.corners] == bricks.layer[:, None]))
        np.testing.assert_array_equal(own.of[own.corners], bricks.corners)

    def test_an_even_cooling_of_a_free_cube(self):
        """Its forces are those that shrink it by the free strain, and rigid motions take none."""
        stiffness, force = own_cooling.cube(2.0)
        points = own_cooling.CORNERS
        np.testing.assert_allclose(stiffness @ points.ravel(), force, atol=1e-12)
        self.assertEqual(np.linalg.matrix_rank(stiffness), 18)

    def test_a_part_without_heat_shrinks_from_the_solidus(self):
        """The last layer's top is free to follow its strain, and a part that is let go has no forces."""
        bricks = column()
        cold = np.full((2, 1, len(bricks.positions)), 20.0)
        moved = own_cooling.displacements(bricks, cold, 20.0)
        shrinkage = own_cooling.EXPANSION * (steel.SOLIDUS - 20.0)
        top, below = (moved[bricks.corners[bricks.layer == 2][0]][where, 2].mean() for where in (slice(4, 8), slice(0, 4)))
        self.assertLess(top, 0.0)
        self.assertLess(abs(top) / (2.0 * shrinkage), 2.0)
        self.assertLess(below, 0.0)

    def test_curves_of_steel(self):
        self.assertAlmostEqual(steel.conductivity(400), 0.04068)
        self.assertAlmostEqual(steel.heat_capacity(400), 605.88, places=2)
        self.assertAlmostEqual(steel.elongation(20), 0.0, places=6)
        self.assertAlmostEqual(steel.elongation(860), 0.011, places=3)

    def test_steel_of_the_model_with_flow(self):
        """The curves of CalculiX's deck: between 20 °C and the solidus its numbers are the deck's."""
        material = steel.flow_material()
        temperatures = material["temperatures"]
        self.assertEqual(temperatures, sorted(set(temperatures)))
        self.assertLess(material["cut_off"], steel.SOLIDUS)
        self.assertGreater(temperatures[-1], steel.SOLIDUS)
        for t, strength, stiffness in steel.REDUCTION:
            place = temperatures.index(t)
            self.assertEqual(material["yield_factors"][place], max(strength, steel.FLOOR))
            self.assertEqual(material["young_factors"][place], max(stiffness, steel.FLOOR))
            self.assertAlmostEqual(material["elongations"][place], steel.elongation(t))
        for t in (50, 800, 950, 1150, 1400):  # no bend of a curve is left out
            self.assertAlmostEqual(np.interp(t, temperatures, material["elongations"]), steel.elongation(t), delta=3e-5)
        for key, curve in (("conductivity", steel.conductivity), ("heat_capacity", steel.heat_capacity)):
            for t in (50, 650, 735, 1100, 1500):
                ours = material[key] * np.interp(t, temperatures, material[key + "_factors"])
                self.assertAlmostEqual(ours, np.interp(t, steel.HEAT_POINTS, [curve(point) for point in steel.HEAT_POINTS]))

    def test_types_of_brick(self):
        """Differ in nothing else but their name."""
        bricks = column()
        bricks.supports = np.arange(6)
        cold = np.full((2, 1, len(bricks.positions)), 20.0)
        decks = {kind: "\n".join(mechanics.deck_lines(bricks, cold, 20.0, kind)) for kind in BRICKS}
        self.assertEqual(decks["C3D8I"].count("TYPE=C3D8I,"), 3)  # plate and two layers
        self.assertEqual(decks["C3D8I"].replace("C3D8I", "C3D8"), decks["C3D8"])

    def test_layers_on_a_finer_grid(self):
        """Each element is eight of its layer, and every second node is one of the coarse grid's."""
        bricks = column()
        with tempfile.TemporaryDirectory() as directory:
            path = os.path.join(directory, "layers.h5")
            settings = finer_settings(bricks, path)
            with h5py.File(path) as file:
                time, density = file["time"][()], file["density"][()]
        self.assertEqual(settings["domain"], {"size": SIZE, "unit": "mm", "elements": [4, 2, 6]})
        self.assertEqual(time.shape, (6, 2, 4))
        np.testing.assert_array_equal(np.ceil(2 * time[2:, :, :2]), np.repeat([1, 2], 8).reshape(4, 2, 2))
        self.assertEqual(density.sum(), 16)
        self.assertEqual(density[2:, :, :2].sum(), 16)
        fine = node_positions(SIZE, settings["domain"]["elements"])
        np.testing.assert_allclose(at_coarse_nodes(fine, bricks.grid.shape), bricks.positions)

    def test_errors_and_factors(self):
        """Linear models get one factor, of the planar case; the one with flow gets none."""
        unit = np.zeros((4, 3))
        unit[:, 2] = 1.0
        fields = {sequence: {"C3D8I": theirs * unit, "C3D8": 0.9 * theirs * unit,
                             **{model: unit for model in (*FLOWS, *LINEAR)}, FLOW: 0.8 * theirs * unit}
                  for sequence, theirs in (("planar", 2.0), ("tilted", 1.0))}
        found = compared(fields)
        self.assertAlmostEqual(found["tilted"][FLOW]["C3D8I"]["error"], 0.2)
        self.assertAlmostEqual(found["tilted"][FLOW]["C3D8"]["error"], 1.0 / 9.0)
        self.assertAlmostEqual(found["tilted"]["C3D8"]["difference"]["C3D8I"], 0.1)
        self.assertAlmostEqual(found["planar"]["constant"]["C3D8I"]["error"], 0.0)
        self.assertAlmostEqual(found["tilted"]["constant"]["C3D8"]["scale"], 1.8)
        self.assertAlmostEqual(found["tilted"]["constant"]["C3D8I"]["error"], 1.0)

    def test_error_bar_of_a_gain(self):
        """Is the larger of what the type of brick and, where they were refined, finer elements change."""
        planar = {kind: {"rms": 2.0} for kind in (*BRICKS, *REFINED.values())}
        row = {"C3D8I": {"rms": 1.0}, "C3D8": {"rms": 1.25}}
        np.testing.assert_allclose(best_gain(row, planar), (2.0, 0.4))
        row["C3D8I refined"] = {"rms": 0.8}
        np.testing.assert_allclose(best_gain(row, planar), (2.5, 0.5))
        row["C3D8 refined"] = {"rms": 1.0}
        np.testing.assert_allclose(best_gain(row, planar), (2.5, 0.5))
        row["C3D8I"] = {"rms": 0.8}
        np.testing.assert_allclose(best_gain(row, planar), (2.5, 0.5))
        self.assertIsNone(gain(row, {"C3D8I": {"rms": 2.0}}, "C3D8 refined"))

    def test_tables(self):
        """Have as many cells in each row as in the head, and no gain of the planar case. Refined bricks, and
        what is held against them, stand where they are there."""
        unit = np.ones((4, 3))
        scales = {"planar": 2.0, "tilted": 1.0, "optimized": 0.5}
        fields = {sequence: {name: scale * unit for name in (*BRICKS, *FLOWS, *LINEAR)} for sequence, scale in scales.items()}
        for sequence in ("planar", "tilted"):
            fields[sequence]["C3D8I refined"] = 1.1 * scales[sequence] * unit
        fields["planar"]["C3D8 refined"] = 2.0 * unit
        found = compared(fields)
        for row in found.values():
            row |= {"layers": 2, "interpass": {"ccx": [300.0], "fabseq": [310.0]}}
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            print_tables({"wall": found})
        tables = self.tables(printed.getvalue(), [5, 4, 4, 4, 4, 5, 5])
        self.assertIn("| wall, planar | 9 (0) |", tables[2][2])
        self.assertIn("| wall, tilted | 9 |", tables[2][3])
        self.assertIn("| wall, tilted | 2.00 ± 0.00 | 2.00 |", tables[3][2])
        self.assertIn("| +0 %, within the bar |", tables[4][3])

    def test_tables_of_factors(self):
        """A factor for each part and kind, and errors for each sequence."""
        records = {kind: {"factor": factor, "left_before": 0.26, "left_of_measurement": left}
                   for kind, factor, left in (("elongation", 1.25, 0.19), ("yield", 1.5, 0.23))}
        errors = {"planar": {"none": 0.26, "elongation, own": 0.19}, "tilted": {"none": 0.2, "elongation, own": 0.3}}
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            print_factor_tables({"factors": {"wall": records}, "errors": {"wall": errors}})
        factors, of_sequences = self.tables(printed.getvalue(), [3, 4])
        self.assertEqual(factors[2], "| wall, planar | 1.25 | 1.5 | 26 % | 19 % | 23 % |")
        self.assertEqual(of_sequences[3], "| wall, tilted | 20 % | 30 % |")

    def tables(self, printed, lengths):
        """The lines of each table, whose rows have as many cells as the head."""
        tables = [table.splitlines() for table in printed.strip().split("\n\n")]
        self.assertEqual([len(table) for table in tables], lengths)
        for table in tables:
            self.assertEqual(len({line.count("|") for line in table}), 1, table)
        return tables


if __name__ == "__main__":
    unittest.main()
