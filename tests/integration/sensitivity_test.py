# SPDX-License-Identifier: MIT
"""-task sensitivity: every row of the table is what -task simulate finds for the changed config, for the
sequence and for the planar baseline."""

import copy
import csv
import os

import numpy as np

import run_fabseq
from read_outputs import read_result
from run_fabseq import FabseqTest, distinct, largest_relative_difference
from small_parts import direct_2d, hook_3d, part_density, plate_2d, post_on_substrate, touched_nodes, write_voxels

LIMIT = 1e-6  # of solves to 1e-10
STRAIN = {2: [-0.01, -0.008, 0.003], 3: [-0.01, -0.009, -0.008, 0, 0, 0]}


def with_strain(config):
    """Of different components, in 2D with shear."""
    config["material"] = {"inherent_strain": STRAIN[len(config["domain"]["size"])]}
    return config


def planar(config):
    """The baseline of plate_2d and hook_3d, which has as many layers, as a sequence."""
    result = copy.deepcopy(config)
    result["sequence"] = {"type": "planar"}
    result["constraints"] = []
    result["objective"] = [term for term in config["objective"] if term["type"] == "distortion"]
    return result


def numbers(block):
    return [[term["value"] for term in block["distortion"]], list(block["displacement"].values())]


class SensitivityTest(FabseqTest):
    def table(self, config, *arguments, ranks=2):
        """Rows by their name, and the whole."""
        run = self.run_config(ranks, config, "-task", "sensitivity", "-tolerance", "1e-10", *arguments)
        self.assert_done(run)
        table = run.json("sensitivity.json")
        others = 6 if config["layers"].get("type") == "multi_planar" else 7  # without what thin layers tend to
        self.assertEqual(len(run.stdout.splitlines()), len(table["changes"]) + others, run.stdout)
        for name in ("sensitivity.csv", "config.json"):
            with open(run.path(name), encoding="utf-8") as file:
                self.assertTrue(file.read())
        return {row["change"]: row for row in table["changes"]}, table

    def simulated(self, config, *arguments, model="nominal"):
        run = self.run_config(2, config, "-task", "simulate", "-binary", "-tolerance", "1e-10", *arguments)
        self.assert_done(run)
        return run.json("summary.json")["deposition"][model]

    def assert_row(self, row, config, *arguments, model="nominal", planar_arguments=None):
        """Both sequences of a row are those of a config."""
        for name, changed, options in (("sequence", config, arguments),
                                       ("planar", planar(config), planar_arguments or arguments)):
            expected = self.simulated(changed, *options, model=model)
            self.assertLess(largest_relative_difference(numbers(row[name]), numbers(expected)), LIMIT, row["change"])
        lengths = [row[name]["distortion"][0]["length"] for name in ("planar", "sequence")]
        self.assertAlmostEqual(row["ratio"]["length"] / (lengths[0] / lengths[1]), 1, places=12)
        rms = [row[name]["displacement"]["rms"] for name in ("planar", "sequence")]
        self.assertAlmostEqual(row["ratio"]["rms"] / (rms[0] / rms[1]), 1, places=12)

    def test_rows_are_what_a_simulation_finds(self):
        for config in map(with_strain, distinct(plate_2d(), hook_3d())):
            with self.subTest(config["name"]):
                rows, table = self.table(config)
                self.assert_row(rows["unchanged"], config)
                self.assert_row(rows["deposition follow"], config, model="follow")
                self.assert_row(rows["void quiet"], config, "-void", "quiet")
                self.assert_row(rows["Poisson's ratio 0.33"], config, "-poisson", 0.33)
                self.assert_row(rows["Poisson's ratio 0.27"], config, "-poisson", 0.27)
                for c, name in enumerate(("xx", "yy", "xy" if len(config["domain"]["size"]) == 2 else "zz")):
                    changed = copy.deepcopy(config)
                    changed["material"]["inherent_strain"][c] *= 1.1
                    self.assert_row(rows[f"strain {name} +10 %"], changed)
                self.assert_layers(rows, config)
                self.assert_limit(rows, table)
                for kind in ("length", "rms"):
                    ratios = {name: row["ratio"][kind] for name, row in rows.items()}
                    worst = min(ratios, key=ratios.get)
                    self.assertEqual(table["worst"][kind], {"ratio": ratios[worst], "change": worst})

    def assert_layers(self, rows, config):
        """The pseudo-time stays; a heat sequence of its own would have another with other layers."""
        run = self.run_config(2, config, "-task", "simulate", "-tolerance", "1e-10")
        count = config["layers"]["count"]
        for name, layers in (("one layer less", count - 1), ("one layer more", count + 1), ("layers doubled", 2 * count)):
            self.assert_row(rows[f"{name}: {layers}"], config, "-sequence", run.path("result.h5"), "-layers", layers,
                            planar_arguments=("-layers", layers))
        (name,) = [name for name in rows if name.startswith(f"layers quadrupled: {4 * count}")]
        changed = planar(config)
        if name.endswith("grid twice as fine"):  # where these layers are thinner than an element
            changed["domain"]["elements"] = [2 * n for n in config["domain"]["elements"]]
        expected = self.simulated(changed, "-layers", 4 * count)
        self.assertLess(largest_relative_difference(numbers(rows[name]["planar"]), numbers(expected)), LIMIT)

    def assert_limit(self, rows, table):
        """What the ratios tend to: an error that halves with the thickness."""
        for kind in ("length", "rms"):
            once, twice, four_times = (next(row["ratio"][kind] for name, row in rows.items() if name.startswith(words))
                                       for words in ("unchanged", "layers doubled", "layers quadrupled"))
            step = four_times - twice
            settles = abs(step) <= max(abs(twice - once), 0.05 * four_times)
            if settles:
                self.assertAlmostEqual(table["thin_layers"][kind], four_times + step, places=12)
            else:
                self.assertIsNone(table["thin_layers"][kind])

    def test_smooth_layers(self):
        config = plate_2d()
        row = self.table(config, "-finer_grid", "no", ranks=1)[0]["layers smooth, as optimized"]
        run = self.run_config(1, config, "-task", "simulate", "-tolerance", "1e-10")
        expected = run.json("summary.json")["deposition"]["nominal"]
        self.assertLess(largest_relative_difference(numbers(row["sequence"]), numbers(expected)), LIMIT)
        self.assertLess(largest_relative_difference(numbers(row["planar"]), numbers(self.simulated(planar(config)))), LIMIT)

    def test_strains_superpose(self):
        """J(u + d) + J(u - d) = 2 J(u) + 2 J(d), with the displacement d of a tenth of a component."""
        config = with_strain(plate_2d())
        rows, _ = self.table(config, "-finer_grid", "no")
        for c, name in enumerate(("xx", "yy", "xy")):
            changed = copy.deepcopy(config)
            changed["material"]["inherent_strain"] = [0.1 * value * (i == c) for i, value in enumerate(STRAIN[2])]
            both = [rows[f"strain {name} {sign}10 %"]["sequence"]["distortion"][0]["value"] for sign in "+-"]
            unchanged = rows["unchanged"]["sequence"]["distortion"][0]["value"]
            part = self.simulated(changed)["distortion"][0]["value"]
            self.assertAlmostEqual(sum(both) / (2 * unchanged + 2 * part), 1, places=6)

    def test_noise(self):
        """Standard deviations and expected J from the displacement after every layer."""
        for config in distinct(plate_2d(), hook_3d()):
            row = self.table(config, "-finer_grid", "no")[0]["noise of each layer's strain, 10 %"]
            for name, changed in (("sequence", config), ("planar", planar(config))):
                run = self.run_config(2, changed, "-task", "simulate", "-binary", "-stages", "-tolerance", "1e-10")
                self.assert_done(run)
                stages = read_result(run)["stages/displacement"].astype(float)
                increments = np.diff(stages, axis=0, prepend=0)
                nodes = touched_nodes(part_density(config))
                variance = 0.01 * (increments**2).sum((0, -1))[nodes]
                block = row[name]
                np.testing.assert_allclose(block["standard_deviation"]["rms"], np.sqrt(variance.mean()), rtol=1e-5)
                np.testing.assert_allclose(block["standard_deviation"]["max"], np.sqrt(variance.max()), rtol=1e-5)
                mean_square = (stages[-1]**2).sum(-1)[nodes].mean() + variance.mean()
                np.testing.assert_allclose(block["displacement"]["rms"], np.sqrt(mean_square), rtol=1e-5)
                self.assertIsNone(block["displacement"]["max"])
                measured = (Ellipsis, -1, slice(None), -1, slice(None)
                            ) if stages.ndim == 5 else (Ellipsis, -1, slice(None), slice(None))
                expected = (stages[-1][measured[1:]]**2).sum() + 0.01 * (increments[measured]**2).sum()
                np.testing.assert_allclose(block["distortion"][0]["value"], expected, rtol=1e-5)

    def test_numbers_of_ranks(self):
        for config in distinct(hook_3d(), plate_2d(), direct_2d("nodes"), direct_2d("elements")):
            with self.subTest(config["name"]):
                one = self.table(config, ranks=1)[0]
                two = self.table(config, ranks=2)[0]
                groups = self.table(config, "-layer_groups", 2)[0]
                for name, row in one.items():
                    expected = numbers(row["sequence"]), numbers(row["planar"])
                    if "noise" in name:
                        continue
                    for other in (two, groups):
                        found = numbers(other[name]["sequence"]), numbers(other[name]["planar"])
                        self.assertLess(largest_relative_difference(found, expected), 1e-5, name)

    def test_planar_layers_stay_planar(self):
        """Also on the finer grid: a linear time is refined to itself. The elements of a file are doubled."""
        config = planar(hook_3d())
        rows, _ = self.table(config)
        for name, row in rows.items():
            if "smooth" in name:
                continue
            self.assertLess(abs(row["ratio"]["length"] - 1), LIMIT, name)
            self.assertLess(abs(row["ratio"]["rms"] - 1), LIMIT, name)
        finer = copy.deepcopy(config)
        finer["domain"]["elements"] = [2 * n for n in config["domain"]["elements"]]
        expected = self.simulated(finer)
        self.assertLess(largest_relative_difference(numbers(rows["grid twice as fine"]["planar"]), numbers(expected)), LIMIT)
        path = self.directory + "/voxels.h5"
        write_voxels(path, part_density(config))
        for sampling in (1, 2):
            config["domain"]["elements"] = [n // sampling for n in hook_3d()["domain"]["elements"]]
            config["part"] = {"voxels": {"file": path}, "sampling": sampling}
            row = self.table(config)[0]["grid twice as fine"]
            if sampling == 1:
                found = numbers(row["planar"])
                self.assertLess(largest_relative_difference(found, numbers(expected)), LIMIT)
            self.assertLess(abs(row["ratio"]["length"] - 1), LIMIT)

    def test_strain_that_turns(self):
        for dimension in (2, 3):
            config = post_on_substrate(dimension)
            config["sequence"]["type"] = "heat"
            rows, _ = self.table(config)
            names = [name for name in rows if name.startswith("strain")]
            self.assertEqual(len(names), 2 * dimension)
            row = rows["strain, factor of axis x +10 %"]
            config["material"]["strain_scale"] = [1.1] + [1] * (dimension - 1)
            expected = self.simulated(config)
            self.assertLess(largest_relative_difference(numbers(row["sequence"]), numbers(expected)), LIMIT)
            noise = rows["noise of each layer's strain, 10 %"]["sequence"]["distortion"]
            self.assertEqual([term["value"] is None for term in noise], [True, True, False])

    def test_designs_and_the_end_of_an_optimization(self):
        config = plate_2d()
        run = self.run_config(2, config, "-max_iterations", 3, "-beta_interval", 1, "-tolerance", "1e-10", "-sensitivity")
        self.assert_done(run)
        summary, table = run.json("summary.json"), run.json("sensitivity.json")
        rows = {row["change"]: row for row in table["changes"]}
        for name, block in (("unchanged", "binary"), ("layers smooth, as optimized", "optimized")):
            expected = summary[block]["deposition"]["nominal"]
            self.assertLess(largest_relative_difference(numbers(rows[name]["sequence"]), numbers(expected)), LIMIT)
        expected = summary["baseline"]["deposition"]["nominal"]
        self.assertLess(largest_relative_difference(numbers(rows["unchanged"]["planar"]), numbers(expected)), LIMIT)
        for option in ("-design", "-sequence"):
            again, _ = self.table(config, option, run.path("result.h5"), "-baseline_layers", 4)
            for name, row in rows.items():
                if "noise" not in name:
                    self.assertLess(largest_relative_difference(numbers(again[name]["sequence"]), numbers(row["sequence"])),
                                    1e-5, option + " " + name)

    def test_solves_of_what_is_built_only(self):
        """Void quiet needs whole ones, and gets them."""
        config = plate_2d()
        rows, _ = self.table(config, "-finer_grid", "no", "-set", "solver.region=built")
        self.assertEqual([name for name, row in rows.items() if "skipped" in row],
                         ["layers quadrupled: 16, grid twice as fine", "grid twice as fine"])
        self.assert_row(rows["void quiet"], config, "-void", "quiet")

    def test_what_is_left_out(self):
        config = plate_2d()
        rows, _ = self.table(config, "-finer_grid", "no", ranks=1)
        self.assertEqual(rows["grid twice as fine"], {"change": "grid twice as fine", "skipped": "left out by output.finer_grid"})
        with open(os.path.join(self.directory, f"output_{self.runs}", "sensitivity.csv"), encoding="utf-8") as file:
            cells = {row["change"]: row for row in csv.DictReader(file)}
        self.assertEqual(set(cells), set(rows))
        for name, row in cells.items():
            self.assertEqual(row["skipped"], rows[name].get("skipped", ""))
            self.assertEqual(row["rms_ratio"] == "", name not in rows or "skipped" in rows[name])

    def test_multi_planar_layers(self):
        """Their number follows from their thickness, which is what changes."""
        config = with_strain(plate_2d())
        config["layers"] = {"type": "multi_planar", "subparts": 2, "thickness": 0.3, "angles": [[1.4], [0.8]]}
        config["constraints"] = []
        config["objective"] = config["objective"][:1]
        design = self.run_config(2, config, "-max_iterations", 2, "-tolerance", "1e-10")
        self.assert_done(design)
        of_design = ("-design", design.path("result.h5"))
        for options in ((), of_design):
            rows, _ = self.table(config, *options)
            self.assertNotIn("skipped", {key for row in rows.values() for key in row})
            for name, changes in (("unchanged", ()), ("layers half as thick: 0.15", ("-layer_thickness", 0.15)),
                                  ("strain xx +10 %", ("-set", "material.inherent_strain=[-0.011, -0.008, 0.003]"))):
                expected = self.simulated(config, *options, *changes)
                self.assertLess(largest_relative_difference(numbers(rows[name]["sequence"]), numbers(expected)), LIMIT, name)


if __name__ == "__main__":
    run_fabseq.main()
