# SPDX-License-Identifier: MIT
"""Derivatives, at the elements' centres, of fields of nodes or elements."""

import numpy as np


def node_slopes(values, spacing):
    """Derivatives at the elements' centres of a field of the nodes, axis by axis."""
    slopes = []
    for axis, h in enumerate(spacing):
        slope = np.diff(values, axis=axis) / h
        for other in range(values.ndim):
            if other != axis:
                first, last = (slope.take(range(k, slope.shape[other] - 1 + k), axis=other) for k in (0, 1))
                slope = 0.5 * (first + last)
        slopes.append(slope)
    return slopes


def element_slopes(values, built, spacing):
    """The same of a field of the elements: differences to the neighbours that belong to the part."""
    slopes = []
    for axis, h in enumerate(spacing):
        rise = np.diff(values, axis=axis) / h
        both = np.minimum(*(built.take(range(k, built.shape[axis] - 1 + k), axis=axis) for k in (0, 1)))
        edges = [tuple((0, 0) if other != axis else (k, 1 - k) for other in range(values.ndim)) for k in (0, 1)]
        total = sum(np.pad(np.where(both, rise, 0.0), edge) for edge in edges)
        slopes.append(total / np.maximum(sum(np.pad(both, edge).astype(int) for edge in edges), 1))
    return slopes
