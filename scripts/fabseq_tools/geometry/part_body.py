# SPDX-License-Identifier: MIT
"""The body of a part in tetrahedra with fields at their points: cut off at the mesh that the part came from,
or else at a smoothed boundary of its elements."""

import numpy as np
from scipy.interpolate import interp1d, interpn

from fabseq_tools.geometry import tetrahedra
from fabseq_tools.geometry.grid import nodes_of, origin_of
from fabseq_tools.geometry.mesh_inside import inside, share_inside
from fabseq_tools.geometry.nearest_surface import mesh_surface
from fabseq_tools.geometry.sharp_edges import sharpen
from fabseq_tools.run.command_line import RunError

FINER = {"mesh": 2, "elements": 1}  # cells per edge of an element
SNAPPED = 1e-3     # of a cell's edge: points so near to the surface lie on it
LEVELS = (0.5, 0.45)  # of the smoothed density, between which the boundary's is interpolated
LEVEL_RANGE = (0.3, 0.7)
EXTRAPOLATED = 3   # nodes beyond the part on which fields go on with their slope
MOST_DIFFERENCE = 0.1  # of the part's volume: a mesh body that differs more has another inside than the program's


def body_of(config, density, fields, finer=None):
    """Tetrahedra of the part, in the config's coordinates, and what they are cut off at: "mesh" or
    "elements". `density` [z][y][x]; `fields`: arrays of the nodes, [z][y][x] or [z][y][x][axis], by name."""
    density = np.asarray(density, float)
    edges = np.array(config["domain"]["size"], float) / density.shape[::-1]
    node_axes = [origin + edge * np.arange(n + 1) for origin, edge, n in zip(origin_of(config), edges, density.shape[::-1])]
    known = nodes_of(density > 0).reshape(np.add(density.shape, 1))
    fields = {name: continued(field, known) for name, field in fields.items()}
    surface = drawn_surface(config)
    source = "mesh" if surface else "elements"
    bounds = np.array(surface.data.GetBounds()).reshape(3, 2) if surface else bounds_of(density, node_axes)
    counts = [max(1, round((high - low) / edge * (finer or FINER[source]))) for (low, high), edge in zip(bounds, edges)]
    axes = [np.linspace(low, high, n + 1) for (low, high), n in zip(bounds, counts)]
    sampled = {name: sample(field, node_axes, axes) for name, field in fields.items()}
    smooth = sample(smoothed(density), node_axes, axes)
    volume = density.sum() * np.prod(edges)
    if surface:  # at open ends the body ends in a plane, and not in the elements' steps
        body = cut_at_mesh(surface.closed(), axes, sampled, smooth > 0, volume)
    else:
        body = cut_at_elements(smooth, axes, sampled, volume)
    return body, source


def drawn_surface(config):
    """The surface of the mesh that a part came from, in the config's coordinates, or None."""
    mesh = config.get("part", {}).get("mesh")
    placement = config.get("run", {}).get("mesh_placement")
    return mesh_surface(mesh["file"], placement) if mesh and placement else None


def bounds_of(density, node_axes):
    places = np.argwhere(density > 0)[:, ::-1]
    return [(axis[low], axis[high + 1]) for axis, low, high in zip(node_axes, places.min(axis=0), places.max(axis=0))]


def cut_at_elements(smooth, axes, fields, volume):
    """The body where a smoothed density is above the level with which it has the part's volume. At the end of
    the part's bounding box it ends in the plane."""
    filled = around(smooth.reshape([len(axis) for axis in axes[::-1]]) > LEVEL_RANGE[0])
    volumes = [cut_body(axes, filled, fields, level - smooth.ravel()).volumes().sum() for level in LEVELS]
    share = (volume - volumes[0]) / (volumes[1] - volumes[0]) if volumes[1] > volumes[0] else 0.0
    level = np.clip(LEVELS[0] + share * (LEVELS[1] - LEVELS[0]), *LEVEL_RANGE)
    return cut_body(axes, filled, fields, level - smooth.ravel())


def cut_at_mesh(surface, axes, fields, near, volume):
    """The body inside the mesh. `near`: grid points next to the part; others lie outside."""
    shape = [len(axis) for axis in axes[::-1]]
    edge = min(axis[1] - axis[0] for axis in axes)
    within = inside(surface.corners, axes)
    near = spread(around(near.reshape(shape)), 1)
    border = spread(around(within) & around(~within), 0) & near
    grid = np.stack([g.ravel() for g in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], axis=1)
    values = np.full(len(grid), edge)
    values[border.ravel()] = surface.nearest(grid[border.ravel()])[2]
    values = np.where((within & near).ravel(), -values, values)
    body = cut_body(axes, around(values.reshape(shape) < 0), fields, values, SNAPPED * edge, surface)
    sharpen(body, surface, edge)
    if abs(body.volumes().sum() - volume) > MOST_DIFFERENCE * volume:
        raise RunError(f"the part's mesh encloses {body.volumes().sum():.6g}, its elements hold {volume:.6g}: they may differ by "
                       f"{100 * MOST_DIFFERENCE:g} %; close the mesh's holes, or take smaller elements")
    return body


def cut_body(axes, filled, fields, values, snapped=1e-6, surface=None):
    """Tetrahedra of the filled cells, where `values` are negative."""
    body = tetrahedra.of_grid(axes, filled)
    body.fields = {name: field.reshape(len(body.points), -1).squeeze() for name, field in fields.items()}
    body.fields["values"] = np.where(np.abs(values) < snapped, 0.0, values)
    body = body.part(slice(None))
    first = len(body.points)
    starts = body.fields["values"]
    values, ends = body.cut(starts)
    if surface is not None:
        move_onto(body, first, ends, starts, surface)
    del body.fields["values"]
    return body.part(~body.side(values))


def move_onto(body, first, ends, starts, surface):
    """New points along their edges onto the surface, from which the distance is not linear."""
    turned = starts[ends[:, 0]] > 0
    ends = np.where(turned[:, None], ends[:, ::-1], ends)  # from inside to outside
    share = share_inside(surface, body.points[ends[:, 0]], body.points[ends[:, 1]])
    linear = starts[ends[:, 0]] / (starts[ends[:, 0]] - starts[ends[:, 1]])
    share = np.where(np.isfinite(share), share, linear)
    for field in (body.points, *body.fields.values()):
        field[first:] = tetrahedra.between(field[:first], ends, share)


def smoothed(density):
    """At the nodes: the mean over the elements around them; at the end of the part's bounding box, over those
    inside it."""
    places = np.argwhere(density > 0)
    box = tuple(slice(low, high + 1) for low, high in zip(places.min(axis=0), places.max(axis=0)))
    result = np.zeros(np.add(density.shape, 1))
    inner = np.pad(density[box], 1, mode="edge")
    mean = sum(inner[tuple(slice(c, c + n - 1) for c, n in zip(corner, inner.shape))] for corner in np.ndindex(2, 2, 2)) / 8.0
    result[tuple(slice(s.start, s.stop + 1) for s in box)] = mean
    return result


def around(nodes):
    """Cells with at least one of the nodes [z][y][x]."""
    return np.logical_or.reduce([nodes[tuple(slice(c, c + n - 1) for c, n in zip(corner, nodes.shape))]
                                 for corner in np.ndindex(2, 2, 2)])


def spread(cells, steps):
    """Nodes of cells, and those up to so many cells away."""
    for step in range(steps + 1):
        nodes = nodes_of(cells).reshape(np.add(cells.shape, 1))
        cells = around(nodes)
    return nodes


def continued(field, known):
    """A field of the nodes with values beyond the part's: first with the slope, then the mean of the nodes
    around. Goes from node to node, so that each is looked at once."""
    rim = [(2, 2)] * known.ndim  # as far as a slope looks
    result = np.pad(np.reshape(field, (*known.shape, -1)).astype(float), [*rim, (0, 0)])
    values, free = result.reshape(-1, result.shape[-1]), np.pad(~known, rim).ravel()
    reached = np.pad(known, rim).ravel()
    strides = np.cumprod([1, *(n + 4 for n in known.shape[:0:-1])])[::-1]
    ways = [side * stride for stride in strides for side in (1, -1)]

    def beside(nodes):
        return np.unique(np.concatenate([next_to[free[next_to]] for next_to in (nodes + way for way in ways)]))

    front, step = beside(np.flatnonzero(reached)), 0
    while len(front):
        total, count = np.zeros((len(front), values.shape[1])), np.zeros(len(front))
        for way in ways:
            near, far = front + way, front + 2 * way
            slope = np.where(reached[far, None] & (step < EXTRAPOLATED), values[near] - values[far], 0.0)
            total += np.where(reached[near, None], values[near] + slope, 0.0)
            count += reached[near]
        values[front] = total / count[:, None]
        free[front], reached[front] = False, True
        front, step = beside(front), step + 1
    return result[(slice(2, -2),) * known.ndim].reshape(np.shape(field))


def sample(field, axes, places):
    """A field of nodes [z][y][x] at the points of another grid; axes and places: coordinates x, y, z."""
    for axis, (at, wanted) in enumerate(zip(axes[::-1], places[::-1])):
        field = interp1d(at, field, axis=axis)(np.clip(wanted, at[0], at[-1]))
    return field


def at_points(field, axes, points):
    """A field [z][y][x] or [z][y][x][axis], linear between the places of a grid of coordinates `axes` (x, y,
    z), at points (n, 3); beyond the grid it stays as it is at the end."""
    within = np.clip(points, [axis[0] for axis in axes], [axis[-1] for axis in axes])
    return interpn(tuple(axes[::-1]), field, within[:, ::-1])
