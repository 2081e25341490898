# SPDX-License-Identifier: MIT
"""Simulates a part in several orientations and compares them, to find which way up to build it.

    fabseq-tools orient CONFIG.json --output DIR [--machine CELL] [--turn "x 90"]... [--ranks N]
                        [--program build/release/fabseq] [-- OPTIONS OF THE PROGRAM]

CONFIG has a mesh as its part. The orientations are the six that put one face of the part's box on the plate
each, or those of --turn, each of which may hold several pairs of axis and degrees that follow one another
("x 90 y 45"). Turns come after the config's own part.mesh.rotate. What is compared is the same in all
orientations: the part stands on the build plate, without substrate and clamps, the objective is the shape of
the whole surface, and there are no constraints.

Each orientation is simulated with binary layers: with the start design of the config's sequence, and with
planar layers. As many layers are made as its height needs, at the target thickness of the config. Without a
target, layers are as thick as those of the config are on average in its own orientation. A sequence that is
planar or comes from a file leaves the planar layers only.

The deviations are those of the surface after a best rigid fit, as built and after the release from the plate,
which is left out for a part that falls into pieces then. Best is the least rms after the release of the start
design. `verdict` says whether these layers can be built with the config's machine or tool, or with --machine,
a machine file or the name of one of configs/machines. `overhang` is the area of elements that have neither an
element nor the plate below them. What the program refuses is listed with the reason.

Into DIR go orientation.csv, .json and .png, and a folder for each orientation with what was simulated
(simulated.json, start, planar) and config.json to go on with: the user's own config, in which only the
orientation and what follows from it has changed. Node sets turn with the part. What cannot be turned is left
out, and the terminal and orientation.json (notes) say what and why.
"""

import functools
import json
import math
import os
import re

import numpy as np

from fabseq_tools.geometry.grid import node_positions
from fabseq_tools.geometry.node_sets import nodes_of_set
from fabseq_tools.geometry.rigid_motions import without_rigid_motion
from fabseq_tools.orientation import orient_results
from fabseq_tools.orientation.turned_config import TurnedConfig, box_of_mesh, counts_of, with_absolute_files
from fabseq_tools.orientation.turned_shapes import Motion
from fabseq_tools.plot.virtual_display import ensure_display
from fabseq_tools.run.command_line import RunError, count, parse, parser_of, require_program, run_program, write_json
from fabseq_tools.run.machine import HELP, OPTION, config_with_machine, settings_for
from fabseq_tools.run.places import PROGRAM
from fabseq_tools.run.read_run import (passes_entry, read_config, read_fields, read_json, slab_thickness,
                                       target_thickness)
from fabseq_tools.run.verdict_words import class_of, in_short, verdict_of

COMMAND = "orient"

WITHOUT_START = "planar", "file"  # types of sequences
NOT_COMPARED = "node_sets", "substrate", "stock", "clamps", "constraints", "baseline", "run"  # keys that are left out
AS_GIVEN = "as_given"  # orientation of the config itself, where that has to be looked at


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("config")
    parser.add_argument("--output", required=True)
    parser.add_argument("--turn", action="append", metavar='"AXIS DEGREES..."', help="an orientation to look at")
    parser.add_argument("--ranks", type=count, default=1)
    parser.add_argument(OPTION, metavar="CELL", help=HELP)
    parser.add_argument("--program", default=PROGRAM)
    arguments = parse(parser, words)
    require_program(arguments.program)
    config = read_config(arguments.config)
    for key in ("domain", "part", "sequence", "layers"):
        if not isinstance(config.get(key), dict):
            raise RunError(f"{arguments.config}: {key} is missing or no object")
    if "mesh" not in config["part"]:
        raise RunError(f"{arguments.config}: part.mesh is missing; only a part from a mesh can be turned")
    config = with_absolute_files(config | settings_for(config, arguments.machine),
                                 os.path.dirname(os.path.abspath(arguments.config)))
    turns = [turn_of(text) for text in arguments.turn] if arguments.turn else six_turns(config.get("build_plate", "z-"))
    ensure_display()  # before hours of simulation
    records = records_of(arguments, config, turns)
    orient_results.write(records, config["domain"].get("unit"), arguments.output)
    if all("reason" in record for record in records):
        raise RunError("the program refuses every orientation")


def records_of(arguments, config, turns, say=lambda words: print(words, flush=True)):
    """What the orientations of a config with absolute file names come to, one after the other."""
    given = AsGiven(arguments, config)
    return [record_of(arguments, given, turn, say) for turn in turns]


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


class AsGiven:
    """A config, and what it is in its own orientation, which is looked at where something asks for it.
    `written`: as the user has it; `config`: with what follows from its machine."""

    def __init__(self, arguments, config):
        self.arguments, self.written, self.config = arguments, config, config
        if "machine" in config:
            self.config = config_with_machine(arguments.program, self.write("with_machine", config))
        self.target = self.target_thickness()

    def target_thickness(self):
        """Of a layer: the config's, or else its mean."""
        layers = self.config["layers"]
        if layers.get("type") == "multi_planar":
            return slab_thickness(self.config)
        target = target_thickness(self.config)
        if target is not None:
            return target
        if not isinstance(layers.get("count"), int):
            raise RunError("layers.count is no number, and no layer_thickness constraint says how thick a layer is")
        return self.geodesic_height / layers["count"]

    @functools.cached_property
    def geodesic_height(self):
        return sizes_of(run_program(self.arguments, self.compared(), "check"))["geodesic_height"]

    def layers(self):
        """None where the program refuses the orientation."""
        count = self.config["layers"].get("count")
        try:
            return count if isinstance(count, int) else max(1, math.ceil(self.geodesic_height / self.target - 1e-9))
        except RunError:
            return None

    @functools.cached_property
    def shift(self):
        """By which the turned mesh was moved. The effective config of a simulation has it."""
        output = os.path.join(self.arguments.output, AS_GIVEN)
        run_program(self.arguments, self.compared(), "simulate", "-set", 'sequence={"type": "planar"}', "-set",
                    "part.mesh.least_elements=0", "-set", "part.keep=connected", "-overwrite", "-output", output)
        return shift_of(output)

    @functools.cached_property
    def node_counts(self):
        """Nodes of the node sets; empty where the program refuses the config."""
        try:
            return counts_of(run_program(self.arguments, self.arguments.config, "check"))
        except RunError:
            return {}

    def compared(self):
        """The file of what is simulated of it."""
        return self.write(AS_GIVEN, compared_config(self.config, []))

    def write(self, name, config):
        os.makedirs(self.arguments.output, exist_ok=True)
        path = os.path.join(self.arguments.output, name + ".json")
        write_json(path, config)
        return path


def shift_of(directory):
    """By which the mesh of a simulation was moved after its turns."""
    return np.array(read_json(directory, "config.json")["run"]["mesh_placement"])[:, 3]


def compared_config(config, turn):
    """What is simulated of a config in an orientation, with a single layer."""
    result = {key: value for key, value in config.items() if key not in NOT_COMPARED}
    result["name"] = f"{config.get('name', 'part')}_{name_of(turn)}"
    mesh = config["part"]["mesh"] | {"rotate": config["part"]["mesh"].get("rotate", []) + turn}
    result |= {"domain": box_of_mesh(config["domain"]), "part": config["part"] | {"mesh": mesh}, "layers": {"count": 1},
               "node_sets": {"surface": {"all": True, "surface": True}},
               "objective": [{"type": "distortion", "measure": "shape", "nodes": "surface"}]}
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


def record_of(arguments, given, turn, say):
    """What one orientation comes to; with `reason` alone if the program refuses it."""
    config, target = given.config, given.target
    name, plate = name_of(turn), config.get("build_plate", "z-")
    say(f"orientation {name}")
    folder = os.path.join(arguments.output, name)
    record = {"orientation": name, "turn": turn, "face_down": face_down(turn, plate), "folder": name}
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, "simulated.json")
    turned = compared_config(config, turn)
    write_json(path, turned)
    try:
        sizes = sizes_of(run_program(arguments, path, "check"))
        turned["layers"] = layers_of(config, sizes["geodesic_height"] / target)
        if turned["sequence"]["type"] in ("heat", "guided") and "count" in turned["layers"]:
            turned["sequence"]["characteristic_length"] = turned["layers"]["count"] * target
        write_json(path, turned)
        if config["sequence"]["type"] not in WITHOUT_START:
            run_program(arguments, path, "simulate", "-binary", "-overwrite", "-output", os.path.join(folder, "start"))
            record["start"] = block_of(os.path.join(folder, "start"))
        planar_count = max(1, math.floor(sizes["height"] / target + 0.5))  # as the program rounds its baseline
        planar_layers = json.dumps({"count": planar_count} | passes_entry(config))
        planar = ["-set", 'sequence={"type": "planar"}', "-set", f"layers={planar_layers}"]
        run_program(arguments, path, "simulate", *planar, "-overwrite", "-output", os.path.join(folder, "planar"))
        record["planar"] = block_of(os.path.join(folder, "planar"))
        notes = write_config_to_go_on(arguments, given, turn, folder, turned["layers"].get("count"), planar_count)
        for note in notes:
            say(f"  {os.path.join(folder, 'config.json')}: {note}")
        return record | sizes | areas_of(os.path.join(folder, "planar"), plate) | {"notes": notes}
    except RunError as error:
        record["reason"] = str(error)
        say(f"  {record['reason']}")
        return record


def write_config_to_go_on(arguments, given, turn, folder, layers, planar):
    """The user's config for a turned part; `layers`, `planar`: numbers of layers of the simulations. Returns
    what it could not keep."""
    motion, path = Motion(turn), os.path.join(folder, "config.json")
    places = [node_set for node_set in given.config.get("node_sets", {}).values() if not {"all", "near"} & set(node_set)]
    if places and not motion.is_identity():
        try:
            motion.shift = shift_of(os.path.join(folder, "planar")) - motion.matrix @ given.shift
        except RunError as error:
            motion.unknown = f"where the part lies before the turn is not known, because the program refuses that: {error}"
    result = TurnedConfig(given.written, turn, motion)
    result.content["name"] = f"{given.config.get('name', 'part')}_{name_of(turn)}"
    result.follow(layers, planar, given.layers)
    domain = read_json(os.path.join(folder, "planar"), "config.json")["domain"]
    edge = max(length / count for length, count in zip(domain["size"], domain["elements"]))
    result.settle(arguments, path, edge, {} if motion.is_identity() or not places else given.node_counts)
    return result.notes


def layers_of(config, count):
    if config["layers"].get("type") == "multi_planar":
        return config["layers"]
    return {"count": max(1, math.ceil(count - 1e-9))} | passes_entry(config)


def block_of(directory):
    """Layers, verdict and deviations of a simulation."""
    config, summary = read_json(directory, "config.json"), read_json(directory, "summary.json")
    path = os.path.join(directory, "result.h5")
    fields = read_fields(path)
    skin = nodes_of_set(fields, "surface", path)
    positions = node_positions(config["domain"]["size"], config["domain"]["elements"])[skin]
    shifts = {"as_built": fields["displacement"]}
    if "release_displacement" in fields:
        shifts["released"] = fields["displacement"] + fields["release_displacement"]
    verdict = verdict_of(summary)
    found = {"layers": sum(layer["volume"] > 0 for layer in summary["layers"]), "verdict": in_short(verdict),
             "class": class_of(verdict)}
    return found | {state: deviation(positions, shift.reshape(-1, 3)[skin]) for state, shift in shifts.items()}


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
