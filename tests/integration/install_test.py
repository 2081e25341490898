# SPDX-License-Identifier: MIT
"""`cmake --install` to another place: the program and the configs there work by themselves."""

import os

import run_fabseq
from run_fabseq import DONE, FabseqTest, ROOT

BUILD = os.environ.get("FABSEQ_BUILD", os.path.join(ROOT, "build", "release"))


class InstallTest(FabseqTest):
    def run_command(self, *command):
        status, stdout, stderr = run_fabseq.run_command(command, self.directory, 300)
        self.assertEqual(status, DONE, f"{command}\n{stdout}{stderr}")
        return stdout

    def test_installed_program(self):
        prefix = os.path.join(self.directory, "prefix")
        self.run_command("cmake", "--install", BUILD, "--prefix", prefix)
        program = os.path.join(prefix, "bin", "fabseq")
        self.assertRegex(self.run_command(program, "-version"), r"^fabseq \d+\.\d+\.\d+\s*$")
        configs = os.path.join(prefix, "share", "fabseq", "configs")
        self.run_command("mpirun", "-np", "2", program, "-config", os.path.join(configs, "gradient_box.json"), "-task",
                         "simulate", "-elements", "4,4,4", "-output", "box")
        self.assertTrue(os.path.exists(os.path.join(self.directory, "box", "result.xdmf")))
        # Its part is a file beside the config.
        self.assertIn("elements", self.run_command(program, "-config", os.path.join(configs, "voxel_part.json"), "-task",
                                                   "check"))


if __name__ == "__main__":
    run_fabseq.main()
