# SPDX-License-Identifier: MIT
"""-task check -picture: elements by the layers of the start design, the plate, node sets; the data, and the
picture that a tool draws from them."""

import os
import re
import shutil
import xml.etree.ElementTree as ElementTree
from unittest import mock

import h5py
import numpy as np

import run_fabseq
from run_fabseq import PROGRAM, ROOT, FabseqTest
from small_meshes import write_box
from small_parts import hook_3d, plate_2d

SVG = "{http://www.w3.org/2000/svg}"
SCRIPTS = os.path.join(ROOT, "scripts")


class Check:
    """What a run has left: fields, attributes and node sets of check.h5, texts of check.svg."""

    def __init__(self, run):
        with h5py.File(run.path("check.h5"), "r") as file:
            self.layer, self.substrate = file["layer"][...], file["substrate"][...]
            self.box = {name: file[name][...].tolist() for name in ("origin", "spacing")}
            self.attributes = {name: value for name, value in file.attrs.items()}
            self.nodes = {name: nodes[...] for name, nodes in file["node_sets"].items()}
        root = ElementTree.parse(run.path("check.svg")).getroot()
        self.words = ["".join(text.itertext()).strip() for text in root.iter(SVG + "text")]


class CheckPictureTest(FabseqTest):
    def run_check(self, ranks, config, *arguments, program=PROGRAM, output=None):
        path = self.write_config(config)
        with mock.patch.object(run_fabseq, "PROGRAM", program):
            run = self.run_program(ranks, "-config", path, "-task", "check", "-picture", *arguments, output=output)
        self.assert_done(run)
        return run, re.search("^picture: (.*)$", run.stdout, re.MULTILINE).group(1)

    def check(self, config, *arguments):
        files = set()
        for ranks in run_fabseq.distinct(1, 2):
            run, words = self.run_check(ranks, config, *arguments)
            self.assertEqual(words, run.path("check.svg"))
            texts = []
            for name in ("check.h5", "check.svg"):
                with open(run.path(name), "rb") as file:
                    texts.append(file.read())
            files.add(tuple(texts))
        self.assertEqual(len(files), 1)
        return Check(run)

    def test_solids(self):
        check = self.check(hook_3d())
        filled = np.zeros((8, 4, 8), dtype=bool)
        filled[:4], filled[:, :, 5:] = True, True
        np.testing.assert_array_equal(check.layer.T > 0, filled)
        self.assertEqual(set(np.unique(check.layer)), {0, 1, 2, 3})
        self.assertFalse(check.substrate.any())
        self.assertEqual({name: len(nodes) for name, nodes in check.nodes.items()}, {"edge": 5, "top": 45})
        np.testing.assert_array_equal(check.nodes["edge"], [[8, y, 8] for y in range(5)])
        np.testing.assert_allclose(check.box["spacing"], 3 * [0.2])
        self.assertEqual(check.box["origin"], 3 * [0])
        self.assertEqual(check.attributes, {"name": "hook", "unit": "", "plate": "z-", "node_sets/edge": 5,
                                            "node_sets/top": 45})
        self.assertEqual(check.words, ["hook: [8,4,8] elements", "box 1.6 × 0.8 × 1.6", "build plate z-",
                                       "layer 1 of the start design", "layer 3", "node set edge, 5 nodes",
                                       "node set top, 45 nodes"])

    def test_plates(self):
        config = plate_2d()
        config["node_sets"]["a < $c$ & \"d\""] = config["node_sets"]["top"]
        check = self.check(config)
        x, y = np.meshgrid((np.arange(20) + 0.5) / 10, (np.arange(12) + 0.5) / 10)
        np.testing.assert_array_equal(check.layer > 0, (x - 2) ** 2 + (y - 0.6) ** 2 > 0.31 ** 2)
        self.assertEqual(check.layer.max(), 4)
        np.testing.assert_array_equal(check.layer[0], 1)
        self.assertEqual(check.attributes["plate"], "y-")
        self.assertIn("node set a < $c$ & \"d\", 21 nodes", check.words)

    def test_fine_grids(self):
        """All elements, but not all nodes; drawn in blocks."""
        check = self.check(plate_2d(), "-elements", "150,90", "-set", "node_sets.skin.all=true")
        self.assertEqual(check.layer.shape, (90, 150))
        self.assertEqual(check.words[0], "plate: [150,90] elements, drawn in blocks of 3")
        count = check.attributes["node_sets/skin"]
        self.assertGreater(count, 12000)
        self.assertEqual(len(check.nodes["skin"]), -(-count // (count // 2000 + 1)))

    def test_substrate(self):
        config = hook_3d()
        config["substrate"] = {"box": {"min": [0, 0, 0], "max": [0.8, 0.8, 0.4]}}
        check = self.check(config)
        self.assertEqual(np.argwhere(check.substrate.T).tolist(), np.argwhere(np.ones((4, 4, 2))).tolist())
        self.assertFalse((check.layer * check.substrate).any())
        self.assertIn("substrate", check.words)

    def test_what_is_refused(self):
        """Walls that are too thin: the picture shows where."""
        write_box(os.path.join(self.directory, "bar.stl"), (60.0, 20.0, 4.0))
        config = hook_3d()
        config.update(domain={"element": 2.0}, part={"mesh": {"file": "bar.stl"}},
                      node_sets={"edge": {"all": True}, "top": {"all": True}})
        path = self.write_config(config)
        for ranks in run_fabseq.distinct(1, 2):
            run = self.run_program(ranks, "-config", path, "-task", "check", "-picture")
            self.assertEqual(run.status, run_fabseq.BAD_INPUT, str(run))
            self.assertIn("fabseq: /part/mesh: found 2 elements across the wall", run.stderr)
            self.assertEqual(Check(run).layer.shape, (2, 10, 30))

    def assert_not_drawn(self, ranks, program, reason):
        output = os.path.join(self.directory, "output")
        os.makedirs(output, exist_ok=True)
        with open(os.path.join(output, "check.svg"), "w", encoding="utf-8") as file:
            file.write("of a run before\n")
        _, words = self.run_check(ranks, hook_3d(), program=program, output=output)
        self.assertEqual(words, f"fabseq-tools plot-check {output} draws check.svg from check.h5; not drawn now: {reason}")
        self.assertEqual(os.listdir(output), ["check.h5"])

    @run_fabseq.only_release
    def test_where_the_tools_lie(self):
        """Beside the program, in its source tree or on PATH; a tool that is missing or fails does no harm."""
        tree = os.path.join(self.directory, "tree")
        places = [os.path.join(tree, folder) for folder in ("build/release", "scripts")]
        for place in places:
            os.makedirs(place)
        program = shutil.copy(PROGRAM, places[0])
        self.assert_not_drawn(2, program, "no fabseq-tools beside the program, in its source tree or on PATH")
        with mock.patch.dict(os.environ, PATH=f"{SCRIPTS}:{os.environ['PATH']}"):
            run, words = self.run_check(1, hook_3d(), program=program)
            self.assertEqual(words, run.path("check.svg"))
        for place, reason in zip(places, ("no package", "not of MPI")):
            path = os.path.join(place, "fabseq-tools")
            with open(path, "w", encoding="utf-8") as file:
                file.write(f"#!/bin/sh\nenv | grep -q '^OMPI\\|^PMI' || echo {reason} >&2\nexit 1\n")
            os.chmod(path, 0o755)
            self.assert_not_drawn(2, program, reason)
            os.remove(path)


if __name__ == "__main__":
    run_fabseq.main()
