# SPDX-License-Identifier: MIT
"""Reads what a run left in its output directory, for the tests of this folder."""

import os
import re

import h5py
import numpy as np


def read_result(run, name="result.h5"):
    """Datasets by path."""
    datasets = {}
    with h5py.File(run.path(name), "r") as file:
        def collect(path, entry):
            if isinstance(entry, h5py.Dataset):
                datasets[path] = entry[()]

        file.visititems(collect)
    return datasets


def assert_close(values, expected, tolerance, name):
    """`tolerance` is relative to the largest entry."""
    np.testing.assert_allclose(values, expected, rtol=0, atol=tolerance * np.abs(expected).max(), err_msg=name)


def read_dump(run, iteration):
    """Fields of fields/iteration_NNNN.bin (a number, or NNNN and what follows), read as its .xdmf describes
    them."""
    base = run.path("fields/iteration_" + (iteration if isinstance(iteration, str) else f"{iteration:04d}"))
    with open(base + ".xdmf", encoding="utf-8") as file:
        text = file.read()
    with open(base + ".bin", "rb") as file:
        content = file.read()
    pattern = (r'<Attribute Name="(\w+)"[^>]*>\s*<DataItem Dimensions="([\d ]+)" NumberType="Float" Precision="(\d)" '
               r'Format="Binary" Endian="Little" Seek="(\d+)">([^<]+)<')
    fields, end = {}, 0
    for name, shape, precision, seek, binary in re.findall(pattern, text):
        shape = [int(n) for n in shape.split()]
        assert binary == os.path.basename(base) + ".bin"
        fields[name] = np.frombuffer(content, f"<f{precision}", int(np.prod(shape)), int(seek)).reshape(shape)
        end = max(end, int(seek) + fields[name].nbytes)
    assert end == len(content), f"{len(content)} bytes in {base}.bin, {end} described"
    return fields
