# SPDX-License-Identifier: MIT
"""Interpolation between scattered points at which a field and its gradient are known: radial basis functions
r³ and a linear polynomial (Hermite-Birkhoff, Wendland 2005, chapter 16), each place from its own neighbours.
"""

import numpy as np

SMOOTHING = 1e-6  # of the largest entry: points may coincide
BATCH = 2000      # places at once


def interpolate(places, points, values, gradients, counts):
    """Field (n) and gradient (n, 3) at `places` (n, 3), from their neighbours: `points` and `gradients` (n,
    k, 3), `values` (n, k); `counts` (n, k): which of them are heard."""
    field, slope = np.empty(len(places)), np.empty((len(places), 3))
    for first in range(0, len(places), BATCH):
        own = slice(first, first + BATCH)
        field[own], slope[own] = solve(points[own] - places[own, None], values[own], gradients[own], counts[own])
    return field, slope


def solve(points, values, gradients, counts):
    """The same at the origin of each set of points."""
    n, k, _ = points.shape
    scale = np.maximum(np.linalg.norm(points, axis=2).max(axis=1), 1e-300)[:, None, None]
    points, gradients = points / scale, gradients * scale
    matrix = np.zeros((n, 4 * k + 4, 4 * k + 4))
    value, first, second = kernels(points[:, :, None] - points[:, None])
    both = counts[:, :, None] & counts[:, None]
    value, first, second = (np.where(both.reshape(*both.shape, *[1] * (entry.ndim - 3)), entry, 0.0)
                            for entry in (value, first, second))
    matrix[:, :k, :k] = value
    matrix[:, :k, k:4 * k] = -first.reshape(n, k, 3 * k)
    matrix[:, k:4 * k, :k] = first.transpose(0, 1, 3, 2).reshape(n, 3 * k, k)
    matrix[:, k:4 * k, k:4 * k] = -second.transpose(0, 1, 3, 2, 4).reshape(n, 3 * k, 3 * k)
    heard = counts.astype(float)
    matrix[:, :k, 4 * k] = matrix[:, 4 * k, :k] = heard
    linear = np.where(counts[..., None], points, 0.0)
    matrix[:, :k, 4 * k + 1:] = linear
    matrix[:, 4 * k + 1:, :k] = linear.transpose(0, 2, 1)
    unit = (heard[..., None, None] * np.eye(3)).reshape(n, 3 * k, 3)
    matrix[:, k:4 * k, 4 * k + 1:] = unit
    matrix[:, 4 * k + 1:, k:4 * k] = unit.transpose(0, 2, 1)
    diagonal = np.arange(4 * k)
    weights = np.concatenate([heard, np.repeat(heard, 3, axis=1)], axis=1)
    matrix[:, diagonal, diagonal] += np.where(weights > 0, SMOOTHING, 1.0)  # others: a row of their own
    right = np.concatenate([np.where(counts, values, 0.0), np.where(counts[..., None], gradients, 0.0).reshape(n, 3 * k),
                            np.zeros((n, 4))], axis=1)
    found = np.linalg.solve(matrix, right[..., None])[..., 0]
    sources, dipoles, polynomial = found[:, :k], found[:, k:4 * k].reshape(n, k, 3), found[:, 4 * k:]
    sources, dipoles = np.where(counts, sources, 0.0), np.where(counts[..., None], dipoles, 0.0)
    value, first, second = kernels(-points)
    field = (sources * value).sum(axis=1) - np.einsum("nkx,nkx->n", dipoles, first) + polynomial[:, 0]
    slope = np.einsum("nk,nkx->nx", sources, first) - np.einsum("nkxy,nky->nx", second, dipoles) + polynomial[:, 1:]
    return field, slope / scale[:, 0]


def kernels(away):
    """r³, its gradient and its second derivatives."""
    r = np.linalg.norm(away, axis=-1)
    square = away[..., :, None] * away[..., None, :] / np.maximum(r, 1e-300)[..., None, None]
    return r**3, 3.0 * r[..., None] * away, 3.0 * (r[..., None, None] * np.eye(3) + square)
