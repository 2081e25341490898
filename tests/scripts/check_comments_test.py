#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""scripts/dev/check_comments.py on comments and commits of its own."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import check_comments

FULL = "/// " + 20 * "word "


def offences(*lines):
    return [(number, text.partition(":")[0]) for number, text in check_comments.offences_of(lines)]


class CommentsTest(unittest.TestCase):
    def test_derivatives_are_with_respect_to(self):
        found = offences("/// Adds derivatives of the load by strains.", "int derivative_by_time();", "// Gradients by adjoints.")
        self.assertEqual(found, [(1, "'derivatives of the load by' something")])
        self.assertEqual(offences("/// Derivative with respect to the strain, by its adjoint."), [])

    def test_a_line_that_a_formatter_tore(self):
        self.assertEqual([number for number, _ in offences(FULL.rstrip(), "/// torn", FULL.rstrip(), "/// end.")], [2])
        self.assertEqual(offences("  /// End.", "  ///", "  /// New paragraph.", "  /// \\param x  one",
                                  "  /// \\param y  other"), [])
        self.assertEqual(offences("// SPDX-License-Identifier: MIT", "/// \\file", "/// What it holds."), [])

    def test_first_words_of_doc_comments(self):
        def refused(*lines):
            return [(number, text.split()[0]) for number, text in check_comments.openings_of(lines)]
        self.assertEqual(refused("/// Of the part.", "/// With it.", "int a;", "", "  /// When, if at all."),
                         [(1, "'Of'"), (5, "'When'")])
        self.assertEqual(refused("/// Returns the size", "/// of the part.", "int a;", "/// What it is.", "int b;  ///< of it",
                                 "/// \\file", "/// In it.", "int c;", "/// \\param in  of it", "int d;", "/// `in` it.",
                                 "int e;", "///     if x", "int f;", "/// - of it", "int g;", "// In it.",
                                 "/// In-place sum.", "int h;", "/// for_each() of it."), [])

    def test_rule_of_first_words_by_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("src", "tests/support", "tests/base"):
                path = Path(folder, name)
                path.mkdir(parents=True)
                (path / "it.h").write_text("/// Of it.\nint a;\n", encoding="utf-8")
            done = subprocess.run([sys.executable, check_comments.__file__, folder], capture_output=True, text=True,
                                  check=False)
            self.assertEqual([line.split(":")[0] for line in done.stdout.splitlines()], ["src/it.h", "tests/support/it.h"])
            self.assertEqual(done.returncode, 1)

    def test_subjects_of_commits(self):
        with tempfile.TemporaryDirectory() as folder:
            def git(*words):
                subprocess.run(["git", "-c", "user.name=nobody", "-c", "user.email=nobody@example.org", *words], cwd=folder,
                               check=True, capture_output=True)
            self.assertEqual(check_comments.subjects(folder), [])
            git("init", "-q")
            for subject in ("Add a check", "add another"):
                git("commit", "--allow-empty", "-qm", subject)
            self.assertEqual(check_comments.subjects(folder), ["add another", "Add a check"])


if __name__ == "__main__":
    sys.exit(unittest.main())
