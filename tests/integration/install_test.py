# SPDX-License-Identifier: MIT
"""`cmake --install` to another place: the program, the tools and the configs there work by themselves, and
docs/example builds against the library."""

import glob
import os
import re
import unittest
from unittest import mock

import run_fabseq
from run_fabseq import DONE, FabseqTest, ROOT
from small_meshes import write_box
from small_parts import plate_2d

BUILD = os.environ.get("FABSEQ_BUILD", os.path.join(ROOT, "build", "release"))


class InstallTest(FabseqTest):
    def run_command(self, *command):
        status, stdout, stderr = run_fabseq.run_command(command, self.directory, 300)
        self.assertEqual(status, DONE, f"{command}\n{stdout}{stderr}")
        return stdout

    def install(self):
        prefix = os.path.join(self.directory, "prefix")
        self.run_command("cmake", "--install", BUILD, "--prefix", prefix)
        return prefix

    def test_installed_program(self):
        prefix = self.install()
        program = os.path.join(prefix, "bin", "fabseq")
        self.assertRegex(self.run_command(program, "-version"), r"^fabseq \d+\.\d+\.\d+\s*$")
        configs = os.path.join(prefix, "share", "fabseq", "configs")
        self.run_command("mpirun", "-np", "2", program, "-config", os.path.join(configs, "gradient_box.json"), "-task",
                         "simulate", "-elements", "4,4,4", "-output", "box")
        self.assertTrue(os.path.exists(os.path.join(self.directory, "box", "result.xdmf")))
        # Its part is a file beside the config.
        self.assertIn("elements", self.run_command(program, "-config", os.path.join(configs, "voxel_part.json"), "-task",
                                                   "check"))
        self.assertTrue(os.path.exists(os.path.join(prefix, "share", "man", "man1", "fabseq.1")))

    @unittest.skipIf(os.environ.get("FABSEQ_PYTHON") == "0", run_fabseq.OF_THIS_BUILD + "it has no Python module")
    def test_installed_module(self):
        (folder,) = glob.glob(os.path.join(self.install(), "lib", "python3*", "site-packages"))
        text = "import fabseq; print(fabseq.__version__)"
        version = self.run_command("/usr/bin/env", "PYTHONPATH=" + folder, "/usr/bin/python3", "-c", text)
        self.assertRegex(version, r"^\d+\.\d+\.\d+$")

    def test_installed_tools(self):
        """They find each other and the program, without the source tree and without its environment."""
        prefix = self.install()
        tools, scripts = os.path.join(prefix, "bin", "fabseq-tools"), os.path.join(prefix, "share", "fabseq", "scripts")
        self.assertRegex(self.run_command(tools, "--help"), r"(?m)^  overview +[A-Z]")
        for name in ("src", "package.json", "build.sh", "node_modules"):  # what the report's page is made from
            self.assertFalse(os.path.exists(os.path.join(scripts, "fabseq_tools", "report", "page", name)), name)
        with mock.patch.dict(os.environ):
            os.environ.pop("FABSEQ_PROGRAM", None)
            part = os.path.join(prefix, "share", "fabseq", "configs", "gradient_box.json")
            self.run_command(os.path.join(scripts, "use", "run.sh"), "-np", "2", "-config", part, "-task", "simulate",
                             "-elements", "4,4,4", "-binary", "-output", "box")
            self.run_command(tools, "overview", "box", "--table")
            self.run_command(tools, "report", "box")
            self.run_command(tools, "compensate", "box", "--iterations", "1")
            write_box(os.path.join(self.directory, "cube.stl"), (20.0, 20.0, 20.0))
            self.run_command(os.path.join(scripts, "use", "bent_bar.py"), "bar.stl")
            self.run_command(tools, "new", "cube.stl", "--thickness", "8", "--output", "cube.json")
            self.run_command(os.path.join(prefix, "bin", "fabseq"), "-config", "cube.json", "-task", "check")
        for name in ("overview.png", "report.html", "compensated/compensated.stl"):
            self.assertTrue(os.path.exists(os.path.join(self.directory, "box", name)), name)

    @run_fabseq.only_release
    def test_a_program_of_ones_own(self):
        """Compiled without optimization, it links with all responses and computes what -task evaluate
        does."""
        prefix = self.install()
        self.run_command("cmake", "-S", os.path.join(ROOT, "docs", "example"), "-B", "example", f"-DCMAKE_PREFIX_PATH={prefix}",
                         "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror")
        self.run_command("cmake", "--build", "example")
        path = self.write_config(plate_2d())
        text = self.run_command("mpirun", "-np", "2", os.path.join("example", "start_value"), path)
        printed = {name: float(value) for name, value in re.findall(r"^(\w+) \(\w+\): ([-.\w]+)", text, flags=re.MULTILINE)}
        evaluation = self.run_program(1, "-config", path, "-task", "evaluate").json("evaluation.json")
        expected = {response["name"]: response["value"] for response in evaluation["responses"]}
        self.assertEqual(list(printed), list(expected))
        for name, value in expected.items():
            self.assertAlmostEqual(printed[name], value, delta=1e-4 * abs(value) + 1e-6)
        self.assertIn("gradient of objective_0", text)

    @run_fabseq.only_release
    def test_headers_ask_for_no_processor(self):
        """Installed headers compile for any processor: they know nothing of the lane engine's registers."""
        include = os.path.join(self.install(), "include")
        headers = sorted(glob.glob(os.path.join(include, "fabseq", "**", "*.h"), recursive=True))
        self.assertGreater(len(headers), 100)
        names = "".join(f'#include "{os.path.relpath(header, include)}"\n' for header in headers)
        for flag in ("-mno-avx", "-mavx"):
            self.run_command("sh", "-c", f"g++ -std=c++20 {flag} -Wall -Wextra -Werror -DOMPI_SKIP_MPICXX -I{include} "
                             f"$(pkg-config --cflags PETSc ompi-c hdf5-openmpi) -fsyntax-only -x c++ - <<'END'\n{names}END")
        for header in headers:
            with open(header, encoding="utf-8") as file:
                self.assertNotRegex(file.read(), "immintrin|__AVX|vector_size", header)


if __name__ == "__main__":
    run_fabseq.main()
