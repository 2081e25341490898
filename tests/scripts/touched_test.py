#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""scripts/dev/touched.py on a made-up project, and on this one."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import touched

PROJECT = Path(__file__).resolve().parents[2]
FILES = {
    "include/fabseq/grid/box.h": '#include "fabseq/grid/range.h"\n',
    "include/fabseq/grid/range.h": "",
    "src/grid/box.cc": '#include "fabseq/grid/box.h"\n',
    "src/grid/fill.h": "#pragma once\n",
    "src/grid/fill.cc": '#include "grid/fill.h"\n#include <vector>\n',
    "src/part/part.cc": '#  include <fabseq/grid/box.h>\n',
    "tests/support/share.h": "",
    "tests/grid/box_test.cc": '#include "fabseq/grid/box.h"\n',
    "tests/grid/fill_mpi_test.cc": '#include "grid/fill.h"\n#include "support/share.h"\n'}


class TouchedTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="fabseq_touched_")
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name)
        for name, text in FILES.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")

    def touched_by(self, *names):
        tree, changed = touched.Tree(self.root), {Path(name) for name in names}
        return [str(path) for path in touched.touched_sources(tree, changed)], list(touched.touched_tests(tree, changed))

    def test_a_source_touches_itself_and_the_tests_of_its_header(self):
        self.assertEqual(self.touched_by("src/grid/box.cc"), (["src/grid/box.cc"], ["box_test"]))
        self.assertEqual(self.touched_by("src/grid/fill.cc"), (["src/grid/fill.cc"], ["fill_mpi_test"]))
        self.assertEqual(self.touched_by("src/part/part.cc"), (["src/part/part.cc"], []))

    def test_a_header_touches_what_names_it(self):
        self.assertEqual(self.touched_by("include/fabseq/grid/box.h"),
                         (["src/grid/box.cc", "src/part/part.cc"], ["box_test"]))
        self.assertEqual(self.touched_by("include/fabseq/grid/range.h"), ([], []))
        self.assertEqual(self.touched_by("tests/support/share.h"), ([], ["fill_mpi_test"]))

    def test_other_files_touch_nothing(self):
        self.assertEqual(self.touched_by("README.md", "src/gone.cc"), ([], []))

    def git(self, *words):
        subprocess.run(["git", "-c", "user.name=nobody", "-c", "user.email=nobody@example.org", *words], cwd=self.root,
                       check=True, capture_output=True)

    def test_a_change_is_what_git_sees_and_new_files(self):
        self.git("init", "-q")
        self.git("add", ".")
        self.git("commit", "-qm", "All")
        (self.root / "src/grid/box.cc").write_text("// other\n", encoding="utf-8")
        (self.root / "src/grid/new.cc").write_text("", encoding="utf-8")
        self.assertEqual(touched.changed_since(self.root, "HEAD"), {Path("src/grid/box.cc"), Path("src/grid/new.cc")})
        with self.assertRaisesRegex(SystemExit, "touched.py: --since nowhere: .*; allowed: a commit of this repository"):
            touched.changed_since(self.root, "nowhere")

    def test_every_unit_test_of_this_project_reaches_a_source(self):
        """Otherwise no change of the program would run it."""
        tree = touched.Tree(PROJECT)
        every = set(tree.files("src", "*.cc")) | set(tree.files("src", "*.h")) | set(tree.files("include", "*.h"))
        names = {path.stem for path in tree.files("tests", "*_test.cc")}
        self.assertEqual(set(touched.touched_tests(tree, every)), names)


if __name__ == "__main__":
    sys.exit(unittest.main())
