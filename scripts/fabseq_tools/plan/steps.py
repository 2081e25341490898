# SPDX-License-Identifier: MIT
"""The steps of a plan: what each has found, kept so that a plan that was interrupted goes on."""

import hashlib
import json
import os
import sys
import time

from fabseq_tools.run.command_line import RunError, warn, write_json
from fabseq_tools.run.machine import keys_of_machine, machine_of
from fabseq_tools.run.words import duration

FILE = "steps.json"
SHORT = 0.5  # seconds: what takes less goes without a word
UNIT = "mm"  # of all lengths of a plan
LEFT_OUT = "part", "machine", "output", "yes", "ranks", "program", "rest"  # options that change no result, or stand as contents


class Steps:
    """`arguments`: the words of the command line. `folder`: of the plan. `found`: of each step, by its name,
    what it has returned: a dictionary with its `line` and, where there are any, `warnings`."""

    def __init__(self, arguments):
        self.arguments, self.folder = arguments, arguments.output
        self.machine = keys_of_machine(arguments.program, machine_of(arguments.machine), UNIT)
        os.makedirs(self.folder, exist_ok=True)
        self.found, self.kept = {}, self.read()
        with open(arguments.part, "rb") as file:
            part = hashlib.sha256(file.read()).hexdigest()
        options = {key: value for key, value in vars(arguments).items() if key not in LEFT_OUT}
        self.asked = digest([part, self.machine, options, arguments.rest])

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def take(self, name, work, *given):
        """What work(steps, *given) returns, or has returned for just this."""
        self.asked = digest([self.asked, name])
        kept = self.kept.get(name, {})
        began = time.monotonic()
        if kept.get("asked") == self.asked:
            found, took = kept["found"], "as before"
        else:
            found = work(self, *given)
            took = duration(time.monotonic() - began) if time.monotonic() - began >= SHORT else ""
            self.kept[name] = {"asked": self.asked, "found": found, "seconds": time.monotonic() - began}
            write_json(self.path(FILE), self.kept)
        self.asked = digest([self.asked, found])
        self.found[name] = found
        print(f"{len(self.found)} {name}: {found['line']}{f' ({took})' * bool(took)}", flush=True)
        for text in found.get("warnings", []):
            warn("plan", text)
        return found

    def seconds(self):
        """That all steps have taken, as often as they were interrupted."""
        return sum(self.kept[name]["seconds"] for name in self.found)

    def read(self):
        """What an earlier plan has left; nothing where it cannot be read."""
        try:
            with open(self.path(FILE), encoding="utf-8") as file:
                kept = json.load(file)
        except (OSError, ValueError):
            return {}
        return kept if isinstance(kept, dict) else {}

    def can_ask(self):
        """Whether somebody sits at the terminal, and is to be asked."""
        return not self.arguments.yes and sys.stdin.isatty() and sys.stderr.isatty()

    def choose(self, question, allowed, usual):
        """The answer of who sits there, one of `allowed`; the usual one where nobody does."""
        if not self.can_ask():
            return usual
        while True:
            print(f"{question} [{usual}] ", end="", file=sys.stderr, flush=True)
            line = sys.stdin.readline()
            if not line:
                raise RunError(f"no answer to: {question}; --yes takes what stands in brackets")
            answer = line.strip().lower() or usual
            if answer in allowed:
                return answer
            print(f"found {answer}; allowed: {', '.join(allowed)}", file=sys.stderr)


def digest(content):
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
