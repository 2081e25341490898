#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Sources that src/unity.cmake compiles as one: files that share a private name are kept apart."""

import subprocess
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
LISTS = f"""cmake_minimum_required(VERSION 3.25)
project(unity LANGUAGES CXX)
file(GLOB_RECURSE sources ${{PROJECT_SOURCE_DIR}}/src/*.cc)
add_library(whole STATIC ${{sources}})
set_target_properties(whole PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
include({PROJECT}/src/unity.cmake)
fabseq_unity_groups(${{PROJECT_SOURCE_DIR}}/src ${{sources}})
foreach(source IN LISTS sources)
  get_source_file_property(group ${{source}} UNITY_GROUP)
  get_source_file_property(alone ${{source}} SKIP_UNITY_BUILD_INCLUSION)
  file(RELATIVE_PATH name ${{PROJECT_SOURCE_DIR}}/src ${{source}})
  message("${{name}} ${{group}} ${{alone}}")
endforeach()
"""
SOURCE = """namespace all {{
namespace {{
{private}
}}  // namespace
{public}
}}  // namespace all
"""


class UnityTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "CMakeLists.txt").write_text(LISTS, encoding="utf-8")

    def groups(self, sources):
        """Group of each file, None for one that is compiled alone. `sources`: private code by path in src."""
        for number, (name, private) in enumerate(sources.items()):
            path = self.root / "src" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            public = "int f%d() { return static_cast<int>(sizeof(int)); }" % number
            path.write_text(SOURCE.format(private=private, public=public), encoding="utf-8")
        done = subprocess.run(["cmake", "-G", "Ninja", "-S", self.root, "-B", self.root / "build"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = [line.split() for line in done.stderr.splitlines() if line.count(" ") == 2]
        return {name: None if alone == "ON" else group for name, group, alone in lines}

    def test_private_names_are_kept_apart(self):
        same = ["int size(int x) { return x; }", "double size(double x) { return x; }", "constexpr int size = 3;",
                "struct size {};", "using size = int;", "enum class size { none };"]
        groups = self.groups({f"module/file_{i}.cc": code for i, code in enumerate(same)})
        self.assertEqual(len(groups), len(same))
        together = [group for group in groups.values() if group is not None]
        self.assertEqual(len(together), 3)
        self.assertEqual(len(set(together)), 3)
        subprocess.run(["cmake", "--build", self.root / "build"], check=True, capture_output=True)

    def test_other_files_share_groups(self):
        code = {f"{module}/file_{i}.cc": f"int {module}_{i}(int x) {{\n  const int inner = x;\n  return inner;\n}}"
                for module in ("one", "other") for i in range(12)}
        groups = self.groups(code)
        self.assertEqual(len(set(groups.values())), 6)
        self.assertTrue(all(groups[name].startswith(name.split("/")[0] + "_") for name in code))
        (self.root / "src/one/new.cc").write_text("namespace all {}\n", encoding="utf-8")
        after = self.groups(code)
        self.assertEqual({name: after[name] for name in groups}, groups)


if __name__ == "__main__":
    unittest.main()
