# SPDX-License-Identifier: MIT
"""Draws one picture of the part of a result, coloured, as it is or displaced.

    fabseq-tools render RESULT.h5 PICTURE.png [--planar] [--exaggeration F]
                        [--colour layer|time|density|displacement|interpass_temperature]

RESULT.h5 lies beside the config.json of its run, which holds the size of the box. The interpass temperature,
with a bar of colours in degrees C, needs a config with a block thermal. Without a display the picture is
drawn in memory. As a module it gives render(): pictures of voxel parts with VTK.
"""

import itertools
import os

import h5py
import numpy as np
from matplotlib import colormaps
from matplotlib import image as matplotlib_image
from matplotlib.colors import to_rgb
from vtkmodules import vtkRenderingOpenGL2  # noqa: F401 (registers the renderer)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import (vtkActor, vtkLight, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)

from fabseq_tools.geometry.grid import in_space, node_positions
from fabseq_tools.geometry.vtk_data import poly_data
from fabseq_tools.plot.camera import MARGIN, View, aim_camera
from fabseq_tools.plot.colour_bar import BAR_SHARE, with_bar
from fabseq_tools.plot.virtual_display import ensure_display
from fabseq_tools.run.command_line import RunError, non_negative, parser_of, whole_number
from fabseq_tools.run.read_run import lacking, read_json
from fabseq_tools.run.verdict_words import FAULTS

COMMAND = "render"

LAYER_COLOURS = "viridis"
DISPLACEMENT_COLOURS = "YlOrRd"
TEMPERATURE = "interpass_temperature"
TEMPERATURE_COLOURS = "plasma"
NO_FAULT = "#e4e7eb"
PLATE_COLOUR = (0.84, 0.85, 0.87)
MOST_ELEMENTS_WITH_EDGES = 48  # along the longest side; finer grids would turn grey


class VoxelPart:
    """Which elements of a box are there. `density` has axes [z][y][x] (2D [y][x]); `size` is x, y(, z) in
    length units. `nodes`: coordinates of all nodes, (n, 3), x fastest. `faces`: node numbers of the surface's
    quadrilaterals, (m, 4). `face_element`: the element behind each of them."""

    def __init__(self, density, size, plate="z-"):
        self.density, self.size, self.plate, self.dimension = density, size, plate, density.ndim
        self.nodes = in_space(node_positions(size, density.shape[::-1]))
        self.faces, self.face_element = surface(density > 0)


def surface(present):
    """Quadrilaterals between an element that is there and one that is not: (node numbers (m, 4), element
    numbers (m,)). In 2D the elements themselves."""
    square = np.array([(0, 0), (0, 1), (1, 1), (1, 0)])
    if present.ndim == 2:
        found = [(np.argwhere(present), square)]
    else:
        padded, found = np.pad(present, 1), []
        for axis, side in itertools.product(range(3), (0, 1)):
            beyond = np.roll(padded, 1 - 2 * side, axis)[1:-1, 1:-1, 1:-1]
            corners = np.insert(square, axis, side, axis=1)
            # Anticlockwise seen from outside.
            found.append((np.argwhere(present & ~beyond), corners if (side == 1) == (axis != 1) else corners[::-1]))
    nodes = np.concatenate([elements[:, None] + corners for elements, corners in found])
    elements = np.concatenate([elements for elements, _ in found])
    return (np.ravel_multi_index(np.moveaxis(nodes, 2, 0), np.add(present.shape, 1)),
            np.ravel_multi_index(elements.T, present.shape))


def layer_colours(part, layer, count):
    """One colour per face (m, 3) bytes: along the colour map by layer, every other layer a shade darker."""
    index = np.asarray(layer).ravel()[part.face_element]
    colours = colormaps[LAYER_COLOURS]((index - 0.5) / max(count, 1))[:, :3]
    colours *= np.where(index % 2 == 0, 0.84, 1.0)[:, None]
    return (255 * colours).astype(np.uint8)


def fault_colours(part, layer, fault):
    """One colour per face (m, 3) bytes: that of the kind of fault, grey where there is none; every other
    layer a shade darker."""
    index = np.asarray(layer).ravel()[part.face_element]
    palette = np.array([to_rgb(NO_FAULT), *(to_rgb(colour) for _, _, colour in FAULTS)])
    colours = palette[np.asarray(fault).astype(int).ravel()[part.face_element]]
    colours *= np.where(index % 2 == 0, 0.84, 1.0)[:, None]
    return (255 * colours).astype(np.uint8)


def scalar_colours(values, largest, name, least=0.0):
    """Colours (n, 3) bytes of `values` between `least` and `largest` in the colour map `name`."""
    return (255 * colormaps[name]((np.ravel(values) - least) / ((largest - least) or 1.0))[:, :3]).astype(np.uint8)


def node_vectors(part, displacement):
    """`displacement` [z][y][x][component] as (n, 3)."""
    return in_space(np.asarray(displacement, dtype=float).reshape(len(part.nodes), part.dimension))


def render(part, face_colours=None, node_colours=None, offset=None, ghost=False, pixels=(1400, 1400), frame=None, marked=None):
    """A picture (height, width, 3) bytes of `part` on its plate, white behind, in parallel projection.

    `face_colours` (per face) or `node_colours` (per node): bytes (., 3). `offset` (n, 3): drawn displacement
    of the nodes. `ghost`: the undisplaced part as a pale shell behind. `frame`: the points (k, 3) that have
    to fit in; pictures with the same frame and pixels have the same view and scale. `marked`: node numbers
    drawn as dots.
    """
    points = part.nodes if offset is None else part.nodes + offset
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    add_plate(renderer, part)
    if ghost:
        add_ghost(renderer, part)
    add_surface(renderer, part, points, face_colours, node_colours)
    if marked is not None and len(marked):
        add_dots(renderer, part, points[marked])
    if part.dimension == 3:
        add_light(renderer)
    renderer.SetUseDepthPeeling(True)
    renderer.SetMaximumNumberOfPeels(8)
    aim_camera(renderer, View(part, points if frame is None else frame, pixels))
    return picture_of(renderer, pixels)


def picture_of(renderer, pixels):
    """What a renderer shows, (height, width, 3) bytes."""
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)  # depth peeling does not go with it; pictures are drawn large and shrunk instead
    window.SetAlphaBitPlanes(True)
    window.SetSize(*pixels)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    image = grab.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3].copy()


def add_actor(renderer, data, colour=None, opacity=1.0, lit=True):
    """Draws surfaces, in one colour where it is given."""
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToFlat()
    look.SetAmbient(0.45)
    look.SetDiffuse(0.55)
    look.SetOpacity(opacity)
    look.SetLighting(lit)
    if colour:
        look.SetColor(*colour)
    renderer.AddActor(actor)
    return actor


def add_surface(renderer, part, points, face_colours, node_colours):
    data = poly_data(points, part.faces)
    for attributes, colours in ((data.GetCellData(), face_colours), (data.GetPointData(), node_colours)):
        if colours is not None:
            attributes.SetScalars(numpy_to_vtk(np.ascontiguousarray(colours), deep=True))
    actor = add_actor(renderer, data, lit=part.dimension == 3)
    actor.GetMapper().SetResolveCoincidentTopologyToPolygonOffset()
    if max(part.density.shape) <= MOST_ELEMENTS_WITH_EDGES:
        edges = add_actor(renderer, poly_data(points, part.faces), (0, 0, 0), opacity=0.10, lit=False)
        edges.GetProperty().SetRepresentationToWireframe()
        edges.GetProperty().SetLineWidth(2.0)


def add_light(renderer):
    """One far lamp such that top, front and right faces of a voxel each have their own, bright shade."""
    toward_lamp = np.array((0.40, -0.75, 1.0))
    light = vtkLight()
    light.SetLightTypeToSceneLight()
    light.SetPositional(False)
    light.SetPosition(*toward_lamp)
    light.SetFocalPoint(0.0, 0.0, 0.0)
    light.SetIntensity(np.linalg.norm(toward_lamp))
    renderer.AddLight(light)


def add_ghost(renderer, part):
    solid = part.dimension == 3
    behind = (0, 0, 0 if solid else 1e-3 * max(part.size))
    shell = poly_data(part.nodes - behind, part.faces)
    actor = add_actor(renderer, shell, (0.55, 0.58, 0.62), opacity=0.16 if solid else 0.35, lit=solid)
    if solid:
        actor.GetProperty().FrontfaceCullingOn()  # only its far side, or it would veil the displaced part


def add_plate(renderer, part):
    """The build plate: a thin grey slab beyond its face of the box, a little larger than the box."""
    axis, gap, margin = "xyz".index(part.plate[0]), 1e-3 * max(part.size), MARGIN * max(part.size)
    low, high = np.full(part.dimension, -margin), np.array(part.size) + margin
    if part.plate[1] == "-":
        low[axis], high[axis] = -0.7 * margin - gap, -gap
    else:
        low[axis], high[axis] = part.size[axis] + gap, part.size[axis] + 0.7 * margin + gap
    slab = VoxelPart(np.ones((1,) * part.dimension), high - low)
    add_actor(renderer, poly_data(slab.nodes + in_space(low[None]), slab.faces), PLATE_COLOUR, lit=part.dimension == 3)


def add_dots(renderer, part, points):
    for point in points:
        ball = vtkSphereSource()
        ball.SetCenter(*point)
        ball.SetRadius(0.011 * max(part.size))
        ball.SetThetaResolution(16)
        ball.SetPhiResolution(16)
        ball.Update()
        data = ball.GetOutput()
        data.GetPointData().SetNormals(None)
        add_actor(renderer, data, (0.10, 0.11, 0.13), lit=False)


def field_of(file, name, config):
    """A dataset of a result, which without heat has no temperature."""
    if name in file:
        return file[name][:]
    if name.endswith(TEMPERATURE) and "thermal" not in config:
        raise RunError(f"{file.filename}: found no {name}, since the run's config has no block thermal; allowed: other colours")
    raise lacking(name, file.filename)


def colours_of(part, colour, values):
    """What render() takes as colours, and the least and the largest value where a bar shows them."""
    if colour == "layer":
        return {"face_colours": layer_colours(part, values, int(values.max()))}, None
    if colour == "displacement":
        length = np.linalg.norm(node_vectors(part, values), axis=1)
        largest = length[np.unique(part.faces)].max()
        return {"node_colours": scalar_colours(length, largest, DISPLACEMENT_COLOURS)}, None
    if colour == TEMPERATURE:
        there = values[part.density > 0]
        ends = float(there.min()), float(there.max())
        colours = scalar_colours(np.ravel(values)[part.face_element], ends[1], TEMPERATURE_COLOURS, ends[0])
        return {"face_colours": colours}, ends
    return {"face_colours": scalar_colours(values, 1.0, LAYER_COLOURS)[part.face_element]}, None


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("result")
    parser.add_argument("picture")
    parser.add_argument("--colour", choices=["layer", "time", "density", "displacement", TEMPERATURE], default="layer")
    parser.add_argument("--planar", action="store_true", help="the planar baseline instead of the optimized sequence")
    parser.add_argument("--exaggeration", type=non_negative, default=0.0, help="draw the displacement, this many times larger")
    parser.add_argument("--pixels", type=whole_number(100, 10_000), default=1400)
    arguments = parser.parse_args(words)
    ensure_display()
    config = read_json(os.path.dirname(os.path.abspath(arguments.result)), "config.json")
    group = "planar/" if arguments.planar else ""
    with h5py.File(arguments.result) as file:
        part = VoxelPart(file["density"][:], config["domain"]["size"], config.get("build_plate", "z-"))
        values = field_of(file, arguments.colour if arguments.colour == "density" else group + arguments.colour, config)
        offset = None
        if arguments.exaggeration:
            offset = arguments.exaggeration * node_vectors(part, file[group + "displacement"][:])
    colours, ends = colours_of(part, arguments.colour, values)
    width = arguments.pixels if ends is None else round((1.0 - BAR_SHARE) * arguments.pixels)
    picture = render(part, offset=offset, ghost=offset is not None, pixels=(width, arguments.pixels), **colours)
    if ends:
        picture = with_bar(picture, *ends, TEMPERATURE_COLOURS, "temperature after the layer's pause, °C")
    matplotlib_image.imsave(arguments.picture, picture)
