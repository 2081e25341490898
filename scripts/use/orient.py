#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Which way up should a part be built? Simulates the part of a config in several orientations, and compares.

    scripts/use/orient.py CONFIG.json --output DIR [--turn "x 90"]... [--ranks N]
                          [--program build/release/fabseq] [-- OPTIONS OF THE PROGRAM]

CONFIG has a mesh as its part. The orientations are the six that put one face of the part's box on the plate
each, or those of --turn, each of which may hold several pairs of axis and degrees that follow one another
("x 90 y 45"). Turns come after the config's own part.mesh.rotate. Other coordinates of the config, of node
sets, substrate and clamps, mean nothing in a part that is turned. Substrate and clamps are therefore replaced
by the build plate, and the objective is the shape of the whole surface. Constraints are left out.

Each orientation is simulated with binary layers: with the start design of the config's sequence, and with
planar layers. As many layers are made as its height needs, at the target thickness of the config. Without a
target, layers are as thick as those of the config are on average in its own orientation. A sequence that is
planar or comes from a file leaves the planar layers only.

The deviations are those of the surface after a best rigid fit, as built and after the release from the plate,
which is left out for a part that falls into pieces then. Best is the least rms after the release of the start
design. `overhang` is the area of elements that have neither an element nor the plate below them. What the
program refuses is listed with the reason.

Into DIR go orientation.csv, .json and .png, and a folder for each orientation with its config and the two
simulations.
"""

import math
import os
import re
import shutil

from command_line import PROGRAM, RunError, parse, parser_of, run_program, run_script, write_json

import numpy as np

import orient_results
from read_run import node_positions, read_config, read_fields, read_json, surface_nodes_of, without_rigid_motion
from virtual_display import ensure_display

WITHOUT_START = "planar", "file"  # types of sequences
IN_PLACE = "node_sets", "substrate", "clamps", "constraints", "baseline", "run"  # keys that are left out


def main():
    parser = parser_of(__doc__)
    parser.add_argument("config")
    parser.add_argument("--output", required=True)
    parser.add_argument("--turn", action="append", metavar='"AXIS DEGREES..."', help="an orientation to look at")
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--program", default=PROGRAM)
    arguments = parse(parser)
    if shutil.which(arguments.program) is None:
        raise RunError(f"{arguments.program}: no such program")
    config = read_config(arguments.config)
    for key in ("domain", "part", "sequence", "layers"):
        if not isinstance(config.get(key), dict):
            raise RunError(f"{arguments.config}: {key} is missing or no object")
    if "mesh" not in config["part"]:
        raise RunError(f"{arguments.config}: part.mesh is missing; only a part from a mesh can be turned")
    turns = [turn_of(text) for text in arguments.turn] if arguments.turn else six_turns(config.get("build_plate", "z-"))
    ensure_display()  # before hours of simulation
    target = target_thickness(arguments, config)
    records = [record_of(arguments, config, turn, target) for turn in turns]
    orient_results.write(records, config["domain"].get("unit"), arguments.output)
    if all("reason" in record for record in records):
        raise RunError("the program refuses every orientation")


def turn_of(text):
    """Pairs of axis and degrees."""
    words = text.split()
    try:
        turn = [[axis, float(angle)] for axis, angle in zip(words[::2], words[1::2], strict=True)]
    except ValueError as error:
        raise RunError(f'--turn "{text}": allowed: pairs of axis and degrees, such as "x 90 y 45"') from error
    for axis, angle in turn:
        if axis not in ("x", "y", "z") or not math.isfinite(angle):
            raise RunError(f'--turn "{text}": found {axis} {angle:g}; allowed: the axes x, y, z and a number of degrees')
    return turn


def six_turns(plate):
    """None, and those that put one of the five other faces of the box on the plate."""
    first, second = [axis for axis in "xyz" if axis != plate[0]]
    return [[], [[first, 90.0]], [[first, -90.0]], [[second, 90.0]], [[second, -90.0]], [[first, 180.0]]]


def name_of(turn):
    return "_".join(f"{axis}{angle:g}" for axis, angle in turn) or "as_is"


def face_down(turn, plate):
    """The face of the part that comes to lie on the plate; None where that is an edge or a corner."""
    direction = np.zeros(3)
    direction["xyz".index(plate[0])] = 1.0 if plate[1] == "+" else -1.0
    for axis, angle in reversed(turn):  # back into the part
        first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        a, b = direction[first], direction[second]
        direction[first], direction[second] = cosine * a + sine * b, cosine * b - sine * a
    axis = int(np.argmax(np.abs(direction)))
    return "xyz"[axis] + ("+" if direction[axis] > 0 else "-") if abs(direction[axis]) > 1 - 1e-9 else None


def target_thickness(arguments, config):
    """Of a layer: the config's, or else its mean in the config's own orientation."""
    layers = config.get("layers", {})
    if layers.get("type") == "multi_planar":
        return layers.get("thickness", 3.0)
    for constraint in config.get("constraints", []):
        if constraint.get("type") == "layer_thickness":
            return constraint["target"]
    if not isinstance(layers.get("count"), int):
        raise RunError("layers.count is no number, and no layer_thickness constraint says how thick a layer is")
    path = os.path.join(arguments.output, "as_given.json")
    os.makedirs(arguments.output, exist_ok=True)
    write_json(path, turned_config(arguments, config, []))
    return sizes_of(run_program(arguments, path, "check"))["geodesic_height"] / layers["count"]


def turned_config(arguments, config, turn):
    """What is left of a config once its part is turned, with a single layer."""
    folder = os.path.dirname(os.path.abspath(arguments.config))
    result = {key: value for key, value in config.items() if key not in IN_PLACE}
    result["name"] = f"{config.get('name', 'part')}_{name_of(turn)}"
    domain = dict(config["domain"])
    size, elements, _ = (domain.pop(key, []) for key in ("size", "elements", "origin"))
    if "element" not in domain:
        domain["element"] = [length / count for length, count in zip(size, elements)]
    mesh = dict(config["part"]["mesh"])
    mesh |= {"file": os.path.join(folder, mesh["file"]), "rotate": mesh.get("rotate", []) + turn}
    result |= {"domain": domain, "part": config["part"] | {"mesh": mesh}, "layers": {"count": 1},
               "node_sets": {"surface": {"all": True, "surface": True}},
               "objective": [{"type": "distortion", "measure": "shape", "nodes": "surface"}]}
    if "file" in config.get("material", {}):
        result["material"] = config["material"] | {"file": os.path.join(folder, config["material"]["file"])}
    result["projection"] = {key: value for key, value in config.get("projection", {}).items() if key not in ("beta", "max")}
    result["sequence"] = {key: value for key, value in config["sequence"].items() if key != "start"}  # from the plate
    if config["sequence"]["type"] in WITHOUT_START:
        result["sequence"] = {"type": "planar"}
    return result


def sizes_of(printed):
    """What -task check says."""
    height, geodesic = re.search(r"^height along the plate's normal (\S+), geodesic (\S+)", printed, re.MULTILINE).groups()
    return {"height": float(height), "geodesic_height": float(geodesic),
            "contact_elements": int(re.search(r"^plate contact: (\d+)", printed, re.MULTILINE)[1])}


def record_of(arguments, config, turn, target):
    """What one orientation comes to; with `reason` alone if the program refuses it."""
    name, plate = name_of(turn), config.get("build_plate", "z-")
    print(f"orientation {name}", flush=True)
    folder = os.path.join(arguments.output, name)
    record = {"orientation": name, "turn": turn, "face_down": face_down(turn, plate), "folder": name}
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, "config.json")
    turned = turned_config(arguments, config, turn)
    write_json(path, turned)
    try:
        sizes = sizes_of(run_program(arguments, path, "check"))
        turned["layers"] = layers_of(config, sizes["geodesic_height"] / target)
        if turned["sequence"]["type"] == "heat":
            turned["sequence"]["characteristic_length"] = turned["layers"].get("count", 1) * target
        write_json(path, turned)
        if config["sequence"]["type"] not in WITHOUT_START:
            run_program(arguments, path, "simulate", "-binary", "-overwrite", "-output", os.path.join(folder, "start"))
            record["start"] = block_of(os.path.join(folder, "start"))
        planar = ["-set", 'sequence={"type": "planar"}', "-set",
                  f'layers={{"count": {max(1, round(sizes["height"] / target))}}}']
        run_program(arguments, path, "simulate", *planar, "-overwrite", "-output", os.path.join(folder, "planar"))
        record["planar"] = block_of(os.path.join(folder, "planar"))
        return record | sizes | areas_of(os.path.join(folder, "planar"), plate)
    except RunError as error:
        record["reason"] = str(error)
        print(f"  {record['reason']}", flush=True)
        return record


def layers_of(config, count):
    if config["layers"].get("type") == "multi_planar":
        return config["layers"]
    return {"count": max(1, math.ceil(count - 1e-9))}


def block_of(directory):
    """Layers and deviations of a simulation."""
    config, summary = read_json(directory, "config.json"), read_json(directory, "summary.json")
    fields = read_fields(os.path.join(directory, "result.h5"))
    built = fields["density"] > 0
    skin = surface_nodes_of(built)
    positions = node_positions(config["domain"]["size"], built.shape[::-1])[skin]
    shifts = {"as_built": fields["displacement"]}
    if "release_displacement" in fields:
        shifts["released"] = fields["displacement"] + fields["release_displacement"]
    used = sum(layer["volume"] > 0 for layer in summary["layers"])
    return {"layers": used} | {state: deviation(positions, shift.reshape(-1, 3)[skin]) for state, shift in shifts.items()}


def deviation(positions, displacements):
    """Of the surface after a best rigid fit."""
    squares = np.sum(without_rigid_motion(displacements, positions)**2, axis=1)
    return {"rms": math.sqrt(squares.mean()), "largest": math.sqrt(squares.max())}


def areas_of(directory, plate):
    """Of the elements on the plate, and of those with nothing below."""
    config = read_json(directory, "config.json")
    built = read_fields(os.path.join(directory, "result.h5"))["density"] > 0
    axis = "xyz".index(plate[0])
    edges = [length / count for length, count in zip(config["domain"]["size"], config["domain"]["elements"])]
    face = math.prod(edges) / edges[axis]
    upward = np.moveaxis(built, 2 - axis, 0)[::1 if plate[1] == "-" else -1]
    return {"contact_area": face * int(upward[0].sum()), "overhang": face * int((upward[1:] & ~upward[:-1]).sum())}


if __name__ == "__main__":
    run_script(main)
