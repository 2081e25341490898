#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Holds temperatures of layers against closed forms, and prints tables.

    figures/layer_temperatures.py [--output output/layer_temperatures]

A bar grows on a held plate in 24 layers, with a pause after each and no loss through its sides, so that heat
flows along it only. Between two changes its temperature is a series of sines of quarter waves, which decay on
their own while the source of a layer feeds them; a new layer begins at the air's temperature, and the series
of the longer bar starts from there. Mesh, steps in time, and real layers per simulated one are refined.
"""

import os

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import parse, parser_of, run_command, run_script, write_json
from fabseq_tools.run.places import PROGRAM

import numpy as np

from fabseq_tools.run.read_run import read_fields

HEIGHT, LAYERS, DWELL = 48.0, 24, 30.0           # mm, real layers, s after each
WIDTH, THICKNESS, RATE, HEAT = 4.0, 10.0, 0.6, 1.2e6   # mm, mm, kg/h, J/kg
CONDUCTIVITY, CAPACITY, DENSITY, AIR = 0.0407, 606.0, 7.85e-6, 20.0
POINTS, MODES = 9600, 1200                       # of the series: on the whole bar


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--output", default=os.path.join("output", "layer_temperatures"))
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", PROGRAM))
    arguments = parse(parser)
    os.makedirs(arguments.output, exist_ok=True)
    print(f"closed form, layers 12 and 24: {closed_form()[11]:.2f}, {closed_form()[23]:.2f} degrees C\n")
    table(arguments, "elements per layer", [(f"{n}", LAYERS, n, 512) for n in (1, 2, 4)])
    table(arguments, "steps", [(f"[{n}, {n}]", LAYERS, 2, n) for n in (1, 2, 4, 8, 16, 64, 512)])
    table(arguments, "passes", [(f"{m}", LAYERS // m, 2 * m, 512) for m in (1, 2, 4, 8)])


def table(arguments, head, cases):
    print(f"| {head} | largest error, K | mean | last layer |\n|" + " --- |" * 4)
    for name, layers, per_layer, steps in cases:
        error = np.abs(simulated(arguments, layers, per_layer, steps) - closed_form(LAYERS // layers))
        print(f"| {name} | {error.max():.3g} | {error.mean():.3g} | {error[-1]:.3g} |", flush=True)
    print()


def simulated(arguments, layers, per_layer, steps):
    """Mean temperature of each layer as its pause ends."""
    name = f"{layers}_{per_layer}_{steps}"
    config = {"name": name, "domain": {"size": [WIDTH, HEIGHT], "elements": [2, layers * per_layer], "thickness": THICKNESS},
              "part": {"box": {"min": [0, 0], "max": [WIDTH, HEIGHT]}}, "build_plate": "y-",
              "material": {"young": 1.0, "poisson": 0.3, "mass_density": DENSITY, "inherent_strain": [-0.01, -0.01, 0]},
              "process": {"void": "absent", "deposition_rate": RATE, "dwell": DWELL},
              "thermal": {"conductivity": CONDUCTIVITY, "heat_capacity": CAPACITY, "heat_input": HEAT, "vanishing": 1e6,
                          "passes": LAYERS // layers, "steps": [steps, steps]},
              "sequence": {"type": "planar", "direction": [0, 1]}, "layers": {"type": "curved", "count": layers},
              "node_sets": {"top": {"box": {"min": [0, HEIGHT], "max": [WIDTH, HEIGHT]}}},
              "objective": [{"type": "distortion", "nodes": "top"}], "solver": {"tolerance": 1e-10}}
    path, output = os.path.join(arguments.output, name + ".json"), os.path.join(arguments.output, name)
    write_json(path, config)
    run_command([arguments.program, "-config", path, "-task", "simulate", "-binary", "-overwrite", "-output", output])
    fields = read_fields(os.path.join(output, "result.h5"))
    return np.array([fields["interpass_temperature"][fields["layer"] == j].mean() for j in range(1, layers + 1)])


def closed_form(passes=1):
    """Mean temperature of each simulated layer of so many real ones as the last of them has cooled."""
    cell, real = HEIGHT / POINTS, HEIGHT / LAYERS
    places = (np.arange(POINTS) + 0.5) * cell
    welding = DENSITY * real * WIDTH * THICKNESS / (RATE / 3600.0)
    power = HEAT * DENSITY / welding
    excess, found = np.zeros(POINTS), []
    for number in range(1, LAYERS + 1):
        length = number * real
        count = round(length / cell)
        waves = (np.arange(MODES * number // LAYERS) + 0.5) * np.pi / length
        modes = np.sin(np.outer(waves, places[:count]))
        decay = CONDUCTIVITY / (DENSITY * CAPACITY) * waves**2
        source = np.where(places[:count] > length - real, power / (DENSITY * CAPACITY), 0.0)
        start, fed = (2.0 / count * modes @ field for field in (excess[:count], source))
        after = start * np.exp(-decay * welding) + fed * -np.expm1(-decay * welding) / decay
        excess[:count] = (after * np.exp(-decay * DWELL)) @ modes
        if number % passes == 0:
            found.append(AIR + excess[count - round(passes * real / cell):count].mean())
    return np.array(found)


if __name__ == "__main__":
    run_script(main)
