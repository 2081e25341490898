# SPDX-License-Identifier: MIT
"""What the tests of fabseq-tools report share: a made-up run, its page, and a reader of pages."""

import json
import subprocess
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

import h5py
import numpy as np

import fake_results

PROJECT = Path(__file__).resolve().parents[2]

SIZE = (2.0, 1.0, 2.0)
MODELS = ("nominal", "follow")
BLOCKS = {"start design": "start", "planar": "baseline", "planar, 7 layers": "baseline_matched",
          "optimized, smooth": "optimized", "optimized, binary": "binary"}
CHANGES = [{"change": "unchanged", "sequence": {"distortion": [{"name": "objective_0", "length": 0.02}]},
            "planar": {"distortion": [{"name": "objective_0", "length": 0.6}]}, "ratio": {"length": 30.0, "rms": 2.0}},
           {"change": "void quiet", "sequence": {"distortion": [{"name": "objective_0", "length": 0.1}]},
            "planar": {"distortion": [{"name": "objective_0", "length": 0.5}]}, "ratio": {"length": 5.0, "rms": 1.5}},
           {"change": "grid twice as fine", "skipped": "the part is <too> large"}]


def write_run(directory, density, size, noise=0.0):
    """A made-up run with what fake_results leaves out: start design, both deposition models, sensitivity."""
    fake_results.write_run(directory, "v_shape", density, size)
    with h5py.File(directory / "result.h5", "r+") as file:
        for name in ("time", "layer", "displacement"):
            file[f"start/{name}"] = file[name][:] if name != "displacement" else 0.5 * file["planar/displacement"][:]
        if noise:
            for name in ("displacement", "planar/displacement", "start/displacement"):
                file[name][:] += noise * np.random.default_rng(1).standard_normal(file[name].shape)

    def add_models(summary):
        summary["start"] = {**summary["baseline"], "layers": summary["binary"]["layers"]}
        for k, block in enumerate(("start", "baseline", "optimized", "binary"), start=1):
            summary[block]["deposition"] = {
                model: {"displacement": {"max": 0.1 / k + j, "rms": 0.011 / k + j},
                        "nodes": {"max": 0.09 / k, "rms": 0.017 * k},
                        "distortion": [{"name": "objective_0", "value": (0.7 / k + j)**2, "length": 0.7 / k + j}]}
                for j, model in enumerate(MODELS)}

    fake_results.change(directory, "summary.json", add_models)
    fake_results.change(directory, "config.json", lambda config: config.update(process={"deposition": "nominal"}))
    (directory / "sensitivity.json").write_text(json.dumps(
        {"name": "v_shape", "changes": CHANGES,
         "worst": {key: {"ratio": CHANGES[1]["ratio"][key], "change": "void quiet"} for key in ("length", "rms")}}),
        encoding="utf-8")


def report(*arguments):
    words = [PROJECT / "scripts/fabseq-tools", "report", *map(str, arguments)]
    return subprocess.run(["/usr/bin/python3", *words], capture_output=True, text=True, check=False)


class Page(HTMLParser):
    """`loads`: what the page would load. `tables`: rows of cells by the table's id, a cell as its text and
    its title. `text`: all that is to be read."""

    def __init__(self, path):
        super().__init__()
        self.loads, self.tables, self.texts, self.rows, self.in_cell = [], {}, [], None, False
        self.source = path.read_text(encoding="utf-8")
        self.feed(self.source)
        self.text = " ".join(self.texts)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.loads += [attributes[key] for key in ("src", "href", "data", "srcset") if key in attributes]
        if tag == "table":
            self.rows = self.tables.setdefault(attributes.get("id"), [])
        elif tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append(["", attributes.get("title")])
            self.in_cell = True

    def handle_endtag(self, tag):
        self.in_cell = self.in_cell and tag not in ("td", "th")

    def handle_data(self, text):
        if self.cdata_elem:  # a script or a style
            return
        self.texts.append(text.strip())
        if self.in_cell:
            self.rows[-1][-1][0] += text

    def rows_after(self, table, heading):
        """Rows by name, below the heading and above the next one; a row's cells are its numbers."""
        rows = self.tables[table]
        begin = next(k for k, row in enumerate(rows) if row[0][0].startswith(heading)) + 1
        end = next((k for k, row in enumerate(rows) if k >= begin and len(row) == 1), len(rows))
        return {row[0][0]: [None if title is None else float(title) for _, title in row[1:]] for row in rows[begin:end]}


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.solid, cls.flat = (Path(cls.folder.name) / name for name in ("solid", "flat"))
        write_run(cls.solid, fake_results.v_shape_density((20, 10, 20)), SIZE)
        fake_results.add_checks(cls.solid)
        fake_results.add_torch(cls.solid)
        fake_results.write_run(cls.flat, "plate", np.ones((8, 12)), (3.0, 2.0))
        for directory in (cls.solid, cls.flat):
            done = report(directory)
            if done.returncode != 0:
                raise AssertionError(done.stderr)
        cls.page = Page(cls.solid / "report.html")
        cls.summary = json.loads((cls.solid / "summary.json").read_text(encoding="utf-8"))
