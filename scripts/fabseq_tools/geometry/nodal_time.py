# SPDX-License-Identifier: MIT
"""The pseudo-time of a result at its nodes, and at the ends of its layers."""

import numpy as np

from fabseq_tools.geometry.slopes import element_slopes
from fabseq_tools.run.read_run import lacking


def nodal_time(file, config, group=""):
    """Pseudo-time of the nodes of a sequence in result.h5, and in words where it comes from. `group`: of the
    sequence's datasets, as start/. Raises RunError if the result lacks them."""
    if group + "temperature" in file:
        return 1.0 - file[group + "temperature"][()], "temperature of the nodes"
    if group + "nodal_time" in file:
        return file[group + "nodal_time"][()], "times of the nodes"
    if config.get("sequence", {}).get("location") == "nodes" and group != "planar/":
        raise lacking(group + "nodal_time", file.filename)
    return (times_of_nodes(file[group + "time"][()], file["density"][()] > 0),
            "times of the elements, continued to the nodes")


def layer_times(file, count, group=""):
    """T_0 ... T_N of a sequence in result.h5."""
    inner = file["time_points"][()] if "time_points" in file and not group else np.arange(1, count) / count
    return np.concatenate([[0.0], inner, [1.0]])


def times_of_nodes(time, built):
    """Times of nodes from those of elements, for sequences that have no others: the mean of what the elements
    around a node say there, each continued from its centre with the slope towards its neighbours in the part.
    Right for linear fields, on the part's surface, too."""
    time = np.where(built, time, 0.0)
    slopes = [0.5 * slope for slope in element_slopes(time, built, [1.0] * time.ndim)]
    shape = [n + 1 for n in time.shape]
    total, elements = np.zeros(shape), np.zeros(shape)
    for corner in np.ndindex(*(2,) * time.ndim):
        place = tuple(slice(c, c + n) for c, n in zip(corner, time.shape))
        there = time + sum((2 * c - 1) * slope for c, slope in zip(corner, slopes))
        total[place] += np.where(built, there, 0.0)
        elements[place] += built
    return total / np.maximum(elements, 1)
