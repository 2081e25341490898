# SPDX-License-Identifier: MIT
"""What README.md and the tutorial tell a reader to type: commands, and the example of voxels."""

import os
import re
import subprocess

import run_fabseq
from pictures import filled
from run_fabseq import DONE, FabseqTest, ROOT, only_release

with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as readme:
    README = readme.read()
with open(os.path.join(ROOT, "docs/tutorial.md"), encoding="utf-8") as tutorial:
    TUTORIAL = tutorial.read()
LEAST_GAIN = 1.3  # of the skin's rms, over the best alternative that the machine could build


def fenced(language, word=""):
    """Text of the tutorial's only block in that language that has the word."""
    blocks = re.findall(rf"^```{language}\n(.*?)^```$", TUTORIAL, re.MULTILINE | re.DOTALL)
    (block,) = [block for block in blocks if word in block]
    return block


def commands(page):
    """The indented blocks."""
    return [re.sub("^    ", "", block, flags=re.MULTILINE) for block in re.findall(r"(?:^    .*\n)+", page, re.MULTILINE)]


class ReadmeTest(FabseqTest):
    def setUp(self):
        """A tree as after a build, without what builds it: the tree under test must stay as it is."""
        super().setUp()
        for name in ("scripts", "bin", "build/release"):
            os.makedirs(self.path(name))
        for name in os.listdir(os.path.join(ROOT, "scripts")):
            if name != "setup.sh":
                os.symlink(os.path.join(ROOT, "scripts", name), self.path("scripts/" + name))
        os.symlink(os.path.join(ROOT, "configs"), self.path("configs"))
        os.symlink(run_fabseq.PROGRAM, self.path("build/release/fabseq"))
        for name in ("scripts/setup.sh", "bin/cmake", "bin/ctest"):  # they print how they were called, and a test
            with open(self.path(name), "w", encoding="utf-8") as file:
                file.write(f"#!/bin/sh\necho {os.path.basename(name)} \"$@\"\n"
                           """echo '1: Test command: mpirun "-np" "2" "/build/tests/grid_tests" "--file=grid_mpi_test.cc"'\n""")
            os.chmod(self.path(name), 0o755)

    def path(self, name):
        return os.path.join(self.directory, name)

    def shell(self, text, timeout=600):
        """Output of commands typed one after the other in the tree's root; the first that fails ends them."""
        status, stdout, stderr = run_fabseq.run_command(["bash", "-euc", text], self.directory, timeout)
        self.assertEqual(status, DONE, f"{text}\n{stdout}{stderr}")
        return stdout

    def command_of(self, script):
        """The line that runs a script."""
        (line,) = [line for block in commands(README) for line in block.splitlines() if f"scripts/{script}" in line]
        return line

    def assert_buildable(self, output):
        """The machine can build what the run ends with, strictly, and gains over what else it can build."""
        run = run_fabseq.Result([], DONE, "", "", self.path(output))
        summary = run.json("summary.json")
        answer = summary["answer"]
        print(f"{output}: {answer['class']}, {answer['gain']:.2f} times less than {answer['best_alternative']['title']}")
        self.assertEqual((answer["class"], answer["places"], answer["released"]), ("buildable", [], True))
        self.assertTrue(summary["binary"]["verdict"]["buildable"])
        self.assertEqual(answer["best_alternative"]["class"], "buildable")
        self.assertGreaterEqual(answer["gain"], LEAST_GAIN)
        target = run.json("config.json")["constraints"][0]["target"]
        least, largest = run.json("config.json")["tool"]["thickness"]
        thickness = summary["binary"]["checks"]["local_thickness"]
        self.assertTrue(least * target <= thickness["least"] <= thickness["largest"] <= largest * target, thickness)

    def assert_drawn(self, output):
        """Below the title, two large pictures of the part fill the middle, small ones and charts the rest."""
        self.assertGreater(min(filled(self.path(output + "/overview.png"), 0.25, 0.55, 2)), 0.1)
        self.assertGreater(min(filled(self.path(output + "/overview.png"), 0.75, 0.9, 4)), 0.01)

    @only_release
    def test_the_demo(self):
        stdout = self.shell(self.command_of("demo.sh"))
        self.assertIn("setup.sh", stdout)
        self.assertIn("overview.png", stdout)
        self.assertRegex(stdout, r"(?m)^buildable: the skin distorts [\d.]+ times less than in the best alternative")
        self.assert_buildable("demo")
        self.assert_drawn("demo")

    @only_release
    def test_your_own_part(self):
        with open(self.path("part.json"), "w", encoding="utf-8") as file:
            file.write(fenced("json"))
        subprocess.run(["/usr/bin/python3", "-c", fenced("python")], cwd=self.directory, check=True)
        (block,) = [block for block in commands(TUTORIAL) if "part.json" in block]
        stdout = self.shell("PATH=$PWD/build/release:$PATH\n" + block)  # as section 1 says
        self.assertIn("planar / this", stdout)
        self.assert_buildable("part_out")
        self.assert_drawn("part_out")

    @only_release
    def test_a_mesh(self):
        """The README's commands as they stand: `new` chooses for this part what can be built."""
        (block,) = [block for block in commands(README) if "bar.stl" in block]
        self.shell(block)
        self.assert_buildable("output/bar")
        self.assertTrue(os.path.exists(self.path("output/bar/report.html")))

    @only_release
    def test_the_arm(self):
        with open(self.path("arm.json"), "w", encoding="utf-8") as file:
            file.write(fenced("jsonc", '"arm"'))
        self.shell("build/release/fabseq -config arm.json")
        self.assert_buildable("output/arm")

    def test_the_tests(self):
        """They are not run here, which would have no end: the command gets to ctest with its options."""
        line = self.command_of("test.sh").split("#")[0].strip()
        stdout = self.shell(f"PATH={self.path('bin')}:$PATH {line} -R grid")
        self.assertRegex(stdout, r"(?m)^ctest .*--preset release\b.*-R grid$")

    @only_release
    def test_every_topic_is_a_test(self):
        build = os.environ.get("FABSEQ_BUILD", os.path.join(ROOT, "build", "release"))
        listed = subprocess.run(["ctest", "-N", "--test-dir", build], capture_output=True, text=True, check=True).stdout
        here = os.path.dirname(os.path.abspath(__file__))
        topics = [name.removesuffix("_test.py") for name in os.listdir(here) if name.endswith("_test.py")]
        self.assertEqual([topic for topic in topics if not re.search(rf": integration\.{topic}$", listed, re.MULTILINE)], [])

    def test_all_that_is_named_is_there(self):
        names = re.findall(r"\]\(([^)#]+)\)", README) + re.findall(r"\b(?:scripts|configs|docs)/[\w./-]*\w", README)
        for name in names:
            self.assertTrue(os.path.exists(os.path.join(ROOT, name)), name)
            if name.endswith(".sh"):
                subprocess.run(["bash", "-n", os.path.join(ROOT, name)], check=True)


if __name__ == "__main__":
    run_fabseq.main()
