# SPDX-License-Identifier: MIT
"""Output directories of exactly the form a run leaves, with made-up numbers: what the scripts are tested
with."""

import json
import math
import os

import h5py
import numpy as np


def v_shape_density(counts):
    """The V-shape of docs/formulation.md 10 in a box of 2 x 1 x 2, at element centres, [z][y][x]."""
    x, _, z = element_centres(counts, (2.0, 1.0, 2.0))
    inside = (z <= 0.6) | (x >= 1.2)
    return (inside & ~(z - x + 1.0 <= 0.0)).astype(float)


def element_centres(counts, size):
    """Coordinates x, y(, z) of the element centres, each an array [z][y][x]."""
    axes = [(np.arange(n) + 0.5) * length / n for n, length in zip(counts, size)]
    return np.meshgrid(*axes[::-1], indexing="ij")[::-1]


def node_coordinates(counts, size):
    axes = [np.arange(n + 1) * length / n for n, length in zip(counts, size)]
    return np.meshgrid(*axes[::-1], indexing="ij")[::-1]


def layers_of(time, density, count):
    return np.where(density > 0, np.clip(np.ceil(time * count - 1e-12), 1, count), 0.0)


def layer_table(layer, count, thickness, element_volume, spread):
    rows = []
    for j in range(1, count + 1):
        volume = float((layer == j).sum()) * element_volume
        wobble = spread * math.sin(2.3 * j)
        rows.append({"volume": volume,
                     "thickness": thickness * (1 + wobble) if volume > 0 else None,
                     "cv": 0.1 + abs(wobble) if volume > 0 else None})
    return rows


def block(objective, constraint, layers, displacement):
    norms = np.sqrt((displacement**2).sum(axis=-1))
    size = {"max": float(norms.max()), "rms": float(np.sqrt((norms**2).mean()))}
    distortion = {"name": "objective_0", "value": objective, "length": math.sqrt(objective)}
    return {"responses": [{"name": "objective_0", "type": "distortion", "value": objective},
                          {"name": "objective_1", "type": "layer_uniformity", "value": 0.3},
                          {"name": "constraint_0_0", "type": "layer_thickness", "value": constraint}],
            "layers": layers,
            "displacement": size,
            "deposition": {"follow": {"displacement": size, "distortion": [distortion]}, "nominal": None}}


def history(path, iterations, planar):
    with open(path, "w", encoding="utf-8") as file:
        for k in range(iterations):
            value = planar * (0.9 * math.exp(-k / 8) + 1e-3 * (1 + 0.6 * math.sin(1.7 * k)))
            worst = 2.0 * math.exp(-k / 4) - 0.012 + 0.008 * math.sin(0.9 * k)
            file.write(json.dumps({"iteration": k, "objective": [value, 0.3], "objective_scaled": [100, 30],
                                   "constraints": [[1 + worst]], "worst_constraint": worst,
                                   "beta": 48 * 1.5 ** min(k // 15, 3), "change": 0.05,
                                   "solver_iterations": {"primal": [12], "adjoint": [13], "heat": [9]},
                                   "seconds": {"primal": 0.4, "adjoint": 0.5, "total": 1.1},
                                   "peak_memory_bytes": 5e8}) + "\n")


def write_run(directory, name, density, size, count=12, planar_count=10, iterations=60):
    """Writes result.h5, summary.json, history.jsonl and config.json for `density` ([z][y][x] or [y][x]) in a
    box of `size`."""
    os.makedirs(directory, exist_ok=True)
    dimension = density.ndim
    counts = density.shape[::-1]
    centres, nodes = element_centres(counts, size), node_coordinates(counts, size)
    height, top = centres[-1], size[-1]
    planar_time = height / top
    time = height + 0.25 * centres[0] * np.sin(math.pi * height / top) - 0.1 * centres[0]
    built = density > 0
    time = (time - time[built].min()) / (time[built].max() - time[built].min())
    s = nodes[-1] / top
    planar_displacement = np.zeros(density_nodes(density) + (dimension,))
    planar_displacement[..., 0] = 0.05 * s**2 - 0.01 * (nodes[0] - size[0] / 2) * s
    planar_displacement[..., -1] = -0.02 * s - 0.02 * s * (nodes[0] / size[0] - 0.5)
    displacement = 0.15 * planar_displacement
    displacement[..., 0] += -0.01 * (nodes[0] - size[0] / 2) * s
    displacement[..., -1] -= 0.008 * s
    with h5py.File(os.path.join(directory, "result.h5"), "w") as file:
        file["density"] = density
        file["time"] = np.where(built, time, 0.0)
        file["layer"] = layers_of(time, density, count)
        file["displacement"] = displacement
        at_edge = (nodes[0] > size[0] * (1 - 1e-9)) & (nodes[-1] > top * (1 - 1e-9))
        file["model/node_sets/top_edge"] = np.flatnonzero(at_edge).astype(np.int64)
        file["planar/time"] = np.where(built, planar_time, 0.0)
        file["planar/layer"] = layers_of(planar_time, density, planar_count)
        file["planar/displacement"] = planar_displacement
    target = top / count
    volume = float(np.prod([length / n for length, n in zip(size, counts)]))
    optimized = layer_table(layers_of(time, density, count), count, target, volume, 0.08)
    summary = {"status": "iteration_limit", "reason": "made up", "iterations": iterations,
               "optimized": block(4.5e-4, 1.01, optimized, displacement),
               "binary": block(5.3e-4, 1.03, layer_table(layers_of(time, density, count), count, target, volume, 0.1),
                               displacement),
               "baseline": block(0.41, 1.0, layer_table(layers_of(planar_time, density, planar_count), planar_count,
                                                        top / planar_count, volume, 0.0), planar_displacement),
               "interior_minima": 0, "seconds": {"primal": 20.0, "adjoint": 30.0, "total": 61.0},
               "peak_memory_bytes": 5e8}
    with open(os.path.join(directory, "summary.json"), "w", encoding="utf-8") as file:
        json.dump(summary, file, indent=1)
    config = {"name": name, "domain": {"size": list(size), "elements": list(counts)},
              "build_plate": "z-" if dimension == 3 else "y-",
              "node_sets": {"top_edge": {"box": {"min": [size[0], *[0.0] * (dimension - 2), top], "max": list(size)}}},
              "process": {"deposition": "follow"},
              "objective": [{"type": "distortion", "measure": "displacement", "nodes": "top_edge", "mean": False},
                            {"type": "layer_uniformity"}],
              "constraints": [{"type": "layer_thickness", "target": target, "tolerance": 0.1}]}
    with open(os.path.join(directory, "config.json"), "w", encoding="utf-8") as file:
        json.dump(config, file, indent=1)
    history(os.path.join(directory, "history.jsonl"), iterations, 0.41)


PREFIXES = {"baseline": "planar/", "start": "start/", "optimized": "", "binary": ""}


def add_temperatures(directory):
    """Adds what a block thermal leaves: elements of 60 degrees C in the first layer, and 20 more in each."""
    with h5py.File(os.path.join(directory, "result.h5"), "r+") as file:
        for prefix in {prefix for prefix in PREFIXES.values() if prefix + "layer" in file}:
            layer = file[prefix + "layer"][:]
            file[prefix + "interpass_temperature"] = np.where(layer > 0, 40.0 + 20.0 * layer, 0.0)
    change(directory, "config.json", lambda config: config.update(thermal={"heat_input": 3e6}))


def add_checks(directory, unit="mm"):
    """Adds what a config with a unit, a yield stress and a deposition rate leaves: checks and what they say,
    build time, stress, more planar layers, and the release. Six elements of the planar layers begin in the
    air."""
    with h5py.File(os.path.join(directory, "result.h5"), "r+") as file:
        for prefix in {prefix for prefix in PREFIXES.values() if prefix + "layer" in file}:
            part = file["density"][:] > 0
            hanging = np.zeros(part.shape)
            if prefix == "planar/":
                hanging[tuple(index[-6:] for index in np.nonzero(part))] = 1.0
            file[prefix + "hanging"] = hanging
            file[prefix + "local_thickness"] = np.where(part, 0.1, 0.0)
            file[prefix + "release_displacement"] = -0.5 * file[prefix + "displacement"][:]
            file[prefix + "released_displacement"] = 0.5 * file[prefix + "displacement"][:]

    def edit(summary):
        for k, block in enumerate(name for name in PREFIXES if name in summary):
            count, beyond = 6 if block == "baseline" else 0, 0.125 / (k + 1)
            words = {"hanging": [f"{100 * count / part.sum():.2g} % of the part begins in the air (first near [1.5,0.5])"],
                     "stress": ["residual stress, without plastic flow: up to 300, above the yield stress 250 in "
                                f"{100 * beyond:.3g} % of the part"]}
            summary[block].update(
                words={finding: sentences for finding, sentences in words.items() if count or finding != "hanging"},
                checks={"local_thickness": {"least": 0.1, "largest": 0.1, "share_outside": 0.25},
                        "hanging": {"elements": count, "at": [1.5, 0.5] if count else None, "per_layer": [count]}},
                wire_mass=2.5, build_hours=1.5 + k, stress={"von_mises": 300.0, "share_beyond_yield": beyond})
        summary["baseline_matched"] = {**summary["baseline"], "layers": summary["baseline"]["layers"][:7]}

    change(directory, "summary.json", edit)
    change(directory, "config.json", lambda config: (config["domain"].update(unit=unit),
                                                     config.update(material={"yield_stress": 250.0}, output={"stress": True})))


def add_torch(directory, most_tilt=30.0):
    """Adds to the checks of add_checks what a torch leaves: it tilts with the pseudo-time, beyond
    `most_tilt` in the last tenth, and the last four elements of the optimized layers are out of its reach."""
    counts = {}
    with h5py.File(os.path.join(directory, "result.h5"), "r+") as file:
        part = file["density"][:] > 0
        for prefix in {prefix for prefix in PREFIXES.values() if prefix + "layer" in file}:
            blocked = np.zeros(part.shape)
            if not prefix:
                blocked[tuple(index[-4:] for index in np.nonzero(part))] = [0.1, 0.4, 0.3, 0.2]
            tilt = np.where(part, 0.0 if prefix == "planar/" else most_tilt / 0.9 * file[prefix + "time"][:], 0.0)
            file[prefix + "blocked"], file[prefix + "tilt"] = blocked, tilt
            counts[prefix] = blocked > 0, tilt > most_tilt, tilt.max()

    def edit(summary):
        for block in (name for name in PREFIXES if name in summary):
            blocked, beyond, largest = counts[PREFIXES[block]]
            found = int(blocked.sum())
            summary[block]["checks"].update(
                blocked={"elements": found, "share": found / part.sum(), "deepest": 0.4 if found else 0.0,
                         "at": [1.5] * part.ndim if found else None, "per_layer": [found]},
                tilt={"largest": largest, "beyond": int(beyond.sum()), "share": beyond.sum() / part.sum(), "at": None,
                      "per_layer": [int(beyond.sum())]})
            told = {"blocked": (found, "is out of the torch's reach (by 0.4 mm near [1.5,1.5])"),
                    "tilt": (beyond.sum(), f"is tilted beyond the limit ({largest:.3g} of {most_tilt:g} degrees near [1,2])")}
            summary[block]["words"].update({finding: [f"{100 * count / part.sum():.2g} % of the part {words}"]
                                            for finding, (count, words) in told.items() if count})
        if "baseline_matched" in summary:
            summary["baseline_matched"].update({key: summary["baseline"][key] for key in ("checks", "words")})

    change(directory, "summary.json", edit)
    change(directory, "config.json", lambda config: config.update(tool={"max_tilt": most_tilt}))


def make_simulation(directory):
    """What is left of a made-up optimization if it were a simulation of its binary layers."""
    def edit(summary):
        result = summary["binary"]
        for block in ("optimized", "binary", "baseline", "baseline_matched", "iterations"):
            summary.pop(block, None)
        summary.update(result, layer_displacement_norms=[0.1] * len(result["layers"]),
                       released={"displacement": {"max": 0.02, "rms": 0.01}})

    change(directory, "summary.json", edit)
    with h5py.File(os.path.join(directory, "result.h5"), "r+") as file:
        del file["planar"]
        components = {2: 3, 3: 6}[file["density"].ndim]
        for name, stress in (("residual_stress", 3.0), ("released_stress", 1.0)):
            file[name] = np.full((*file["density"].shape, components), stress * np.eye(components)[0])
    os.remove(os.path.join(directory, "history.jsonl"))


def change(directory, name, edit):
    """Lets `edit` change the content of a JSON file."""
    path = os.path.join(directory, name)
    with open(path, encoding="utf-8") as file:
        content = json.load(file)
    edit(content)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(content, file)


def density_nodes(density):
    return tuple(n + 1 for n in density.shape)
