# SPDX-License-Identifier: MIT
"""Runs under a locale with decimal commas and points between thousands, set before main by a library of
others: input is read, and output written, as without it."""

import os
import re
import subprocess
import zipfile
from pathlib import Path

import numpy as np

import run_fabseq
from compare_runs import assert_same_run, contents
from mesh_test import HIGH, LOW, bar, box_triangles, stl_text
from run_fabseq import DONE, PROGRAM, FabseqTest, Process, Result, distinct
from small_parts import plate_2d

LOCALE = "de_DE.UTF-8"


def obj_text(triangles):
    """As the two below, of a mesh whose triangles share no vertices."""
    vertices = "".join("v {:.9g} {:.9g} {:.9g}\n".format(*x) for x in triangles.reshape(-1, 3))
    return vertices + "".join(f"f {3 * n + 1} {3 * n + 2} {3 * n + 3}\n" for n in range(len(triangles)))


def ply_text(triangles):
    header = (f"ply\nformat ascii 1.0\nelement vertex {3 * len(triangles)}\nproperty float x\nproperty float y\n"
              f"property float z\nelement face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    vertices = "".join("{:.9g} {:.9g} {:.9g}\n".format(*x) for x in triangles.reshape(-1, 3))
    return header + vertices + "".join(f"3 {3 * n} {3 * n + 1} {3 * n + 2}\n" for n in range(len(triangles)))


def write_3mf(path, triangles):
    vertices = "".join('<vertex x="{:.9g}" y="{:.9g}" z="{:.9g}"/>'.format(*x) for x in triangles.reshape(-1, 3))
    faces = "".join(f'<triangle v1="{3 * n}" v2="{3 * n + 1}" v3="{3 * n + 2}"/>' for n in range(len(triangles)))
    schemas = "http://schemas.microsoft.com/3dmanufacturing"
    package = "http://schemas.openxmlformats.org/package/2006"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("[Content_Types].xml", f'<Types xmlns="{package}/content-types">'
                         '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
                         '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
                         '</Types>')
        archive.writestr("_rels/.rels", f'<Relationships xmlns="{package}/relationships"><Relationship Id="rel0" '
                         f'Target="/3D/3dmodel.model" Type="{schemas}/2013/01/3dmodel"/></Relationships>')
        archive.writestr("3D/3dmodel.model",
                         f'<model unit="millimeter" xmlns="{schemas}/core/2015/02"><resources><object id="1" type="model">'
                         f'<mesh><vertices>{vertices}</vertices><triangles>{faces}</triangles></mesh></object></resources>'
                         '<build><item objectid="1" transform="1 0 0 0 1 0 0 0 1 0.5 0.25 0"/></build></model>')


def without_numbers(text):
    """Lines with # for a number without its sign, so that times do not count but commas do."""
    return re.sub(" +", " ", re.sub(r"[+-]?\d+", "#", text))


@run_fabseq.only_release  # into which a library can be preloaded
class LocaleTest(FabseqTest):
    def setUp(self):
        super().setUp()
        self.locales = os.path.join(self.directory, "locales")
        os.mkdir(self.locales)
        try:
            subprocess.run(["localedef", "-i", LOCALE.split(".")[0], "-f", "UTF-8", os.path.join(self.locales, LOCALE)],
                           check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError):
            self.skipTest("no locale can be made here: localedef, and the package locales, of scripts/setup.sh --ci")
        self.library = run_fabseq.build_preload(self.directory, "set_locale")

    def run_twice(self, ranks, config, *arguments):
        """A run without and one with the locale, which print the same."""
        path = self.write_config(config)
        runs = []
        for name, preload in (("C", []), (LOCALE, ["-x", f"LD_PRELOAD={self.library}"])):
            self.runs += 1
            output = os.path.join(self.directory, f"output_{self.runs}")
            command = ["mpirun", "-np", str(ranks), *preload, PROGRAM, "-config", path, *map(str, arguments), "-output", output]
            with Process(command, self.directory, {"LOCPATH": self.locales, "OTHER_LOCALE": name}) as process:
                run = Result(command, *process.wait(120), output)
            self.assertEqual(run.status, DONE, str(run))
            runs.append(run)
        plain, other = (without_numbers(re.sub("output_[0-9]+", "output", run.stdout + run.stderr)) for run in runs)
        self.assertEqual(other, plain)
        return runs

    def assert_same_files(self, runs, *names):
        for name in names:
            texts = []
            for run in runs:
                with open(run.path(name), encoding="utf-8") as file:
                    texts.append(file.read())
            self.assertEqual(texts[1], texts[0], name)

    def test_optimization(self):
        for ranks in distinct(2, 1):
            with self.subTest(ranks=ranks):
                plain, other = self.run_twice(ranks, plate_2d(), "-max_iterations", 3, "-output_every", 2, "-alpha", 0.25,
                                              "-max_wall_time", "5000.5")
                assert_same_run(self, other, plain, ranks)
                self.assert_same_files([plain, other], "result.xdmf", "fields/iteration_0002.xdmf")

    def test_options_of_petsc(self):
        plain, other = self.run_twice(1, plate_2d(), "-max_iterations", 2, "-solver_path", "reference",
                                      "-elasticity_ksp_rtol", "2.5e-9", "-heat_ksp_rtol", "0.0000000025", "-heat_ksp_view")
        assert_same_run(self, other, plain, 1)
        self.assertIn("relative=2.5e-09", other.stdout)

    def test_checks(self):
        arguments = ("-task", "check", "-picture")
        runs = self.run_twice(1, {**plate_2d(), "tool": {"profile": [[0.02, 0.01], [0.5, 0.25]]}}, *arguments)
        plain, other = (Path(run.path("check.h5")).read_bytes() for run in runs)
        self.assertEqual(other, plain)
        self.assert_same_files(runs, "check.svg")

    def test_gradients_and_sensitivity(self):
        runs = self.run_twice(1, plate_2d(), "-elements", "8,5", "-task", "check_gradients")
        self.assert_same_files(runs, "gradient_check.csv", "gradient_check.json")
        runs = self.run_twice(1, plate_2d(), "-elements", "8,5", "-task", "sensitivity")
        self.assert_same_files(runs, "sensitivity.csv", "sensitivity.json")

    def test_meshes(self):
        triangles = box_triangles(LOW + 0.25, HIGH + 0.75)
        self.write_mesh("bar.stl", stl_text(triangles))
        self.write_mesh("bar.obj", obj_text(triangles))
        self.write_mesh("bar.ply", ply_text(triangles))
        write_3mf(os.path.join(self.directory, "bar.3mf"), triangles)
        for name in distinct("bar.stl", "bar.obj", "bar.ply", "bar.3mf"):
            with self.subTest(name=name):
                config = bar(file=name, scale=0.25)
                config["domain"]["element"] = 0.625
                runs = self.run_twice(1, config, "-task", "simulate")
                placement = [np.array(run.json("config.json")["run"]["mesh_placement"]) for run in runs]
                np.testing.assert_array_equal(*placement)
                self.assertEqual(runs[0].json("config.json")["domain"], runs[1].json("config.json")["domain"])
                self.assertEqual(*(contents(run.path("result.h5")) for run in runs))

    def write_mesh(self, name, text):
        with open(os.path.join(self.directory, name), "w", encoding="utf-8") as file:
            file.write(text)


if __name__ == "__main__":
    run_fabseq.main()
