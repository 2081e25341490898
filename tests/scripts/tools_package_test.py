# SPDX-License-Identifier: MIT
"""The package of the tools: its entry, its commands, and who imports whom."""

import ast
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import fabseq_tools
from fabseq_tools import entry

PROJECT = Path(__file__).resolve().parents[2]
PACKAGE, TOOLS = PROJECT / "scripts/fabseq_tools", PROJECT / "scripts/fabseq-tools"
MOST_LETTERS = 100  # of a line of --help


def run(*words, **more):
    return subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True, check=False, **more)


def ranks():
    """The packages by their place in the order that the package's docstring says."""
    (line,) = re.findall(r"^ +(\w+ < .*)$", fabseq_tools.__doc__, re.MULTILINE)
    return {name.strip(): rank for rank, names in enumerate(line.split("<")) for name in names.split(",")}


def imports(path):
    """Modules and names that a file imports, as fabseq_tools.package.module; relative ones with dots."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{'.' * node.level}{node.module or ''}.{alias.name}" for alias in node.names)


def offences(package, order):
    """Imports that the order does not allow."""
    for path in sorted(package.rglob("*.py")):
        own = path.relative_to(package).parts[0]
        for name in imports(path):
            top, _, rest = name.partition(".")
            other = rest.partition(".")[0]
            if name.startswith(".") or top not in (*sys.stdlib_module_names, *THIRD, package.name):
                yield f"{path.name}: {name} is not absolute, or not known"
            elif top == package.name and own in order and other != own and order.get(other, -1) >= order[own]:
                yield f"{path.name}: {name} is above {own}, or beside it"


THIRD = ("numpy", "scipy", "h5py", "matplotlib", "vtkmodules")


class Imports(unittest.TestCase):
    def test_order(self):
        folders = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
        self.assertEqual(set(ranks()), folders)
        self.assertEqual(list(offences(PACKAGE, ranks())), [])

    def test_offences_are_found(self):
        for text in ("from fabseq_tools.report.words import unit_of", "from fabseq_tools.calculix import deck",
                     "from . import order", "import command_line"):
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "fabseq_tools/paths/made_up.py"
                path.parent.mkdir(parents=True)
                path.write_text(f"import os\nfrom fabseq_tools.geometry import grid\n{text}\n", encoding="utf-8")
                self.assertEqual(len(list(offences(path.parents[1], ranks()))), 1, text)

    def test_no_path_is_edited(self):
        for folder in ("scripts", "benchmarks", "tests"):
            for path in (PROJECT / folder).rglob("*.py"):
                self.assertNotRegex(path.read_text(encoding="utf-8"), r"sys\.(path|meta_path)\b", path)


class Commands(unittest.TestCase):
    def test_every_command(self):
        """Its line in the list, its own help, and what it says of a mistake."""
        commands = entry.find_commands()
        for name, command in commands.items():
            self.assertRegex(command.summary, r"^[A-Z].*\.$", name)
            self.assertLessEqual(len(command.summary), MOST_LETTERS, name)
            text = (PROJECT / "scripts" / command.module.replace(".", "/")).with_suffix(".py").read_text(encoding="utf-8")
            self.assertIn(f"\n    fabseq-tools {name} ", ast.get_docstring(ast.parse(text), clean=False), name)
        self.assertEqual(len(commands), sum("\nCOMMAND = " in path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")))

    def test_help_of_every_command(self):
        for name, command in entry.find_commands().items():
            done = run(TOOLS, name, "--help")
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)
            self.assertIn(command.summary, done.stdout)

    def test_list(self):
        done = run(TOOLS, "--help")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(re.findall(r"^  ([a-z-]+) +[A-Z]", done.stdout, re.MULTILINE), list(entry.find_commands()))
        again = run("-m", "fabseq_tools", "--help", cwd=PROJECT / "scripts")
        self.assertEqual(again.stdout, done.stdout)

    def test_mistakes(self):
        done = run(TOOLS, "overveiw", "output")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr, "fabseq-tools: overveiw: no such command; near: overview; fabseq-tools --help lists all\n")
        done = run(TOOLS)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1))
        done = run("-m", "fabseq_tools", "compare-calculix", cwd=PROJECT / "scripts")
        self.assertEqual(done.returncode, 2)
        self.assertIn("usage: fabseq-tools compare-calculix [-h]", done.stderr)

    def test_documents_name_these_commands(self):
        """How-to pages name every command; no document, config or script names another."""
        paths = [PROJECT / "README.md", *(PROJECT / "docs").rglob("*.md"), *(PROJECT / "configs").rglob("*.json"),
                 *(PROJECT / "scripts/slurm").glob("*.sh"), *(PROJECT / "scripts/use").glob("*.sh"), *PACKAGE.rglob("*.py")]
        named = {path: set(re.findall(r"fabseq-tools\s+([a-z][a-z-]+)\b", path.read_text(encoding="utf-8"))) for path in paths}
        commands = set(entry.find_commands())
        how_to = (PROJECT / "docs/how-to").glob("*.md")
        self.assertEqual(set().union(*(named[path] for path in how_to)), commands)
        for path, names in named.items():
            self.assertLessEqual(names, commands, path)

    def test_a_new_tool_is_one_module(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(PACKAGE, Path(folder) / "fabseq_tools", ignore=shutil.ignore_patterns("__pycache__", "page"))
            shutil.copy(TOOLS, folder)
            text = '"""Says a word."""\n\nCOMMAND = "say"\n\n\ndef main(words):\n    print(words)\n'
            (Path(folder) / "fabseq_tools/run/say.py").write_text(text, encoding="utf-8")
            self.assertEqual(run(Path(folder) / "fabseq-tools", "say", "a", "b").stdout, "['a', 'b']\n")
            self.assertIn("Says a word.", run(Path(folder) / "fabseq-tools", "--help").stdout)


if __name__ == "__main__":
    unittest.main()
