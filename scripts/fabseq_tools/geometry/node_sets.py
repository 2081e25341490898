# SPDX-License-Identifier: MIT
"""The nodes of a run's node sets, as the program has found them."""

import numpy as np

from fabseq_tools.run.read_run import lacking


def measured_nodes(run):
    """Numbers of the nodes whose distortion is a run's first term; empty if there are none, or so many that
    marks would hide the part. Raises RunError if the result lacks them."""
    name = run.distortion_config.get("nodes")
    node_set = run.config.get("node_sets", {}).get(name)
    if node_set is None or node_set.get("all") or node_set.get("surface"):
        return np.array([], dtype=int)
    return nodes_of_set(run.fields, name)


def nodes_of_set(fields, name, path="result.h5"):
    """Numbers of the nodes of a node set, x fastest, from the datasets of a file. Raises RunError if
    they are not there."""
    dataset = "model/node_sets/" + name
    if dataset not in fields:
        raise lacking(dataset, path)
    return fields[dataset]
