# SPDX-License-Identifier: MIT
"""Moves the geometry of a part against its displacement, so that it ends up as drawn.

    fabseq-tools compensate RUN [--factor 1] [--iterations 3] [--released | --as-built]
                            [--tolerance LENGTH] [--fill SHARE|grey] [--finer-check] [--output DIR]
                            [--ranks N] [--program build/release/fabseq] [-- OPTIONS OF THE PROGRAM]

RUN is the output directory of an optimization or a simulation in 3D. Its binary layers are simulated once
more (round 0). In each further round, the mesh of the part is moved against what remains, filled with
elements of the same grid again, and simulated with the pseudo-time that moves along. What remains is
|x_c + u(x_c) - x|: how far a point x of the drawing, built at x_c, is from the drawing in the end. A part
that came from no mesh has a smoothed boundary of its elements in place of one.

DIR (default: RUN/compensated) gets
- compensated.stl, .vtp: the mesh of the round with the least rms, in the part's own coordinates and unit:
  those of its mesh file, or else of the config. Points of the VTP file have the arrays moved_by and remains.
- compensation.json, .csv: what remains after each round (as printed), in domain.unit: rms over the surface,
  the largest, both after a best rigid fit, too (rms_fitted, largest_fitted), and the rms of the points on the
  plate or the substrate, which keep their height; and how many elements differ from those of RUN.
- round_K.stl, .json, .h5: mesh (in the config's coordinates), config and pseudo-time of a round; round_K: its
  simulation. finer_K: the same of --finer-check.
"""

import os

import numpy as np

from fabseq_tools.geometry.grid import refined
from fabseq_tools.geometry.moved_part import MovedPart
from fabseq_tools.geometry.placement import Placement
from fabseq_tools.geometry.rigid_motions import rigid_motions
from fabseq_tools.geometry.surface_files import surface_of, write_surface
from fabseq_tools.run.command_line import (RunError, count, number as number_type, parse, parser_of, positive, require_program,
                                           run_program, write_json, write_rows)
from fabseq_tools.run.places import PROGRAM
from fabseq_tools.run.read_run import read_fields, slab_thickness

COMMAND = "compensate"

FILLED = 0.5  # share of an element
FACTOR = number_type("above 0, up to 2", lambda value: 0 < value <= 2)  # what --factor takes
FILL = number_type("a share above 0, up to 1, or grey", lambda value: 0 < value <= 1)
KEPT = "name", "domain", "build_plate", "substrate", "stock", "clamps", "material", "process", "layers", "solver"


def fill(text):
    return text if text == "grey" else FILL(text)


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("run")
    parser.add_argument("--factor", type=FACTOR, default=1.0, help="share of what remains to move against (default: %(default)s)")
    parser.add_argument("--iterations", type=count, default=3, metavar="ROUNDS", help="default: %(default)s")
    state = parser.add_mutually_exclusive_group()
    state.add_argument("--released", action="store_true", default=None, help="displacement after the release "
                       "(default: if the first distortion of the objective is measured so)")
    state.add_argument("--as-built", dest="released", action="store_false", help="on the plate or in the clamps")
    parser.add_argument("--tolerance", type=positive, metavar="LENGTH", help="end once the largest that remains is below it")
    parser.add_argument("--fill", type=fill, help="part.mesh.fill of all rounds (default: that of the run, or 0.5)")
    parser.add_argument("--finer-check", action="store_true",
                        help="simulate the first and the best round with half the edge, too")
    parser.add_argument("--output", help="directory (default: RUN/compensated)")
    parser.add_argument("--ranks", type=count, default=1)
    parser.add_argument("--program", default=PROGRAM)
    arguments = parse(parser, words)
    require_program(arguments.program)
    part = MovedPart(arguments.run, arguments.factor)
    if arguments.released is None:
        arguments.released = bool(measured_released(part.config))
    arguments.output = arguments.output or os.path.join(arguments.run, "compensated")
    os.makedirs(arguments.output, exist_ok=True)
    compensate(arguments, part)


def measured_released(config):
    """Whether the first distortion of a config is measured after the release."""
    return next((term.get("after_release") for term in config.get("objective", []) if term["type"] == "distortion"), False)


def compensate(arguments, part):
    """All rounds, and their files."""
    rows, best, remains, record = [], 0, None, {}
    for number in range(arguments.iterations + 1):
        if number:
            part.move(-arguments.factor * remains)
        fields, remains = simulate(arguments, part, f"round_{number}")
        differ = (fields["density"] >= FILLED) != (part.fields["density"] >= FILLED)
        rows.append({"round": number, **figures(part, remains), "elements_differ": int(differ.sum())})
        print(line(rows[-1]) if number else f"{head(arguments, part)}\n{line(rows[-1])}", flush=True)
        if rows[-1]["rms"] <= rows[best]["rms"]:
            best, moved = number, part.moved
            write_part(arguments.output, part, remains)
        record = {"best_round": best, "rounds": rows}
        write_record(arguments, part, record)
        if arguments.tolerance and rows[-1]["largest"] < arguments.tolerance:
            break
    if arguments.finer_check:
        record["finer_grid"] = check_finer(arguments, part, {0: part.drawn, best: moved})
        write_record(arguments, part, record)
    placement = Placement(part.config)
    print(f"{os.path.join(arguments.output, 'compensated.stl')}: round {best}; its coordinates are {placement.system}"
          f"{f', in {placement.unit}' if placement.unit else ''}")


def check_finer(arguments, part, moved):
    """What remains of some rounds on a grid twice as fine, which knows the part better than the run."""
    print("on a grid twice as fine", flush=True)
    rows = []
    for number, part.moved in moved.items():
        _, remains = simulate(arguments, part, f"finer_{number}", 2)
        rows.append({"round": number, **figures(part, remains)})
        print(line(rows[-1]), flush=True)
    return rows


def write_record(arguments, part, record):
    placement = Placement(part.config)
    write_rows(os.path.join(arguments.output, "compensation.csv"), record["rounds"])
    write_json(os.path.join(arguments.output, "compensation.json"),
               {"name": part.name, "state": state_of(arguments), "unit": part.unit or None, "factor": arguments.factor,
                "mesh": part.source, "coordinates": placement.system, "mesh_unit": placement.unit, "points": part.corner_count,
                **record})


def simulate(arguments, part, name, finer=1):
    """The fields of a simulation of the moved part, with binary layers, and what remains."""
    path = os.path.join(arguments.output, name)
    write_surface(surface_of(part.corners(), part.triangles, {}), path + ".stl")
    part.write_sequence(path + ".h5", finer)
    write_json(path + ".json", round_config(arguments, part, name + ".stl", finer))
    run_program(arguments, path + ".json", "simulate", "-sequence", path + ".h5", "-overwrite", "-output", path)
    fields = read_fields(os.path.join(path, "result.h5"))
    if arguments.released and "release_displacement" not in fields:
        raise RunError("the simulation knows no release of this part; allowed: --as-built")
    return fields, part.moved + part.displacement_at(fields, arguments.released) - part.drawn


def round_config(arguments, part, mesh, finer):
    """What is simulated: the run's own config without what is measured, with the moved mesh."""
    config = {key: part.config[key] for key in KEPT if key in part.config}
    config["layers"] = {key: value for key, value in config["layers"].items() if key != "passes"}  # beads are not looked at
    if "thickness" in config["layers"]:
        config["layers"]["thickness"] = slab_thickness(part.config)
    config["domain"] = refined(config["domain"], finer)
    given = part.config["part"].get("mesh", {})
    filled = arguments.fill if arguments.fill is not None else given.get("fill", 0.5)
    own = {key: value for key, value in part.config["part"].items() if key in ("keep", "sampling")}
    config["part"] = own | {"mesh": {"file": mesh, "place": "as_is", "fill": filled, "least_elements": 0}}
    return config | {"sequence": {"type": "planar"}, "projection": {"binary": True}, "objective": []}


def figures(part, remains):
    """What remains on the surface, as lengths."""
    remains = remains[:part.corner_count]
    squares, standing = np.sum(remains**2, axis=1), part.standing[:part.corner_count]
    points, roots = part.drawn[:part.corner_count], np.sqrt(np.repeat(part.weights, 3))
    motions = rigid_motions(points - points.mean(axis=0)).reshape(6, -1).T * roots[:, None]
    rest = remains.ravel() * roots
    rest = rest - motions @ np.linalg.lstsq(motions, rest, rcond=1e-9)[0]
    fitted = rest.reshape(-1, 3)[part.weights > 0] / np.sqrt(part.weights[part.weights > 0])[:, None]
    return {"rms": rms(squares, part.weights), "largest": float(np.sqrt(squares.max())),
            "rms_fitted": float(np.linalg.norm(rest)), "largest_fitted": float(np.linalg.norm(fitted, axis=1).max()),
            "rms_at_plate": rms(squares[standing], part.weights[standing])}


def rms(squares, weights):
    return float(np.sqrt(weights @ squares / weights.sum())) if weights.any() else 0.0


def write_part(output, part, remains):
    """The moved mesh, in the part's own coordinates."""
    placement = Placement(part.config)
    shift = part.corners() - part.drawn[:part.corner_count]
    arrays = {"moved_by": placement.directions(shift) * placement.scale,
              "remains": placement.directions(remains[:part.corner_count]) * placement.scale}
    data = surface_of(placement.points(part.corners()), part.triangles, arrays)
    for form in ("stl", "vtp"):
        write_surface(data, os.path.join(output, f"compensated.{form}"))


def state_of(arguments):
    return "after the release" if arguments.released else "as built"


def head(arguments, part):
    unit = f", {part.unit}" if part.unit else ""
    return (f"what remains {state_of(arguments)}{unit}, of {part.corner_count} points\n{'round':>5}{'rms':>10}{'largest':>10}"
            f"{'rms, best fit':>15}{'rms at the plate':>18}{'elements that differ':>22}")


def line(row):
    return (f"{row['round']:>5}{row['rms']:>10.4g}{row['largest']:>10.4g}{row['rms_fitted']:>15.4g}{row['rms_at_plate']:>18.4g}"
            f"{row.get('elements_differ', '-'):>22}")
