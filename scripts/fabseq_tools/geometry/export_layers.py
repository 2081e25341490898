# SPDX-License-Identifier: MIT
"""Writes the layers of a run as closed bodies, and the surfaces between them.

    fabseq-tools layers RUN [--output DIR] [--of optimized|planar|start] [--format stl|vtp|both]
                        [--finer N]

RUN is the output directory of an optimization or a simulation in 3D. DIR (default: RUN/layers) gets
- layer_NNN.stl, .vtp: a closed body per layer. It is cut off at the mesh that the part came from, or else at
  a smoothed boundary of the elements, and at the surfaces to its neighbours.
- interface_NNN.stl, .vtp: the surface at which layer NNN ends, cut off at the part's surface. Both bodies
  beside it have the same triangles there.
- layers.json: files, times, areas, volumes, triangles and bounds.
The points of VTP files have the arrays layer, time, thickness (local, of the layer) and direction (in which
material is added, a unit vector). All is in the part's own coordinates and unit: those of its mesh file or
else of the config. --finer: cells per edge of an element, which decide how fine the triangles are (default: 2
for parts from a mesh, 1 for others). Pieces of a layer's body that no element of the layer stands for become
part of a neighbour. The first line is the run's verdict.
"""

import os

import numpy as np

from fabseq_tools.geometry.layer_bodies import GROUPS, LayeredPart, joined_words
from fabseq_tools.geometry.part_body import drawn_surface
from fabseq_tools.geometry.placement import Placement
from fabseq_tools.geometry.surface_files import boundary, surface_of, write_surface
from fabseq_tools.run.command_line import parser_of, whole_number, write_json
from fabseq_tools.run.progress import SILENT, Progress

COMMAND = "layers"

POINTS_MEASURED = 5000  # of the mesh, when it is compared with what bounds the layers


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("run")
    parser.add_argument("--output", help="directory (default: RUN/layers)")
    parser.add_argument("--of", choices=list(GROUPS), default="optimized", help="whose layers (default: %(default)s)")
    parser.add_argument("--format", choices=["stl", "vtp", "both"], default="both", help="default: %(default)s")
    parser.add_argument("--finer", type=whole_number(1, 8), help="cells per edge of an element")
    arguments = parser.parse_args(words)
    output = arguments.output or os.path.join(arguments.run, "layers")
    formats = ["stl", "vtp"] if arguments.format == "both" else [arguments.format]
    with Progress(COMMAND) as progress:
        part = LayeredPart(arguments.run, arguments.of, arguments.finer, progress)
        record = {"name": part.name, "of": arguments.of, **export(part, output, formats, progress)}
    write_json(os.path.join(output, "layers.json"), record)
    print(part.judged.words())
    for words in joined_words(record):
        print(words)
    print(table(record))
    print(f"in {output}")


def export(part, output, formats, progress=SILENT):
    """Writes all files but the index, and returns what is in that."""
    os.makedirs(output, exist_ok=True)
    placement = Placement(part.config)
    faces, own, other = part.body.triangles()
    volumes = np.bincount(part.body.label, part.body.volumes()) * placement.scale**3
    rows, interfaces = [], []
    for number, layer in progress.steps(part.layers.items(), "writing layer"):
        bounding = faces[own == number]
        row = export_surface(part, placement, layer, bounding, os.path.join(output, f"layer_{number:03}"), formats)
        rows.append({"layer": number, **span(layer, placement), **row, "volume": volumes[number]})
        upper = faces[(own == number) & (other > number)]
        if len(upper):
            row = export_surface(part, placement, layer, upper, os.path.join(output, f"interface_{number:03}"), formats)
            end = {"time": layer.upper} if layer.direction is None else {"height": layer.upper * placement.scale}
            interfaces.append({"layer": number, **end, **row})
    return {**placement.facts(), "cut_off_at": part.source, "time": part.origin,
            "volume": float(volumes.sum()), "volume_of_elements": part.elements_volume * placement.scale**3,
            "distance_from_mesh": distance_from_mesh(part, faces[other == -1], placement),
            "verdict": part.judged.verdict or None, "joined": part.joined_rows(placement.scale), "layers": rows,
            "interfaces": interfaces}


def span(layer, placement):
    """Where a layer begins and ends, in the coordinates of the files."""
    if layer.direction is None:
        return {"times": [layer.lower, layer.upper]}
    return {"subpart": layer.subpart, "heights": [layer.lower * placement.scale, layer.upper * placement.scale],
            "print_direction": placement.directions(layer.direction).tolist()}


def export_surface(part, placement, layer, faces, path, formats):
    """Writes triangles, and returns what the index says of them."""
    used, corners = np.unique(faces, return_inverse=True)
    corners = corners.reshape(-1, 3)
    points = placement.points(part.body.points[used])
    thickness, direction = part.thickness(layer, used)
    data = surface_of(points, corners, {"layer": np.full(len(used), layer.number), "time": part.body.fields["time"][used],
                                        "thickness": thickness * placement.scale, "direction": placement.directions(direction)})
    for form in formats:
        write_surface(data, f"{path}.{form}")
    a, b, c = np.moveaxis(points[corners], 1, 0)
    return {"files": [f"{os.path.basename(path)}.{form}" for form in formats], "triangles": len(corners),
            "open_edges": len(boundary(data)),
            "area": 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()),
            "bounds": [points.min(axis=0).tolist(), points.max(axis=0).tolist()]}


def distance_from_mesh(part, faces, placement):
    """How far points of the outer surface are from the part's mesh, its open ends closed; None where there is
    none."""
    mesh = drawn_surface(part.config) if part.source == "mesh" else None
    if mesh is None:
        return None
    mesh = mesh.closed()
    corners = part.body.points[faces]
    sizes = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    random = np.random.default_rng(1)
    weights = random.exponential(size=(POINTS_MEASURED, 3))
    chosen = random.choice(len(faces), POINTS_MEASURED, p=sizes / sizes.sum())
    points = np.einsum("pc,pcx->px", weights / weights.sum(axis=1, keepdims=True), corners[chosen])
    distances = mesh.nearest(points)[2] * placement.scale
    return {"rms": float(np.sqrt(np.mean(distances**2))), "largest": float(distances.max()), "points": POINTS_MEASURED}


def table(record):
    """The index as lines of text."""
    unit = f" in {record['unit']}" if record["unit"] else ""
    lines = [f"{'layer':>7}{'begins':>10}{'ends':>10}{'volume':>12}{'area':>12}{'triangles':>11}{'open edges':>12}"]
    for row in record["layers"]:
        begins, ends = row.get("times") or row["heights"]
        lines.append(f"{row['layer']:>7}{begins:>10.4g}{ends:>10.4g}{row['volume']:>12.5g}{row['area']:>12.5g}"
                     f"{row['triangles']:>11}{row['open_edges']:>12}")
    share = record["volume"] / record["volume_of_elements"] - 1.0
    lines.append(f"{len(record['layers'])} layers, {len(record['interfaces'])} interfaces, lengths{unit}; volume "
                 f"{record['volume']:.6g}, of the elements {record['volume_of_elements']:.6g} ({100 * share:+.2f} %)")
    if record["distance_from_mesh"]:
        distance = record["distance_from_mesh"]
        lines.append(f"distance of the surface from the mesh: rms {distance['rms']:.3g}, largest {distance['largest']:.3g}")
    return "\n".join(lines)
