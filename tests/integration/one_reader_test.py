# SPDX-License-Identifier: MIT
"""The tools see the mesh that the program has filled with elements, whatever its file is like."""

import json
import os
import subprocess

import numpy as np

import run_fabseq
from mesh_test import bar, box_triangles, stl_text
from run_fabseq import ENVIRONMENT, PROGRAM, ROOT, FabseqTest
from three_mf_files import write_prusa_slicer

TOP = 21.8  # no multiple of an element's edge, so that a wrong height is seen
BLOCK = box_triangles(np.zeros(3), np.array([30, 20, TOP]))


def obj_text(triangles):
    """With a weight of 2 at each vertex, by which coordinates are divided."""
    points, numbers = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    lines = ["v {:.9g} {:.9g} {:.9g} 2".format(*point) for point in 2 * points]
    return "\n".join([*lines, *("f {} {} {}".format(*face) for face in numbers.reshape(-1, 3) + 1), ""])


class OneReaderTest(FabseqTest):
    def files(self):
        """Files by name, with their content, and their volumes and numbers of triangles as the program reads
        them."""
        commas = stl_text(BLOCK).replace("21.8", "21,8")
        apart = box_triangles(np.array([20.0, 0, 0]), np.array([50, 20, TOP]))
        flipped = stl_text(np.concatenate([BLOCK, apart[:, ::-1]]))
        return {"comma_z.stl": (commas, 1, 12), "comma.stl": (commas.replace("30 ", "30,0 "), 1, 12),
                "weight.obj": (obj_text(BLOCK), 1, 12), "overlap_flip.stl": (flipped, 5 / 3, 24)}

    def write_all(self):
        found = self.files()
        for name, (text, _, _) in found.items():
            with open(os.path.join(self.directory, name), "w", encoding="utf-8") as file:
                file.write(text)
        write_prusa_slicer(os.path.join(self.directory, "negative.3mf"), ("ModelPart", BLOCK),
                           ("NegativeVolume", box_triangles(np.array([10.0, 5, -1]), np.array([20.0, 15, 30]))),
                           ("SupportBlocker", box_triangles(np.array([60.0, 0, 0]), np.array([70.0, 10, 40]))))
        return {**{name: facts[1:] for name, facts in found.items()}, "negative.3mf": (5 / 6, None)}

    def config(self, name, element=5.0):
        return {**bar(file=name, least_elements=0), "domain": {"element": element, "unit": "mm"}, "sequence": {"type": "planar"}}

    def tool(self, *words):
        return subprocess.run(["/usr/bin/python3", os.path.join(ROOT, "scripts", "fabseq-tools"), *words], capture_output=True,
                              text=True, cwd=self.directory, check=False,
                              env={**ENVIRONMENT, **os.environ, "FABSEQ_PROGRAM": PROGRAM})

    def test_surface(self):
        """What -task surface writes, moved and scaled; the file is one that the program reads again."""
        for name, (volume, triangles) in self.write_all().items():
            config = self.config(name)
            config["part"]["mesh"] |= {"rotate": [["x", 90]], "scale": 2.0}
            run = self.run_config(1, config, "-task", "surface")
            self.assert_done(run)
            self.assertEqual(os.listdir(run.output), ["surface.ply"])
            if triangles:
                self.assertIn(f"surface: {triangles} triangles in ", run.stdout)
            again = self.config(run.path("surface.ply"))
            checked = self.run_config(1, again, "-task", "check")
            self.assert_done(checked)
            self.assertIn(f"volume {8 * 30 * 20 * TOP * volume:.6g};", checked.stdout, name)
            self.assertIn(f"] to [{100 if 'flip' in name else 60},", checked.stdout)

    def test_layers(self):
        """They end at the surface, and not where another reader thinks that it ends."""
        for name, (volume, _) in self.write_all().items():
            run = self.run_config(1, self.config(name), "-task", "simulate")
            self.assert_done(run)
            done = self.tool("layers", run.output, "--format", "stl")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            with open(run.path("layers/layers.json"), encoding="utf-8") as file:
                record = json.load(file)
            self.assertEqual(record["cut_off_at"], "mesh")
            self.assertAlmostEqual(max(row["bounds"][1][2] for row in record["layers"]), TOP, delta=1e-4)
            self.assertAlmostEqual(record["volume"] / (30 * 20 * TOP * volume), 1.0, delta=2e-3, msg=name)

    def test_meshes_that_are_not_there(self):
        self.write_all()
        run = self.run_config(1, self.config("comma_z.stl"), "-task", "simulate")
        self.assert_done(run)
        os.remove(os.path.join(self.directory, "comma_z.stl"))
        refused = self.tool("layers", run.output)
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(refused.stderr, r"^fabseq-tools layers: '.*comma_z.stl': cannot be opened .*, needs a readable file\n$")
        run = self.run_config(1, {"name": "box", "part": {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}}}, "-task", "surface")
        self.assertEqual((run.status, run.messages()),
                         (2, ["fabseq: /part/mesh: missing; allowed with -task surface: a part that comes from a mesh file"]))


if __name__ == "__main__":
    run_fabseq.main()
