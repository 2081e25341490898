# SPDX-License-Identifier: MIT
"""What of a layer's body no element of the layer stands for: slivers, which become part of a neighbour, since
the checks of a run have judged elements."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from fabseq_tools.geometry.tetrahedra import FACES, shared

NEAR = 1.0  # diagonals of an element: within, one of the layer's own stands for a place


def join_slivers(body, judged):
    """Gives the slivers of layers to their neighbours: layers without an element, and pieces without an
    element of their layer near. Volumes by layer."""
    if judged.layer is None:
        return {}
    return {number: volume for number in np.unique(body.label) if (volume := join(body, judged, number, pieces_without))}


def join_thin_ends(body, judged, layers):
    """The same of places that no element of their layer is near to, where the layer is thick enough to hold
    one: its thin ends at the part's surface."""
    if judged.thickness is None:
        return {}
    edge = judged.edges.max()
    return {number: volume for number in layers if judged.range(number) and judged.range(number)[0] >= edge
            and (volume := join(body, judged, number, far_from_elements))}


def join(body, judged, number, find):
    """The volume that a layer loses."""
    own = np.flatnonzero(body.label == number)
    centres = body.points[body.corners[own]].mean(axis=1)
    chosen = find(body, judged, number, own, centres) if judged.holds(number) else np.ones(len(own), bool)
    if not chosen.any():
        return 0.0
    left = np.array([other for other in np.unique(judged.layer) if other > 0])
    below, above = left[left < number], left[left > number]
    neighbours = [*below[-1:], *above[:1]]
    if not neighbours:
        return 0.0
    distances = [judged.distance(other, centres[chosen]) for other in neighbours]
    body.label[own[chosen]] = np.array(neighbours)[np.argmin(distances, axis=0)]
    return float(body.volumes(own[chosen]).sum())


def far_from_elements(_, judged, number, __, centres):
    return judged.distance(number, centres) > NEAR * np.linalg.norm(judged.edges)


def pieces_without(body, judged, number, own, centres):
    """Connected pieces of which no place is near to an element of the layer."""
    piece = pieces(body.corners[own])
    near = ~far_from_elements(body, judged, number, own, centres)
    return ~np.isin(piece, np.unique(piece[near]))


def pieces(corners):
    """The number of the connected piece of each tetrahedron."""
    first, second = (places // 4 for places in shared(corners[:, FACES].reshape(-1, 3)))
    links = coo_matrix((np.ones(len(first)), (first, second)), shape=(len(corners),) * 2)
    return connected_components(links, directed=False)[1]
