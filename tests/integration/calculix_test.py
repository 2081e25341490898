# SPDX-License-Identifier: MIT
"""Decks of fabseq-tools calculix, solved by ccx: its displacements are those of the program."""

import os
import re
import shutil
import subprocess
import sys
import unittest

import h5py
import numpy as np

import run_fabseq
from mesh_test import HIGH, LOW, bar, box_triangles, stl_text
from multi_planar_test import tee_2d
from run_fabseq import ENVIRONMENT, FabseqTest, ROOT
from small_parts import hook_3d, part_density, plate_2d, post_on_substrate, write_voxels

TOOLS = os.path.join(ROOT, "scripts", "fabseq-tools")


def run_tool(command, *arguments):
    return subprocess.run([sys.executable, TOOLS, command, *map(str, arguments)], capture_output=True, text=True,
                          check=False, env={**ENVIRONMENT, **os.environ})


def deck_nodes(path):
    """Positions by node number."""
    with open(path, encoding="ascii") as file:
        rows = re.search(r"\*NODE,[^\n]*\n([^*]*)", file.read())[1]
    return {int(row.split(",")[0]): [float(word) for word in row.split(",")[1:]] for row in rows.splitlines()}


@unittest.skipIf(shutil.which("ccx") is None, "calculix-ccx is not installed: scripts/setup.sh --ci")
class CalculixTest(FabseqTest):
    def simulate(self, config, *arguments):
        run = self.run_config(1, config, "-task", "simulate", "-binary", "-stages", "-tolerance", "1e-9", *arguments)
        self.assert_done(run)
        return run

    def solve(self, run, layer):
        """Writes the decks and solves them."""
        folder = run.path("calculix")
        exported = run_tool("calculix", run.output, "--layer", layer)
        self.assertEqual(exported.returncode, 0, exported.stderr)
        for path in exported.stdout.split():
            if not os.path.exists(path[:-3] + "dat"):
                solved = subprocess.run(["ccx", "-i", path[:-4]], cwd=folder, capture_output=True, text=True, check=False)
                self.assertIn("Job finished", solved.stdout, solved.stdout[-2000:])
        return folder

    def expect_same(self, run, path):
        compared = run_tool("compare-calculix", run.output, path)
        self.assertEqual(compared.returncode, 0, compared.stdout + compared.stderr)

    def check(self, config, layers, finished=True):
        """The steps of some layers, and the finished part, which is one of a single layer."""
        run = self.simulate(config)
        for layer in layers:
            folder = self.solve(run, layer)
            self.expect_same(run, os.path.join(folder, f"layer_{layer:04d}.dat"))
        if finished:
            whole = self.simulate(config, "-set", "layers.count=1", "-design", run.path("result.h5"))
            for name in ("finished", "finished_released"):
                self.expect_same(whole, os.path.join(folder, name + ".dat"))
        return run, folder

    def test_shear_and_void(self):
        """All components of the strain, elements that are no cubes, soft void that holds the part."""
        config = hook_3d()
        config["domain"]["elements"] = [8, 5, 6]
        config["material"] = {"poisson": 0.4, "inherent_strain": [-0.01, -0.004, 0.002, 0.003, -0.005, 0.006],
                              "strain_scale": [1.2, 0.7, 1.0], "young": 210e3}
        config["process"] = {"void": "quiet", "min_stiffness": 1e-3, "deposition": "follow"}
        config["name"] = "hängt"  # ccx reads ASCII
        run, folder = self.check(config, (1, 3))
        other = shutil.copy(os.path.join(folder, "layer_0003.dat"), os.path.join(folder, "layer_0002.dat"))
        refused = run_tool("compare-calculix", run.output, other)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("exceeds 1e-05", refused.stderr)

    def test_strain_that_turns_with_the_layers(self):
        """A post on a clamped substrate in space and in plane stress, factors on the turned strain."""
        for dimension in (3, 2):
            config = post_on_substrate(dimension)
            config["material"]["strain_scale"] = [1.3, 0.9, 1.1][:dimension]
            if dimension == 2:
                config["domain"]["thickness"] = 0.3
            self.check(config, (2, 4))

    def test_grey_density(self):
        """Where grey elements deposit less than they stiffen."""
        config = plate_2d()
        path = os.path.join(self.directory, "part.h5")
        density = part_density(config)
        write_voxels(path, density * np.random.default_rng(1).uniform(0.3, 1.0, density.shape).round(2))
        config["part"] = {"voxels": {"file": path}}
        config["process"] = {"strain_penalty": 4.0}
        self.check(config, (2,))

    def test_multi_planar_layers(self):
        self.check(tee_2d(), (2, 5), finished=False)

    def test_a_mesh_that_was_turned_and_scaled(self):
        """Decks lie where the mesh file has the part."""
        with open(os.path.join(self.directory, "bar.stl"), "w", encoding="utf-8") as file:
            file.write(stl_text(box_triangles(LOW, HIGH)))
        config = bar(scale=25.4, rotate=[["x", 90], [[1, 2, 3], 30]], least_elements=0)
        config["domain"]["element"] = 101.6
        config["material"] = {"inherent_strain": {"tangential": -0.01, "normal": 0.002}}
        run, folder = self.check(config, (3,))
        nodes = deck_nodes(os.path.join(folder, "finished.inp"))
        config = run.json("config.json")
        axes = [low + np.linspace(0, edge, n + 1) for low, edge, n in zip(*(config["domain"][key] for key in (
            "origin", "size", "elements")))]
        grid = np.stack([values.ravel() for values in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], axis=1)
        placement = np.array(config["run"]["mesh_placement"])
        for number, position in nodes.items():
            np.testing.assert_allclose(placement @ [*position, 1], grid[number - 1], atol=1e-8)
        middle = np.mean([np.min(list(nodes.values()), axis=0), np.max(list(nodes.values()), axis=0)], axis=0)
        np.testing.assert_allclose(middle, (LOW + HIGH) / 2, atol=4.0)  # an element's edge

    def test_numbers_as_fortran_writes_them(self):
        """Displacements of rounding have exponents of three digits, which leave no room for the E."""
        run = self.simulate(plate_2d())
        path = os.path.join(self.solve(run, 2), "layer_0002.dat")
        with open(path, encoding="ascii") as file:
            text = file.read()
        zero = re.search(r" (?:-| )0\.000000E\+00\n", text)[0]
        for written, refused in (("1.234567-105", False), ("-1.23456-105", False), ("1.234567D-90", False), ("NaN", True),
                                 ("1.234567+310", True), ("*" * 12, True)):
            with open(path, "w", encoding="ascii") as file:
                file.write(text.replace(zero, f" {written}\n", 1))
            if not refused:
                self.expect_same(run, path)
                continue
            compared = run_tool("compare-calculix", run.output, path)
            self.assertEqual((compared.returncode, len(compared.stderr.splitlines())), (2, 1), compared.stderr)
            self.assertRegex(compared.stderr, rf"layer_0002\.dat, line \d+: found .*{re.escape(written)}; allowed: three numbers")

    def test_mistakes(self):
        run = self.run_config(1, plate_2d(), "-task", "simulate", "-stages")
        self.assert_done(run)
        for words, message in ((("--layer", 9), "--layer: found 9; allowed: a layer from 1 to 4"),
                               (("--layer", 0), "--layer: found 0; allowed")):
            refused = run_tool("calculix", run.output, *words)
            self.assertEqual(refused.returncode, 2)
            self.assertIn(message, refused.stderr)
        self.assertFalse(os.path.exists(run.path("calculix")))
        for name, message in (("layer_0002.dat", "simulate with -binary"), ("finished.dat", "simulate with -set layers.count=1"),
                              ("other.dat", "allowed: layer_ and a number")):
            refused = run_tool("compare-calculix", run.output, name)
            self.assertEqual((refused.returncode, len(refused.stderr.splitlines())), (2, 1), refused.stderr)
            self.assertIn(message, refused.stderr)
        self.assertEqual(run_tool("calculix", self.directory).returncode, 2)
        with h5py.File(run.path("result.h5"), "r+") as file:
            del file["model"]
        for command, *words in (("calculix",), ("compare-calculix", "finished.dat")):
            refused = run_tool(command, run.output, *words)
            self.assertEqual((refused.returncode, len(refused.stderr.splitlines())), (2, 1), refused.stderr)
            self.assertIn("lacks the dataset model/supports; repeat the run", refused.stderr)


if __name__ == "__main__":
    run_fabseq.main()
