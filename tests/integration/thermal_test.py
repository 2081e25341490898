# SPDX-License-Identifier: MIT
"""Strains that follow the part's temperature: identities, what a run says, layer groups, the constraint."""

import h5py
import numpy as np
from scipy.integrate import solve_ivp

import run_fabseq
from run_fabseq import FabseqTest, SANITIZED, distinct, largest_relative_difference
from small_parts import hook_3d, plate_2d, post_on_substrate

RUNS = ((2, 2),) if SANITIZED else ((1, 1), (2, 1), (2, 2), (4, 2))  # ranks and groups


def warmed(config, **keys):
    """Of a size that makes interpass temperatures of a few hundred degrees."""
    config.setdefault("material", {})["mass_density"] = 7.85
    config.setdefault("process", {}).update({"deposition_rate": 2.5, "dwell": 60})
    config["thermal"] = {"conductivity": 5, "heat_capacity": 600, "heat_input": 1e7, "vanishing": 1400,
                         "film_coefficient": 20, "plate": 60, "passes": 2, "steps": [2, 2], **keys}
    return config


def interpass(record):
    return [layer["interpass_temperature"] for layer in record["layers"]]


BAR_CURVES = {"temperatures": [20, 400, 700, 735, 770, 900],
              "conductivity_factors": [1.3, 1, 0.75, 0.72, 0.7, 0.67],
              "heat_capacity_factors": [0.73, 1, 1.66, 3.3, 1.8, 1.07]}


def bar(steps):
    """A bar of mild steel on a held plate, four layers of two elements, without losses through its sides."""
    return {"domain": {"size": [4.0, 16.0], "elements": [2, 8], "thickness": 10.0},
            "part": {"box": {"min": [0, 0], "max": [4, 16]}}, "build_plate": "y-",
            "material": {"mass_density": 7.85e-6, "conductivity": 0.0407, "heat_capacity": 606, "solidification": 1450,
                         **BAR_CURVES},
            "process": {"deposition_rate": 0.6, "dwell": 2.0},
            "thermal": {"heat_input": 1.2e6, "steps": [steps, steps]},
            "sequence": {"type": "planar", "direction": [0, 1]}, "layers": {"count": 4},
            "objective": [{"type": "distortion", "measure": "layerwise"}], "solver": {"tolerance": 1e-8}}


def bar_by_scipy():
    """Mean temperature of each layer of the bar as its pause ends: heat of its planes of nodes, by BDF."""
    celsius = np.linspace(20, 3000, 60001)

    def integral(base, factors):
        values = base * np.interp(celsius, BAR_CURVES["temperatures"], BAR_CURVES[factors])
        return np.concatenate([[0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(celsius))])
    flow, stored = integral(0.0407, "conductivity_factors"), integral(7.85e-6 * 606, "heat_capacity_factors")
    section, edge, energy, means = 40.0, 2.0, np.zeros(9), []
    mass = 7.85e-6 * section * 2 * edge
    welding, shares = mass / (0.6 / 3600), np.array([0.25, 0.5, 0.25])

    def rates(_, now, power, volume):
        along = section / edge * np.diff(np.interp(now / volume, stored, flow))
        change = power - np.append(0, along) + np.append(along, 0)
        change[0] = 0  # on the plate
        return change
    for top in (2, 4, 6, 8):
        volume, power = np.full(top + 1, section * edge), np.zeros(top + 1)
        volume[[0, top]] /= 2
        power[top - 2:] = shares * 1.2e6 * mass / welding
        for seconds, source in ((welding, power), (2.0, 0 * power)):
            solved = solve_ivp(rates, (0, seconds), energy[:top + 1], method="BDF", args=(source, volume),
                               rtol=1e-7, atol=1e-5)
            energy[:top + 1] = solved.y[:, -1]
        means.append(np.interp(energy[:top + 1] / volume, stored, celsius)[top - 2:] @ shares)
    return means


class ThermalTest(FabseqTest):
    resumes = True

    def evaluate(self, config, *arguments, ranks=1):
        run = self.run_config(ranks, config, "-task", "evaluate", "-tolerance", "1e-11", *arguments)
        self.assert_done(run)
        return run

    def gradients(self, run):
        with h5py.File(run.path("gradients.h5"), "r") as file:
            return {name: np.ravel(file[name]["design"][()]) for name in file}

    def test_a_strain_that_never_vanishes_is_the_given_one(self):
        for config in (plate_2d(), hook_3d()):
            plain = self.evaluate(config)
            warm = self.evaluate(warmed(config, vanishing=1e30))
            values = [[entry["value"] for entry in run.json("evaluation.json")["responses"]] for run in (plain, warm)]
            self.assertLess(largest_relative_difference(*values), 1e-8)
            before, after = self.gradients(plain), self.gradients(warm)
            for name, gradient in before.items():
                self.assertLess(np.abs(after[name] - gradient).max(), 1e-7 * np.abs(gradient).max(), name)

    def test_a_part_that_is_taller_than_its_guided_layers(self):
        """The last layer holds all that is later: masses and temperatures are those of layers that end there,
        and solves need no help."""
        config = warmed({"domain": {"size": [4, 20], "elements": [4, 20]}, "part": {"box": {"min": [0, 0], "max": [4, 20]}},
                         "sequence": {"type": "guided", "initial": "planar", "characteristic_length": 10.0},
                         "layers": {"count": 4}, "constraints": [{"type": "local_thickness"}],
                         "objective": [{"type": "distortion", "measure": "layerwise"}]})
        config["constraints"].append({"type": "layer_thickness", "target": 2.5})
        for beta in (6, 16, 200):  # as printed, densities would leave [0, 1] with the first two
            run = self.run_config(1, config, "-task", "simulate", "-set", f"projection.beta={beta}")
            self.assert_done(run)
            self.assertEqual(run.stderr.count("warning: "), 1, run.stderr)
            self.assertIn("the last layer also holds what comes later, 36 elements", run.stderr)
            summary = run.json("summary.json")
            volumes = [layer["volume"] for layer in summary["layers"]]
            self.assertAlmostEqual(sum(volumes), 80, places=9)
            self.assertGreater(volumes[-1], 40)
            self.assertTrue(all(60 <= value < 1e5 for value in interpass(summary)), interpass(summary))
            # At its top the last layer begins at 7.5 and reaches to 19.5, the centre of the last element.
            self.assertAlmostEqual(summary["checks"]["local_thickness"]["largest"], 12, places=6)
            self.assertEqual(summary["checks"]["late"]["elements"], 36)
        self.assertLess(abs(volumes[0] - 10), 0.05)

    def test_values_and_gradients_do_not_depend_on_ranks_groups_and_path(self):
        for make in distinct(hook_3d, post_on_substrate):
            config = warmed(make())
            config["constraints"] = [{"type": "interpass_temperature", "limit": 300}]
            expected = self.evaluate(config)
            others = [("-layer_groups", groups) for _, groups in RUNS] + [("-solver_path", "reference")]
            for (ranks, _), options in zip([*RUNS, (2, 1)], others, strict=True):
                with self.subTest(case=config["name"], ranks=ranks, options=options):
                    run = self.evaluate(config, *options, ranks=ranks)
                    found, correct = (interpass(of.json("evaluation.json")) for of in (run, expected))
                    self.assertLess(largest_relative_difference(found, correct), 1e-9)
                    gradients, right = self.gradients(run), self.gradients(expected)
                    for name, gradient in right.items():
                        self.assertLess(np.abs(gradients[name] - gradient).max(), 1e-6 * np.abs(gradient).max(), name)

    def test_what_a_simulation_says(self):
        config = warmed(plate_2d(), interpass_limit=150)
        run = self.run_config(2, config, "-task", "simulate")
        self.assert_done(run)
        record = run.json("summary.json")
        layers = interpass(record)
        self.assertEqual(layers[0], 60)
        self.assertEqual(record["interpass"]["highest"], {"value": max(layers), "layer": int(np.argmax(layers)) + 1})
        self.assertGreater(record["interpass"]["hottest_element"]["value"], max(layers))
        pauses = record["interpass"]["pauses"]
        self.assertEqual(len(pauses), 4)
        self.assertGreater(pauses[2], 60)
        self.assertEqual(pauses[3], 0)
        welding = record["wire_mass"] / 2.5
        self.assertAlmostEqual(record["build_hours"], welding + 4 * 2 * 60 / 3600)
        self.assertAlmostEqual(record["interpass"]["build_hours"], welding + 2 * sum(pauses) / 3600, places=5)
        with h5py.File(run.path("result.h5"), "r") as file:
            field, layer = file["interpass_temperature"][()], file["layer"][()]
            self.assertTrue(np.array_equal(field != 0, layer != 0))
            self.assertGreater(field[layer > 0].min(), 20)
            # Binary layers are those of the mean, but for the floor of its weights.
            binary = self.run_config(1, config, "-task", "simulate", "-set", "projection.binary=true")
        self.assert_done(binary)
        with h5py.File(binary.path("result.h5"), "r") as file:
            field, layer = file["interpass_temperature"][()], file["layer"][()]
        means = [field[layer == number].mean() for number in range(1, 4)]
        self.assertLess(largest_relative_difference(means, interpass(binary.json("summary.json"))[1:]), 1e-6)
        self.assertIn("  interpass, deg C  ", binary.stdout)

    def test_properties_that_follow_the_temperature(self):
        """Extrapolated to short steps, temperatures are those that SciPy finds."""
        found = []
        for steps in (64, 128):
            run = self.run_config(1, bar(steps), "-task", "simulate", "-binary")
            self.assert_done(run)
            with h5py.File(run.path("result.h5"), "r") as file:
                field, layer = file["interpass_temperature"][()], file["layer"][()]
            found.append([field[layer == number].mean() for number in range(1, 5)])
        limit = 2 * np.array(found[1]) - found[0]
        expected = np.array(bar_by_scipy())
        self.assertGreater(expected.max(), 740)  # beyond the peak of the heat capacity
        self.assertLess(np.abs(limit - expected).max(), 2e-5 * expected.max())

    def test_with_its_pauses_a_layer_begins_at_the_limit(self):
        config = warmed(plate_2d(), interpass_limit=150, passes=1, steps=[4, 200])
        config["layers"]["count"] = 2
        run = self.run_config(1, config, "-task", "simulate")
        self.assert_done(run)
        config["process"]["dwell"] = run.json("summary.json")["interpass"]["pauses"][0]
        run = self.run_config(1, config, "-task", "simulate")
        self.assert_done(run)
        self.assertAlmostEqual(interpass(run.json("summary.json"))[1], 150, delta=0.1 * (150 - 20))

    def test_the_constraint_is_met(self):
        config = warmed(plate_2d())
        config["projection"] = {"beta": 12, "max": 12}
        config["constraints"] = []
        start = self.optimize(config, 1, 1).json("summary.json")["start"]
        limit = 0.98 * max(interpass(start))
        config["constraints"] = [{"type": "interpass_temperature", "limit": limit}]
        summary = self.optimize(config, 2, 2 if SANITIZED else 40).json("summary.json")
        if not SANITIZED:
            self.assertLess(max(interpass(summary["optimized"])[1:]), 1.0001 * limit)
        self.assertIn("highest", summary["baseline"]["interpass"])

    def test_check_says_what_it_costs(self):
        run = self.run_config(1, warmed(plate_2d()), "-task", "check")
        self.assert_done(run)
        for words in ("diffusion length", "Fourier number", "it costs 16 solves"):
            self.assertIn(words, run.stdout)
        run = self.run_config(1, bar(2), "-task", "check")
        self.assert_done(run)
        self.assertIn("it costs 16 steps of about three solves each", run.stdout)

    def test_what_is_missing_is_named(self):
        def message(change):
            config = warmed(plate_2d())
            change(config)
            run = self.run_config(2, config, "-task", "check")
            self.assertEqual(run.status, run_fabseq.BAD_INPUT, str(run))
            return run.messages()[0]
        self.assertIn("/material/mass_density: found", message(lambda config: config["material"].pop("mass_density")))
        self.assertIn("/process/deposition_rate: found", message(lambda config: config["process"].pop("deposition_rate")))
        build_time = {"type": "build_time", "limit": 1}
        self.assertIn("/constraints/0/type: found", message(
            lambda config: (config["process"].pop("deposition_rate"), config.pop("thermal"),
                            config.update(constraints=[build_time]))))
        self.assertIn("/thermal/heat_input: missing", message(lambda config: config["thermal"].pop("heat_input")))
        self.assertIn('/thermal/conductivity: found "material"', message(lambda config: config["thermal"].pop("conductivity")))
        self.assertIn("/thermal/vanishing: found 20.0; allowed: more than",
                      message(lambda config: config["thermal"].update(vanishing=20)))
        self.assertIn("/thermal/steps: found [1", message(lambda config: config["thermal"].update(steps=[1, 1.5])))
        interpass_limit = [{"type": "interpass_temperature", "limit": 10}]
        self.assertIn("/constraints/0/limit: found 10", message(lambda config: config.update(constraints=interpass_limit)))

        def without_block(config):
            config.pop("thermal")
            config["constraints"] = interpass_limit
        self.assertIn("/constraints/0/type: found", message(without_block))


if __name__ == "__main__":
    run_fabseq.main()
