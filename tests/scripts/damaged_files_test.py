#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Every command on damaged files, and on files of another kind: one line on stderr and status 2, never a
traceback."""

import contextlib
import importlib
import io

import os
import shutil
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import h5py
import numpy as np

from fabseq_tools import entry
from fabseq_tools.run.command_line import RunError, run_script

import fake_results
from run_fabseq import PROGRAM

BYTES = bytes(range(255, -1, -1)) * 8
NO_CONFIGS = {"bytes": BYTES, "a list": b"[1, 2]", "a list of other things": b'{"domain": [1], "layers": 7}',
              "half": b'{"name": "p', "nothing": b"", "an empty object": b"{}", "null": b"null", "too deep": b"[" * 100_000}
NO_HISTORIES = {"bytes": BYTES, "a broken line": b'{"iteration": 0, "obj}\n{"iteration": 1}\n', "a list": b"[1, 2]\n",
                "other things": b'{"iteration": 0}\n{"iteration": "a"}\n', "half": b'{"iteration": 0, "objective": 7}\n'}
NO_RESULTS = {"missing": None, "bytes": BYTES, "nothing": b"", "half": "half", "an empty file of HDF5": "empty",
              "a file of HDF5 with other data": "other"}
OF_A_RUN = {"config.json": NO_CONFIGS, "summary.json": NO_CONFIGS, "history.jsonl": NO_HISTORIES, "result.h5": NO_RESULTS}
# Words of each command, with {run} for the output directory, and the files in it that it reads.
RUNS = {"report": (["{run}"], ["config.json", "result.h5"]), "overview": (["{run}"], list(OF_A_RUN)),
        "render": (["{run}/result.h5", "{run}/part.png"], ["config.json", "result.h5"]),
        "compare": (["{run}", "{run}", "--table", "{run}/t.csv", "--picture", "{run}/p.png"], ["config.json", "summary.json"]),
        "plot-history": (["{run}", "--picture", "{run}/p.png"], ["history.jsonl"]),
        "plot-check": (["{run}"], ["check.h5"]), "plot-gradients": (["{run}"], ["gradient_check.json"]),
        "plot-sensitivity": (["{run}"], ["sensitivity.json"]),
        "plot-settings": (["{run}/..", "--picture", "{run}/p.png"], ["config.json", "summary.json"]),
        "scaling": (["{run}", "--table", "{run}/t.csv", "--picture", "{run}/p.png"], ["config.json", "history.jsonl"]),
        "thickness": (["{run}"], ["config.json", "summary.json", "result.h5"]),
        "layers": (["{run}"], ["config.json", "summary.json", "result.h5"]),
        "paths": (["{run}", "--bead-width", "0.2"], ["config.json", "summary.json", "result.h5"]),
        "import-paths": (["{run}/paths.csv", "{run}"], ["config.json", "paths.csv"]),
        "compensate": (["{run}"], ["config.json", "summary.json", "result.h5"]),
        "repair": (["{run}"], ["config.json", "summary.json", "result.h5"]),
        "calculix": (["{run}"], ["config.json", "summary.json", "result.h5"]),
        "compare-calculix": (["{run}", "{run}/finished.dat"], ["config.json", "summary.json", "result.h5", "finished.dat"]),
        "calibrate": (["{run}/config.json", "{run}/paths.csv", "--output", "{run}/out"], ["config.json"]),
        "coarsen": (["{run}/result.h5", "{run}/coarse.h5", "2", "0.5"], ["result.h5"]),
        "orient": (["{run}/config.json", "--output", "{run}/out"], ["config.json"]),
        "new": (["{run}/part.stl", "--output", "{run}/new.json"], ["part.stl"]),
        "plan": (["{run}/part.stl", "--machine", "large_bead", "--output", "{run}/out"], ["part.stl"])}
WITHOUT_FILES = {"virtual-display", "tradeoff", "compare-families"}  # study_tools_test.py has those of the last two
STILL_DRAWN = {"an empty object", "other things"}  # what some can do without
WITHOUT_FIELDS = "report", {"missing", "an empty file of HDF5"}  # figures only
PROGRAM_LOOKS = {"part.stl": {"bytes": BYTES}, "paths.csv": {**NO_CONFIGS, "bytes": BYTES}, "finished.dat": {"bytes": BYTES}}
IMAGE = np.zeros((40, 40, 3), np.uint8)


class DamagedFilesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.whole, self.run_folder = Path(folder.name) / "whole", Path(folder.name) / "group" / "run_absent"
        self.whole.mkdir()
        fake_results.write_run(str(self.whole), "part", np.ones((4, 4, 6)), (3.0, 2.0, 2.0), iterations=5)
        for name in ("part.stl", "finished.dat"):
            (self.whole / name).write_text("", encoding="utf-8")
        (self.whole / "paths.csv").write_text("x,y,z,layer\n1,1,1,1\n2,1,1,1\n", encoding="utf-8")

    def damage(self, name, content):
        shutil.rmtree(self.run_folder, ignore_errors=True)
        shutil.copytree(self.whole, self.run_folder)
        path = self.run_folder / name
        if content is None:
            path.unlink(missing_ok=True)
        elif content == "half":
            whole = (self.whole / "result.h5").read_bytes()
            path.write_bytes(whole[:len(whole) // 2])
        elif isinstance(content, str):
            with h5py.File(path, "w") as file:
                for dataset in ("density", "layer", "time", "displacement", "substrate", "spacing") if content == "other" else ():
                    file[dataset] = np.arange(3.0)
        else:
            path.write_bytes(content)

    def status_of(self, command, words):
        """The exit status and what is said on stderr."""
        module = importlib.import_module(entry.find_commands()[command].module)
        said = io.StringIO()
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said), contextlib.ExitStack() as stack:
            stack.enter_context(mock.patch.dict(os.environ, DISPLAY=":0"))  # which nobody looks at, as nothing is rendered
            stack.enter_context(mock.patch("fabseq_tools.plot.render_part.render", lambda *_, **__: IMAGE))
            os.environ.pop("FABSEQ_TRACEBACK", None)
            try:
                run_script(lambda: module.main(words), command, words)
                status = 0
            except SystemExit as end:
                status = end.code
        return status, said.getvalue()

    def test_every_command(self):
        self.assertEqual(set(RUNS) | WITHOUT_FILES, set(entry.find_commands()))
        for command, (words, files) in RUNS.items():
            words = [word.format(run=self.run_folder) for word in words]
            words += ["--program", PROGRAM] * (command in ("calibrate", "orient", "new", "plan"))
            for name in files:
                faults = OF_A_RUN.get(name) or PROGRAM_LOOKS.get(name) or (NO_RESULTS if name.endswith(".h5") else NO_CONFIGS)
                for fault, content in faults.items():
                    with self.subTest(command=command, file=name, fault=fault):
                        self.damage(name, content)
                        status, said = self.status_of(command, words)
                        lines = [line for line in said.splitlines() if ": warning: " not in line]
                        self.assertNotIn("Traceback", said)
                        if status == 0 and (fault in STILL_DRAWN or command == WITHOUT_FIELDS[0] and fault in WITHOUT_FIELDS[1]):
                            continue
                        self.assertEqual((status, len(lines)), (2, 1), said)
                        self.assertTrue(lines[0].startswith(f"fabseq-tools {command}: "), said)

    def test_places_are_named(self):
        for name, content, command, words in (
                ("history.jsonl", NO_HISTORIES["a broken line"], "plot-history", "history.jsonl, line 1: is no JSON"),
                ("history.jsonl", NO_HISTORIES["a list"], "scaling", "history.jsonl, line 1: found a list; allowed: an object"),
                ("config.json", b"[1, 2]", "report", "config.json: found a list; allowed: an object"),
                ("config.json", NO_CONFIGS["a list of other things"], "orient", "/domain: found a list; allowed: an object"),
                ("paths.csv", BYTES, "import-paths", "paths.csv: is no text; allowed: a table"),
                ("result.h5", None, "overview", "result.h5 cannot be read")):
            self.damage(name, content)
            status, said = self.status_of(command, [word.format(run=self.run_folder) for word in RUNS[command][0]])
            self.assertEqual(status, 2)
            self.assertIn(words, said)


class OtherErrorsTest(unittest.TestCase):
    def said(self, error, **variables):
        def main():
            raise error
        said = io.StringIO()
        with contextlib.redirect_stderr(said), mock.patch.dict(os.environ, variables), self.assertRaises(BaseException) as caught:
            run_script(main, "report", [os.getcwd()])
        return caught.exception, said.getvalue()

    def test_what_nobody_foresaw(self):
        end, said = self.said(KeyError("layers"))
        self.assertEqual((end.code, said.count("\n")), (2, 1))
        self.assertIn(f"cannot use {os.getcwd()}: a file there is damaged, of another version", said)
        self.assertIn("KeyError 'layers'", said)
        self.assertEqual(self.said(RunError("a line\nand another"))[1], "fabseq-tools report: a line and another\n")
        self.assertEqual(self.said(KeyboardInterrupt())[0].code, 130)
        self.assertIsInstance(self.said(KeyError("layers"), FABSEQ_TRACEBACK="1")[0], KeyError)


if __name__ == "__main__":
    unittest.main()
