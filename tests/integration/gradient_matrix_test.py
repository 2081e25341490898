#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Every response against central differences by every kind of design variable, in two and three dimensions,
with both void models, a constant strain and one that turns with the layers. Material goes to nominal
positions where strains turn. These follow the part's temperature, and so do those by times of elements. In
three dimensions each void model has one of the strains.

    tests/integration/gradient_matrix_test.py --table     prints the worst errors of all as a table
"""

import itertools
import sys
import unittest

import run_fabseq
from run_fabseq import FabseqTest, SANITIZED

LIMIT = 1e-5
SMALL = 1e-7   # a derivative of less than this share of its value is seen through the noise of solves to 1e-12:
NOISY = 1e-4   # its limit
BESIDE_KINKS = 1e-3
LEAST = 1e-10  # of a derivative that is no zero against a zero
# Responses that do not depend on a kind of variable: exactly.
INDEPENDENT = {("continuity", "time points"), ("subpart_volume", "angles"), ("tool_clearance", "time points"),
               ("tilt", "time points"), ("supported", "time points")}
DESIGNS = ("diffusivity", "tilts and stretch", "times of nodes", "times of elements", "sub-parts")


def part(dimension):
    """A post with an arm, in a box that is not all part."""
    flat = dimension == 2

    def box(low, high):
        return {"box": {"min": low[::2] if flat else low, "max": high[::2] if flat else high}}

    return {
        "name": "arm",
        "domain": {"size": [1.6, 1.2] if flat else [1.6, 0.6, 1.2], "elements": [12, 9] if flat else [8, 3, 6]},
        # Without the notch some functionals would vanish by symmetry.
        "part": {"difference": [{"union": [box([0, 0, 0], [0.8, 0.6, 1.2]), box([0, 0, 0.6], [1.6, 0.6, 1.2])]},
                                box([0.81, 0.41, 0.61], [1.6, 0.6, 0.99])]},
        "node_sets": {"tip": box([1.6, 0, 0.6], [1.6, 0.6, 1.2]), "top": box([0, 0, 1.2], [1.6, 0.6, 1.2]),
                      "back": box([0, 0, 0], [0, 0.6, 1.2]),
                      "skin": {"all": True, "surface": True}}}


def distortions(up):
    terms = [{"type": "distortion", "measure": "layerwise"}]
    for released in (False, True):
        terms.append({"type": "distortion", "nodes": "tip", "mean": released, "after_release": released, "least_squares": True})
        terms.append({"type": "distortion", "measure": "flatness", "axis": up, "nodes": "top", "after_release": released})
        terms.append({"type": "distortion", "measure": "shape", "nodes": "skin", "after_release": released,
                      "least_squares": not released})
        terms.append({"type": "distortion", "nodes": "top", "norm": 6, "after_release": released})
        terms.append({"type": "distortion", "measure": "angle", "nodes": "tip", "to": "back" if released else "top",
                      "after_release": released})
    return terms


def aggregates(up):
    """Terms over the scenarios of the strain."""
    return [{"type": "distortion", "nodes": "top", "mean": True, "after_release": True, "aggregate": "mean"},
            {"type": "distortion", "measure": "layerwise", "aggregate": "mean"},
            {"type": "distortion", "measure": "shape", "nodes": "skin", "aggregate": "spread"},
            {"type": "distortion", "measure": "flatness", "axis": up, "nodes": "top", "aggregate": "worst"}]


def limits(up):
    """Distortion as a constraint."""
    terms = [{"measure": "layerwise"}, {"nodes": "top", "norm": 6},
             {"measure": "flatness", "axis": up, "nodes": "top"},
             {"measure": "shape", "nodes": "skin", "after_release": True},
             {"measure": "angle", "nodes": "tip", "to": "top", "after_release": True}]
    return [{"type": "distortion", "limit": 1.0, **term} for term in terms]


def add_heat(config):
    """Strains by the temperature of the part, with a few hundred degrees between its layers. Its material
    conducts and stores heat by its temperature."""
    config["thermal"] = {"heat_input": 2e6, "vanishing": 1400, "reference": 40, "film_coefficient": 60, "plate": 60,
                         "passes": 2, "steps": [2, 1]}
    config["material"].update({"conductivity": 30, "heat_capacity": 600, "temperatures": [20, 400, 900, 1400],
                               "conductivity_factors": [1.3, 1, 0.7, 0.6], "heat_capacity_factors": [0.7, 1, 1.5, 1.1]})


def problem(dimension, design, void, turning):
    config, up = part(dimension), "y" if dimension == 2 else "z"
    warm = turning or design == "times of elements"
    constant = [-0.01, -0.008, 0.003] if dimension == 2 else [-0.01, -0.008, -0.012, 0.003, 0, -0.002]
    config["process"] = {"void": void, "deposition": "nominal" if turning else "follow", "deposition_rate": 2.5, "dwell": 60}
    config["material"] = {"inherent_strain": {"tangential": -0.01, "normal": 0.002} if turning else constant,
                          "mass_density": 7.85}
    if warm:
        add_heat(config)
    of_the_build = [{"type": "build_time", "limit": 3}] + ([{"type": "interpass_temperature", "limit": 300}] if warm else [])
    config["objective"] = distortions(up) + [{"type": "build_time"}]
    scenarios = void == "quiet"
    if scenarios:  # with a worst case there are no least squares
        axes = [[1, 1, 1], [1.15, 1, 1], [0.9, 1.1, 1.2], [1, 1, 0.8]]
        config["material"]["scenarios"] = [factors[:dimension] for factors in axes]
        for term in config["objective"]:
            if term["type"] == "distortion":
                term["least_squares"] = "auto"
        config["objective"] += aggregates(up)
    if design == "sub-parts":
        config["sequence"] = {"type": "heat"}
        config["layers"] = {"type": "multi_planar", "subparts": 2, "thickness": 0.3, "sharpness": {"time": 30, "slab": 8},
                            "angles": [[1.2], [0.5]] if dimension == 2 else [[1.2, 0.4], [0.6, 0.3]]}
        config["objective"].append({"type": "segmentation_alignment"})
        config["constraints"] = [{"type": "subpart_volume"}, {"type": "tilt"}, {"type": "supported"}] + limits(up) + of_the_build
        config["tool"] = {"max_tilt": 40}
        return config
    # As many layers as leave the last ones so small that there is a last layer to bound.
    count, least_volume = (5, 0.99) if design.startswith("times") else (7, 0.9)
    config["layers"] = {"count": count, "time_points": "variable"}
    config["projection"] = {"beta": 20}
    config["sequence"] = {"type": "heat"}
    if design == "tilts and stretch":
        config["sequence"] = {"type": "guided", "stretch": [0.6, 1.6], "filter_radius": 0.3}
    if design.startswith("times"):
        config["sequence"] = {"type": "direct", "location": design.split()[-1], "filter_radius": 0.3}
    config["constraints"] = [{"type": "deposition_speed"}, {"type": "continuity"}, {"type": "minimum_layer_volume"},
                             {"type": "last_layer", "least_volume": least_volume},
                             {"type": "tool_clearance", "samples": 40}] + limits(up) + of_the_build
    config["tool"] = {"profile": [[0.1, 0.05], [0.3, 0.3], [0.8, 0.3]], "max_tilt": 50, "thickness": [0.8, 1.4]}
    if design != "times of elements":
        config["objective"] += [{"type": "layer_uniformity", "form": form} for form in ("sum_of_squares", "variance")]
        config["constraints"] += [{"type": "layer_thickness", "target": 0.25}, {"type": "tilt"}, {"type": "local_thickness"},
                                  {"type": "supported"}]
    else:
        config["tool"]["axis"] = [0.1] * (dimension - 1) + [1.0]
    return config


def add_flow(config, heated):
    """A material that yields at a sixth of the strain, and with heat follows its temperature."""
    config["process"].update({"model": "elastoplastic", "deposition": "nominal"})
    config["material"].update({"yield_stress": 0.0015, "hardening": 0.02})
    if heated:
        config["material"].update({"young_factors": [1, 0.8, 0.3, 0.05],
                                   "yield_factors": [1, 0.7, 0.2, 0.04], "elongations": [0, 0.005, 0.013, 0.02],
                                   "cut_off": 1150})
    else:
        config.pop("thermal", None)
        config["constraints"] = [term for term in config["constraints"] if term["type"] != "interpass_temperature"]


def label(config, entry):
    """Of a component's response, such as "distortion, flatness, after release"."""
    kind, index = entry["name"].split("_")[:2]
    bounded = kind == "constraint"
    term = config["constraints" if bounded else "objective"][int(index)]
    words = ["limit of distortion" if bounded and term["type"] == "distortion" else entry["type"]]
    words += [str(term[key]) for key in ("measure", "form") if key in term]
    words += ["displacement"] if term["type"] == "distortion" and "measure" not in term else []
    words += ["norm"] if "norm" in term else []
    words += [term["aggregate"]] if "aggregate" in term else []
    words += ["after release"] if term.get("after_release") else []
    words += ["a " + entry["name"].split("_")[2]] if not bounded and len(entry["name"].split("_")) > 2 else []
    return ", ".join(words)


class GradientMatrixTest(FabseqTest):
    def worst(self, dimension, design):
        """Largest best-step error of each response by each kind of variable, over voids and strains."""
        found = {}
        strains = (False,) if design == "times of elements" else (False, True)
        cases = list(itertools.product(("absent", "quiet"), strains))
        if dimension == 3 and len(cases) == 4 and "--table" not in sys.argv:
            cases = cases[1:3]
        for void, turning in cases:
            config = problem(dimension, design, void, turning)
            run = self.run_config(2, config, "-task", "check_gradients", timeout=900)
            self.assert_done(run)
            largest = {}
            for entry in run.json("gradient_check.json")["components"]:
                variables = design if entry["variables"] == "design" else entry["variables"].replace("_", " ")
                key = label(config, entry), variables
                found[key] = max(found.get(key, 0.0), entry["best"])
                largest[key] = max(map(abs, [largest.get(key, 0.0), entry["adjoint"], *entry["differences"]]))
                limit = NOISY if abs(entry["adjoint"]) < SMALL * abs(entry["value"]) else LIMIT
                self.assertLess(entry["best"], limit, f"{key} {dimension}D {void} {turning}: {entry}")
            for key, derivative in largest.items():
                if key in INDEPENDENT:
                    self.assertEqual(derivative, 0.0, f"{key} {dimension}D {void} {turning}")
                else:
                    self.assertGreater(derivative, LEAST, f"zero against zero: {key} {dimension}D {void} {turning}")
        return found

    def test_times_beyond_the_last_layer(self):
        """Guided layers of a part that is taller than they are together; strains follow the temperature."""
        for dimension in (2,) if SANITIZED else (2, 3):
            config = problem(dimension, "tilts and stretch", "absent", turning=True)
            config["sequence"]["characteristic_length"] = 0.8  # of 1.2
            config["sequence"]["initial"] = "planar"
            run = self.run_config(2, config, "-task", "check_gradients", timeout=900)
            self.assert_done(run)
            for entry in run.json("gradient_check.json")["components"]:
                limit = NOISY if abs(entry["adjoint"]) < SMALL * abs(entry["value"]) else LIMIT
                self.assertLess(entry["best"], limit, f"{label(config, entry)} {dimension}D: {entry}")

    def test_plastic_flow(self):
        """Some differences cross kinks, where elements begin to flow, at all steps not lost in rounding."""
        for design, heated in itertools.product(DESIGNS[:1] if SANITIZED else DESIGNS, (False, True)):
            with self.subTest(design=design, heated=heated):
                config = problem(3, design, "absent", turning=design != "times of elements")
                add_flow(config, heated)
                run = self.run_config(2, config, "-task", "check_gradients", timeout=900)
                self.assert_done(run)
                errors = []
                for entry in run.json("gradient_check.json")["components"]:
                    errors.append(entry["best"])
                    self.assertLess(entry["best"], BESIDE_KINKS, f"{label(config, entry)} {design} {heated}: {entry}")
                errors.sort()
                self.assertLess(errors[len(errors) // 2], 1e-6)
                self.assertLess(errors[len(errors) * 9 // 10], LIMIT)

    def allowed(self, *setting):
        """The words that the program would take in place of "none", the value of a setting."""
        refusal = self.run_config(1, part(2), "-set", 'sequence={"type": "heat"}', "-layers", "4", *setting).messages()
        self.assertIn('found "none"; allowed: ', refusal[0])
        return set(refusal[0].split("allowed: ")[1].split(", "))

    def registered(self):
        """First words of the labels of all responses there are, and their measures and forms."""
        objective, constraints = ("-set", 'objective=[{"type": "%s"%s}]'), ("-set", 'constraints=[{"type": "none"}]')

        def term(kind, more=""):
            return objective[0], objective[1] % (kind, more)
        measures = {f"distortion, {word}" for word in self.allowed(*term("distortion", ', "measure": "none"'))}
        forms = {f"layer_uniformity, {word}" for word in self.allowed(*term("layer_uniformity", ', "form": "none"'))}
        types = self.allowed(*term("none")) | self.allowed(*term("layer_uniformity"), *constraints)
        return types - {"distortion", "layer_uniformity"} | measures | forms

    def test_all(self):
        table = {}
        for dimension, design in itertools.product((2,) if SANITIZED else (2, 3), DESIGNS):
            with self.subTest(dimension=dimension, design=design):
                for key, error in self.worst(dimension, design).items():
                    table.setdefault(key, {})[dimension] = max(error, table.get(key, {}).get(dimension, 0.0))
        covered = {", ".join(response.split(", ")[:2]) for response, _ in table}
        self.assertEqual(self.registered() - covered, set(), "responses that no case of this test has")
        if "--table" in sys.argv:
            print("| response | by | 2D | 3D |\n| --- | --- | --- | --- |")
            for (response, variables), errors in sorted(table.items()):
                print(f"| {response} | {variables} | "
                      + " | ".join(f"{errors[d]:.1e}" if d in errors else "–" for d in (2, 3)) + " |")


if __name__ == "__main__":
    if "--table" in sys.argv:
        unittest.main(argv=sys.argv[:1])
    run_fabseq.main()
