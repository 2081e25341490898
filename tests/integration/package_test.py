# SPDX-License-Identifier: MIT
"""`cpack -G DEB`: what Debian's package holds and asks for. Nothing is compiled for it."""

import glob
import os
import re
import shutil
import subprocess
import unittest

import run_fabseq
from run_fabseq import DONE, FabseqTest, ROOT

BUILD = os.environ.get("FABSEQ_BUILD", os.path.join(ROOT, "build", "release"))
NEEDED = ["usr/bin/fabseq", "usr/bin/fabseq-tools", "usr/share/man/man1/fabseq.1.gz", "usr/share/man/man1/fabseq-tools.1.gz",
          "usr/share/fabseq/scripts/environment.sh", "usr/share/fabseq/scripts/launch.sh", "usr/share/fabseq/scripts/use/run.sh",
          "usr/share/fabseq/scripts/use/bent_bar.py", "usr/share/fabseq/scripts/slurm/study_table.py",
          "usr/share/fabseq/scripts/fabseq_tools/entry.py", "usr/share/fabseq/configs/parts/flanged_elbow.h5",
          "usr/share/doc/fabseq/README.md", "usr/share/doc/fabseq/docs/cluster.md", "usr/share/doc/fabseq/docs/overview.png",
          "usr/share/doc/fabseq/benchmarks/evidence/results/built.md",
          "usr/share/doc/fabseq/copyright", "usr/share/doc/fabseq/changelog.gz",
          "usr/share/doc/fabseq/changelog.Debian.gz", "usr/share/lintian/overrides/fabseq"]
LINKS = {"usr/bin/fabseq-tools": "../share/fabseq/scripts/fabseq-tools", "usr/share/fabseq/fabseq": "../../bin/fabseq",
         "usr/share/fabseq/scripts/use/fabseq_tools": "../fabseq_tools",
         "usr/share/doc/fabseq/examples": "../../fabseq/configs"}
FOLDERS = r"usr/(bin/fabseq|share/(fabseq|doc/fabseq|man/man1|lintian/overrides)/)"
UNWANTED = r"usr/(include|lib)|__pycache__|\.pyc$|\.py\.in$|node_modules|package.*\.json|\.1$|architecture|docs/example"
PYTHON = ["python3", "python3-numpy", "python3-scipy", "python3-h5py", "python3-matplotlib", "python3-pil"]


@run_fabseq.only_release  # the package is made of that one
@unittest.skipUnless(shutil.which("dpkg-deb") and shutil.which("dpkg-shlibdeps") and shutil.which("file"),
                     "no dpkg-dev or file here")
class PackageTest(FabseqTest):
    def run_command(self, *command):
        status, stdout, stderr = run_fabseq.run_command(command, self.directory, 300)
        self.assertEqual(status, DONE, f"{command}\n{stdout}{stderr}")
        return stdout

    def test_package(self):
        self.run_command("cpack", "-G", "DEB", "--config", os.path.join(BUILD, "CPackConfig.cmake"), "-B", self.directory,
                         "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=none")
        package, = glob.glob(os.path.join(self.directory, "fabseq_*.deb"))
        self.check_files(package)
        self.check_control(package)
        self.check_unpacked(package)

    def check_files(self, package):
        lines = [line.split(maxsplit=5) for line in self.run_command("dpkg-deb", "-c", package).splitlines()]
        files = {words[5].removeprefix("./"): words for words in lines if not words[5].endswith("/")}
        links = dict(name.split(" -> ") for name in files if " -> " in name)
        self.assertEqual(links, LINKS)
        names = {name.split(" -> ")[0] for name in files}
        for name in NEEDED:
            self.assertIn(name, names)
        for name in names:
            self.assertRegex(name, FOLDERS)
            self.assertNotRegex(name, UNWANTED)
        configs = os.path.join(ROOT, "configs")
        of_tree = {os.path.relpath(path, configs) for path in glob.glob(os.path.join(configs, "**"), recursive=True)
                   if os.path.isfile(path)}
        prefix = "usr/share/fabseq/configs/"
        self.assertEqual({name.removeprefix(prefix) for name in names if name.startswith(prefix)}, of_tree)
        self.assertEqual({words[1] for words in lines}, {"root/root"})
        self.assertLessEqual({words[0] for words in lines}, {"drwxr-xr-x", "-rwxr-xr-x", "-rw-r--r--", "lrwxrwxrwx"})

    def check_control(self, package):
        control = dict(re.findall(r"(?m)^([\w-]+): (.*)$", self.run_command("dpkg-deb", "-f", package)))
        version = self.run_program(1, "-version").stdout.split()[1]
        self.assertEqual((control["Package"], control["Version"]), ("fabseq", version + "-1"))
        depends = [entry.split()[0] for entry in control["Depends"].split(", ")]
        for name in ["openmpi-bin", *PYTHON]:
            self.assertIn(name, depends)
        for name in ("libopenmpi3", r"libpetsc\w*-real3\.\d+", r"libhdf5-openmpi-[\d-]+", "libhwloc15"):  # from dpkg-shlibdeps
            self.assertRegex(control["Depends"], rf", {name} \(>= ")
        self.assertIn("python3-paraview", control["Recommends"])

    def check_unpacked(self, package):
        """The program and the tools start from there, and the changelog is Debian's."""
        self.run_command("dpkg-deb", "-x", package, "unpacked")
        usr = os.path.join(self.directory, "unpacked", "usr")
        self.assertRegex(self.run_command(os.path.join(usr, "bin", "fabseq"), "-version"), r"^fabseq \d")
        self.assertRegex(self.run_command(os.path.join(usr, "bin", "fabseq-tools"), "--help"), r"(?m)^  overview +[A-Z]")
        changelog = os.path.join(usr, "share", "doc", "fabseq", "changelog.Debian.gz")
        text = subprocess.run(["gzip", "-dc", changelog], capture_output=True, text=True, check=True).stdout
        self.assertRegex(text, r"^fabseq \([\d.]+-1\) .*\n\n  \* .*\n\n -- .* <.*@.*>  \w{3}, [\w ]+ [\d:]{8} \+0000\n$")


if __name__ == "__main__":
    run_fabseq.main()
