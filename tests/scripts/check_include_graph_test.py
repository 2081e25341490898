#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""scripts/dev/check_include_graph.py on small made-up projects, and on this one."""

import tempfile
import unittest
from pathlib import Path

import check_include_graph

PROJECT = Path(__file__).resolve().parents[2]


class IncludeGraph(unittest.TestCase):
    def offences(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder).resolve()
            for name, text in files.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return check_include_graph.offences(root)

    def test_this_project_is_in_order(self):
        self.assertEqual(check_include_graph.offences(PROJECT), [])

    def test_a_module_may_use_itself_and_those_above(self):
        self.assertEqual(self.offences({
            "include/fabseq/base/a.h": "#pragma once\n",
            "include/fabseq/grid/b.h": '#include "fabseq/base/a.h"\n#include "fabseq/grid/c.h"\n',
            "include/fabseq/grid/c.h": "",
            "src/grid/b.cc": '#include "fabseq/grid/b.h"\n#include <vector>\n',
            "src/main.cc": '#include "fabseq/grid/b.h"\n'}), [])

    def test_a_module_below_is_refused_in_headers_and_sources(self):
        found = self.offences({
            "include/fabseq/base/a.h": '\n#include "fabseq/grid/b.h"\n',
            "include/fabseq/grid/b.h": "",
            "include/fabseq/optimize/d.h": "",
            "src/grid/b.cc": '#  include <fabseq/optimize/d.h>\n',
            "src/main.cc": '#include "fabseq/base/a.h"\n'})
        self.assertEqual(len(found), 2)
        self.assertIn("include/fabseq/base/a.h:2: module 'base' must not use 'grid'", found[0])
        self.assertIn("src/grid/b.cc:1: module 'grid' must not use 'optimize'", found[1])

    def test_a_circle_within_a_module_is_named(self):
        found = self.offences({
            "src/files/a.h": '#include "files/b.h"\n',
            "src/files/b.h": '#include "files/c.h"\n',
            "src/files/c.h": '#include "files/a.h"\n'})
        self.assertEqual(len(found), 1)
        self.assertIn("src/files/a.h -> src/files/b.h -> src/files/c.h -> src/files/a.h", found[0])

    def test_unknown_folders_and_missing_headers_are_named(self):
        found = self.offences({
            "include/fabseq/physics/a.h": "",
            "src/base/b.cc": '#include "fabseq/base/gone.h"\n'})
        self.assertIn("folder 'physics' is no module", found[0])
        self.assertIn("src/base/b.cc:1: include/fabseq/base/gone.h does not exist", found[1])

    def test_private_headers_are_their_modules_own(self):
        found = self.offences({
            "include/fabseq/base/a.h": '#include "base/b.h"\n',
            "src/base/b.h": "", "src/kernels/k.h": "",
            "src/base/a.cc": '#include "base/b.h"\n#include "fabseq/base/a.h"\n',
            "src/grid/c.cc": '#include "base/b.h"\n#include "fabseq/base/a.h"\n',
            "src/solve/d.cc": '#include "kernels/k.h"\n'})
        self.assertEqual(found, [
            "include/fabseq/base/a.h:1: an installed header must not include src/base/b.h, which is not installed",
            "src/grid/c.cc:1: src/base/b.h is for module 'base' alone"])

    def test_installed_headers_are_needed_elsewhere(self):
        found = self.offences({
            "include/fabseq/base/a.h": '#include "fabseq/base/b.h"\n',
            "include/fabseq/base/b.h": "", "include/fabseq/base/c.h": "",
            "src/base/c.cc": '#include "fabseq/base/c.h"\n',
            "src/grid/d.cc": '#include "fabseq/base/a.h"\n'})
        self.assertEqual(found, [
            "include/fabseq/base/c.h:1: only its own module uses it: it belongs beside its source in src"])


if __name__ == "__main__":
    unittest.main()
