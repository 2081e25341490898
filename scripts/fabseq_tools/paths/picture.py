# SPDX-License-Identifier: MIT
"""A picture of the paths of some layers, in the part."""

import numpy as np
from matplotlib import colormaps
from matplotlib import image as matplotlib_image
from vtkmodules.vtkFiltersCore import vtkTubeFilter
from vtkmodules.vtkRenderingCore import vtkRenderer

from fabseq_tools.geometry.grid import origin_of
from fabseq_tools.geometry.vtk_data import cell_array, filtered, poly_data
from fabseq_tools.plot import render_part
from fabseq_tools.plot.camera import View, aim_camera

LAYERS = 5  # in the picture
TUBE = 0.22  # radius, in beads
PIXELS = (1400, 1400)


def draw(part, passes, width, placement, path):
    """Writes the picture. The passes are in the placement's frame."""
    origin = origin_of(part.config)
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    plate = part.config.get("build_plate", "z-")
    frame = render_part.VoxelPart(np.ones((1, 1, 1)), np.array(part.config["domain"]["size"]), plate)
    render_part.add_plate(renderer, frame)
    faces, _, other = part.body.triangles()
    shell = render_part.add_actor(renderer, poly_data(part.body.points - origin, faces[other == -1]),
                                  (0.55, 0.58, 0.62), opacity=0.16)
    shell.GetProperty().FrontfaceCullingOn()  # only its far side, or it would veil the paths
    numbers = sorted({one.layer for one in passes})
    shown = [numbers[k] for k in np.unique(np.linspace(0, len(numbers) - 1, LAYERS + 2).round().astype(int)[1:-1])]
    for one in passes:
        if one.layer in shown:
            colour = colormaps[render_part.LAYER_COLOURS](one.layer / max(numbers))[:3]
            render_part.add_actor(renderer, tube(placement.to_config(one.points) - origin, TUBE * width), colour)
    render_part.add_light(renderer)
    renderer.SetUseDepthPeeling(True)
    renderer.SetMaximumNumberOfPeels(8)
    aim_camera(renderer, View(frame, frame.nodes, PIXELS))
    matplotlib_image.imsave(path, render_part.picture_of(renderer, PIXELS))


def tube(points, radius):
    line = poly_data(points)
    line.SetLines(cell_array(np.arange(len(points))[None]))
    result = filtered(line, vtkTubeFilter(), Radius=radius, NumberOfSides=8, Capping=True)
    result.GetPointData().SetNormals(None)
    return result
