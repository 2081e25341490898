# SPDX-License-Identifier: MIT
"""Runs of one config with other settings, each in a folder of its own, which go on where they were."""

import argparse
import copy
import json
import os
import shutil

from fabseq_tools.run.command_line import RunError, count, parser_of, require_program, run_program, write_json
from fabseq_tools.run.machine import HELP, OPTION, config_with_machine, settings_for
from fabseq_tools.run.places import PROGRAM
from fabseq_tools.run.read_run import Run, read_config, read_json, target_thickness
from fabseq_tools.run.settings import put

DONE = "converged", "iteration_limit"
PARTS = {"domain": dict, "part": dict, "sequence": dict, "layers": dict}


def parser_of_rounds(text, command, config, default_output):
    """The words that all such commands share."""
    parser = parser_of(text, command)
    parser.add_argument("config", metavar=config)
    parser.add_argument("--output", default=default_output, metavar="DIR", help="folder of it all (default: %(default)s)")
    parser.add_argument("--ranks", type=count, default=2, metavar="N", help="of the program (default: %(default)s)")
    parser.add_argument(OPTION, metavar="CELL", help=HELP)
    parser.add_argument("--program", default=PROGRAM)
    return parser


class Rounds:
    """`config`: as it was written, with the `settings` of all runs (of -set, by path) in it, and what follows
    from its machine. The words of the command line choose the machine, the program and its ranks; what stands
    behind -- goes to the program in every run, between these settings and those of the run. Unless it
    `may_run`, only what is done is looked at."""

    def __init__(self, arguments, settings=None, may_run=True):
        self.config, self.may_run = read_config(arguments.config), may_run
        settings = settings_for(self.config, getattr(arguments, "machine", None)) | (settings or {})
        for path, value in settings.items():
            put(self.config, path, copy.deepcopy(value), arguments.config)
        self.arguments = argparse.Namespace(**vars(arguments) | {"rest": [*settings_of(settings), *arguments.rest]})
        require_program(arguments.program)
        if "machine" in self.config:
            self.config = config_with_machine(arguments.program, arguments.config, *settings_of(settings))
        for key, kind in PARTS.items():
            if not isinstance(self.config.get(key), kind):
                raise RunError(f"{arguments.config}: {key} is missing or no object")
        os.makedirs(arguments.output, exist_ok=True)

    def target_thickness(self):
        """Of layers.target or a layer_thickness constraint, which all that is compared here refers to."""
        target = target_thickness(self.config)
        if target is not None:
            return target
        raise RunError(f"{self.arguments.config}: constraints: found no layer_thickness; needed: one with a target, to which "
                       "local thickness is relative")

    def path(self, name):
        return os.path.join(self.arguments.output, name)

    def run(self, name, settings, task="optimize", options=()):
        """The finished run of these settings (of -set, by path). A folder with just this run is only looked
        at; an optimization that was interrupted goes on. Raises RunError if the program refuses or fails."""
        directory, words = self.path(name), [*settings_of(settings), *map(str, options)]
        asked = self.asked(task, words)
        done = self.finished(name, asked)
        if done:
            return done
        if not self.may_run:
            raise RunError(f"{directory}: holds no result of these settings")
        # The note comes first: without its result it says nothing, and a result beside it is of this run.
        if self.note(name) != asked:
            self.drop_result(directory)
        write_json(self.path(f"{name}.json"), asked)
        again = ["-restart", "auto"] if task == "optimize" else ["-overwrite"]
        run_program(self.arguments, self.arguments.config, task, *words, *again, "-output", directory)
        return Run(directory, simulations=True)

    def sensitivity(self, name, settings, design):
        """The folder with the table of -task sensitivity of a design, a file, under these settings. One of
        just these settings that is not older than the design is only looked at."""
        directory, words = self.path(name), [*settings_of(settings), "-design", design]
        asked, table = self.asked("sensitivity", words), os.path.join(directory, "sensitivity.json")
        if self.note(name) == asked and os.path.exists(table) and os.path.getmtime(table) >= os.path.getmtime(design):
            return directory
        if not self.may_run:
            raise RunError(f"{directory}: holds no table of this design and these settings")
        if os.path.exists(table):
            os.remove(table)
        write_json(self.path(f"{name}.json"), asked)
        run_program(self.arguments, self.arguments.config, "sensitivity", *words, "-overwrite", "-output", directory)
        return directory

    def asked(self, task, words):
        """As note() reads it."""
        asked = {"config": self.config, "task": task, "options": words, "rest": self.arguments.rest}
        return json.loads(json.dumps(asked))

    def note(self, name):
        """What the last run of that name was asked for; None without one."""
        try:
            return read_json(self.arguments.output, f"{name}.json")
        except RunError:
            return None

    def finished(self, name, asked):
        """None unless the folder holds the result of just that."""
        if self.note(name) != asked:
            return None
        try:
            run = Run(self.path(name), simulations=True)
        except RunError:
            return None
        return run if run.summary.get("status") in DONE else None

    @staticmethod
    def drop_result(directory):
        """A result of other settings must not pass for one of these if this run does not get to its end, and
        its checkpoint is no state of this run: steps depend on the number of iterations."""
        path = os.path.join(directory, "summary.json")
        if os.path.exists(path):
            os.remove(path)
        shutil.rmtree(os.path.join(directory, "checkpoint"), ignore_errors=True)


def settings_of(settings):
    """Words of the command line for settings by path."""
    return [word for key, value in settings.items() for word in ("-set", f"{key}={json.dumps(value)}")]


def with_constraint(constraints, kind, **more):
    """The list with a constraint of that type: its own, or else a new one."""
    if any(constraint.get("type") == kind for constraint in constraints):
        return list(constraints)
    return [*constraints, {"type": kind, **more}]
