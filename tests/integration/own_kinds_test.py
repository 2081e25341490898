# SPDX-License-Identifier: MIT
"""What docs/developer/your-own-response.md and your-own-sequence.md tell a student to do: their sources,
compiled and linked as the program's, their configs and their commands. The tree stays as it is."""

import json
import os
import re
import shlex
import subprocess

import run_fabseq
from run_fabseq import DONE, FabseqTest, ROOT

BUILD = os.environ.get("FABSEQ_BUILD", os.path.join(ROOT, "build", "release"))
MOST_WORDS = {"response": 500, "sequence": 400}


def commands_of_program():
    """How ninja compiles a source that registers itself, and how it links the program."""
    lines = subprocess.run(["ninja", "-C", BUILD, "-t", "commands", "fabseq"], capture_output=True, text=True,
                           check=True).stdout.splitlines()
    compiling = next(line for line in lines if "fabseq_registered.dir" in line and " -c " in line)
    return shlex.split(compiling), lines[-1]


class Page:
    """A page of docs/developer, by its blocks."""

    def __init__(self, name):
        with open(os.path.join(ROOT, "docs", "developer", name), encoding="utf-8") as file:
            self.text = file.read()
        self.source, self.config, commands = (self.block(language) for language in ("cpp", "json", "sh"))
        self.commands = commands.splitlines()
        self.config_file = re.findall(r"-config (\S+)", commands)[0]
        self.outputs = re.findall(r"-output (\S+)", commands)

    def block(self, language):
        (block,) = re.findall(rf"^```{language}\n(.*?)^```$", self.text, re.MULTILINE | re.DOTALL)
        return block


@run_fabseq.only_release
class OwnKindsTest(FabseqTest):
    def run_shell(self, text, directory):
        status, stdout, stderr = run_fabseq.run_command(["bash", "-euc", text], directory, 600)
        self.assertEqual(status, DONE, f"{text}\n{stdout}{stderr}")
        return stdout

    def build(self, page):
        """build/release/fabseq in the working directory, with the page's source in it."""
        compiling, linking = commands_of_program()
        source, made = os.path.join(self.directory, "own.cc"), os.path.join(self.directory, "own.o")
        with open(source, "w", encoding="utf-8") as file:
            file.write(page.source)
        words = [made if word.endswith(".o") else source if word.endswith((".cc", ".cxx")) else word for word in compiling
                 if word != "-Wno-subobject-linkage"]
        for option in ("-MF", "-MT"):
            del words[words.index(option):words.index(option) + 2]
        words.remove("-MD")
        self.run_shell(shlex.join(words), BUILD)
        program = os.path.join(self.directory, "build", "release", "fabseq")
        os.makedirs(os.path.dirname(program))
        linking, count = re.subn(r" -o fabseq ", f" -o {shlex.quote(program)} {shlex.quote(made)} ", linking)
        self.assertEqual(count, 1, linking)
        self.run_shell(linking, BUILD)

    def follow(self, kind):
        """Does what the page says; its outputs are then in the working directory. Returns the page."""
        page = Page(f"your-own-{kind}.md")
        self.assertLessEqual(len(page.text.split()), MOST_WORDS[kind])
        self.build(page)
        self.write_config(page.config, page.config_file)
        for command in page.commands:
            self.run_shell(command, self.directory)
        with open(os.path.join(self.directory, page.outputs[0], "gradient_check.json"), encoding="utf-8") as file:
            check = json.load(file)
        self.assertEqual(check["components"][0]["name"], "objective_0")
        self.assertLess(check["worst"], 1e-5)
        self.assertNotEqual(check["components"][0]["adjoint"], 0)
        return page

    def refusal(self, page, *options):
        program = os.path.join("build", "release", "fabseq")
        status, _, stderr = run_fabseq.run_command([program, "-config", page.config_file, "-task", "check", *options],
                                                   self.directory, 60)
        self.assertEqual(status, run_fabseq.BAD_INPUT)
        return stderr

    def test_a_response(self):
        page = self.follow("response")
        self.assertIn("/objective/0/top: found 2; allowed: a number in (0, 1]",
                      self.refusal(page, "-set", "objective.0.top=2"))

    def test_a_sequence(self):
        page = self.follow("sequence")
        with open(os.path.join(self.directory, page.outputs[1], "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        self.assertEqual(summary["iterations"], 5)
        self.assertIn("type \"mixed\"",
                      self.refusal(page, "-set", 'constraints=[{"type": "layer_thickness", "target": 0.3}]'))


if __name__ == "__main__":
    run_fabseq.main()
