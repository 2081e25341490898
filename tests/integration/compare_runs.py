# SPDX-License-Identifier: MIT
"""Whether two runs came to the same bytes."""

import glob
import json
import os

import h5py
import numpy as np

# Of summary and history: what clock, memory and the way there decide.
ASIDE = ("seconds", "peak_memory_bytes")


def reproducible(run, ranks):
    """On three ranks and more PETSc and MUMPS add up in the order in which messages arrive: there two runs of
    the reference path differ in the last digits, restarted or not."""
    return ranks < 3 or run.json("config.json")["solver"]["path"] == "lanes"


def numbers(value):
    """Of a nested list, or a number."""
    if isinstance(value, list):
        for entry in value:
            yield from numbers(entry)
    else:
        yield value


def history_text(run):
    """Lines of the history, as they are printed, less what does not count."""
    lines = run.history()
    for line in lines:
        for key in ASIDE:
            del line[key]
    return [json.dumps(line) for line in lines]


def contents(path):
    """All datasets and attributes of an HDF5 file, as bytes."""
    found = {}

    def take(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = (item.shape, str(item.dtype), item[()].tobytes())
        for key, value in item.attrs.items():
            found[f"{name}@{key}"] = np.asarray(value).tobytes() if not isinstance(value, str) else value

    with h5py.File(path, "r") as file:
        take("", file)
        file.visititems(take)
    return found


def assert_same_run(test, run, expected, ranks):
    """History, summary, result and field dumps are the same to the last bit, where runs can be."""
    history, correct = history_text(run), history_text(expected)
    test.assertEqual(len(history), len(correct), str(run))
    if not reproducible(expected, ranks):
        limit = 1e-6 if expected.json("config.json")["solver"]["tolerance"] <= 1e-10 else 1e-3
        for line, wanted in zip(run.history(), expected.history(), strict=True):
            for key in ("objective", "constraints", "beta", "change"):
                np.testing.assert_allclose(list(numbers(line[key])), list(numbers(wanted[key])), rtol=limit, err_msg=key)
        return
    for line, wanted in zip(history, correct, strict=True):
        test.assertEqual(line, wanted, str(run))
    summary, wanted = run.json("summary.json"), expected.json("summary.json")
    for key in ASIDE:
        del summary[key], wanted[key]
    test.assertEqual(summary, wanted, str(run))
    found, wanted = contents(run.path("result.h5")), contents(expected.path("result.h5"))
    test.assertEqual(set(found), set(wanted))
    test.assertEqual([name for name in wanted if found[name] != wanted[name]], [])
    for path in glob.glob(expected.path("fields/*")):
        with open(path, "rb") as wanted_file, open(os.path.join(run.output, "fields", os.path.basename(path)), "rb") as file:
            test.assertEqual(file.read(), wanted_file.read(), path)
