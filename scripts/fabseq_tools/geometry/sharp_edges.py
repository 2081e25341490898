# SPDX-License-Identifier: MIT
"""Keeps the sharp edges of a mesh in the surface of a body that was cut off at it: no edge of that surface
may pass a sharp edge without a point on it."""

import numpy as np

SMOOTH = np.cos(np.radians(30.0))  # normals that differ less belong to one smooth face
FARTHEST = 1.1  # of a cell's edge: points move no farther
SMALLEST = 0.03  # eigenvalues below so much of the largest: planes do not say where to go


def sharpen(body, surface, edge):
    """Moves points of the body's surface onto sharp edges of the mesh surface nearby. `edge`: of a cell."""
    faces, _, _ = body.triangles()
    used, corners = np.unique(faces, return_inverse=True)
    corners = corners.reshape(-1, 3)
    points = body.points[used]
    _, normals, _ = surface.nearest(points)
    pairs = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    pairs = pairs[np.einsum("ni,ni->n", normals[pairs[:, 0]], normals[pairs[:, 1]]) < SMOOTH]
    moving, other = nearer_ends(pairs, points, normals)
    matrix, right = np.zeros((len(points), 3, 3)), np.zeros((len(points), 3))
    np.add.at(matrix, moving, normals[other, :, None] * normals[other, None, :])
    np.add.at(right, moving, normals[other] * height(points, normals, moving, other)[:, None])
    chosen = np.unique(moving)
    matrix[chosen] += normals[chosen, :, None] * normals[chosen, None, :]  # each stays on its own face
    move = np.einsum("nij,nj->ni", np.linalg.pinv(matrix[chosen], rcond=SMALLEST, hermitian=True), right[chosen])
    near = np.linalg.norm(move, axis=1) <= FARTHEST * edge
    body.points[used[chosen[near]]] += move[near]


def height(points, normals, moving, other):
    """How far the plane at `other` lies from the points `moving`, along its normal."""
    return np.einsum("ni,ni->n", normals[other], points[other] - points[moving])


def nearer_ends(pairs, points, normals):
    """Of two points on different faces, the one that is nearer to the other's face, and the other."""
    first, second = pairs.T
    turned = np.abs(height(points, normals, second, first)) < np.abs(height(points, normals, first, second))
    return np.where(turned, second, first), np.where(turned, first, second)
