# SPDX-License-Identifier: MIT
"""Displacements of rigid motions, and displacements without them."""

import itertools

import numpy as np


def rigid_motions(points):
    """Displacements of the points in every rigid motion, linearized, [motion][point][axis]."""
    dimension = points.shape[1]
    motions = [np.tile(row, (len(points), 1)) for row in np.eye(dimension)]
    for a, b in itertools.combinations(range(dimension), 2):
        turn = np.zeros_like(points)
        turn[:, a], turn[:, b] = -points[:, b], points[:, a]
        motions.append(turn)
    return np.array(motions)


def without_rigid_motion(displacements, points):
    """What is left of displacements of points, (n, axis) both, after the best rigid fit."""
    motions = rigid_motions(points - points.mean(axis=0)).reshape(-1, points.size).T
    fit = motions @ np.linalg.lstsq(motions, displacements.ravel(), rcond=1e-9)[0]
    return displacements - fit.reshape(points.shape)
