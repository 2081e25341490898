# SPDX-License-Identifier: MIT
"""Whether a run ended as docs/reference.md promises: its status, what it said, what it left."""

import dataclasses
import json
import math
import os
import re

import h5py
import numpy as np

from run_fabseq import BAD_INPUT, DONE, NUMERICAL_FAILURE, OUTPUT_FAILURE, STOPPED

WRITTEN = {
    "optimize": ("config.json", "history.jsonl", "result.h5", "result.xdmf", "summary.json"),
    "simulate": ("config.json", "result.h5", "result.xdmf", "summary.json"),
    "sensitivity": ("config.json", "sensitivity.json", "sensitivity.csv"),
    "evaluate": ("config.json", "evaluation.json", "gradients.h5"),
    "check_gradients": ("config.json", "gradient_check.csv", "gradient_check.json"),
    "check": ()}
# What may be null in the files: docs/reference.md and docs/developer/files.md say when.
MAY_BE_NULL = {"thickness", "cv", "nodes", "released", "length", "rms", "max", "distortion", "value", "failure", "finer_grid",
               "local_thickness", "share_outside", "at", "blocked", "tilt", "late", "form", "worst", "gain", "best_alternative"}
# A run that is told to end, and how long it may take to do so.
ENDED_BY_US = "ended by SIGTERM"


@dataclasses.dataclass
class Outcome:
    """`kind`: its class in the table; `wrong`: what is not as promised, "" if all is."""

    kind: str
    wrong: str = ""
    message: str = ""


def task_of(arguments):
    words = [arguments[i + 1] for i, word in enumerate(arguments[:-1]) if word == "-task"]
    return words[-1] if words else "optimize"


def value_of(arguments, option):
    words = [arguments[i + 1] for i, word in enumerate(arguments[:-1]) if word == option]
    return words[-1] if words else None


def only_prints(arguments):
    return any(word in arguments for word in ("-help", "--help", "-h", "-version", "--version", "-help_markdown"))


def not_finite(value, name=""):
    """Path of a value that is no finite number where there should be one; "" if there is none."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        below = not_finite(item, str(key))
        if below:
            return f"{name}/{below}"
    wrong = value is None and name not in MAY_BE_NULL or isinstance(value, float) and not math.isfinite(value)
    return f"{name} is {value}" if wrong else ""


def bad_numbers(path):
    """What is wrong with the numbers of a file; "" if nothing is."""
    if path.endswith((".json", ".jsonl")):
        with open(path, encoding="utf-8") as file:
            documents = [file.read()] if path.endswith(".json") else file.read().splitlines()
        return next(filter(None, (not_finite(json.loads(document)) for document in documents)), "")
    bad = []
    with h5py.File(path, "r") as file:
        file.visititems(lambda name, item: bad.append(name) if isinstance(item, h5py.Dataset) and item.dtype.kind == "f"
                        and not np.isfinite(item[...]).all() else None)
    return f"not finite: {bad}" if bad else ""


class Judge:
    """Judges one run, of which `before` and `after` list all paths below the working directory."""

    def __init__(self, run, arguments, before, after):
        self.run, self.arguments, self.before, self.after = run, arguments, before, after
        lines = run.messages()
        # A text of the user's may have line breaks; these lines belong to the one before.
        self.warnings = [line for line in lines if line.startswith("warning: ")]
        self.errors = [line for line in lines if not line.startswith("warning: ") and line != ENDED_BY_US]

    def outcome(self):
        if self.run.status is None:
            return Outcome("hang", "does not end")
        judges = {DONE: self.done, BAD_INPUT: self.refused, NUMERICAL_FAILURE: self.failed, STOPPED: self.stopped,
                  OUTPUT_FAILURE: self.unwritable}
        message = self.errors[0] if self.errors else ""
        if self.run.status not in judges:
            return Outcome(f"status {self.run.status}", "a signal or an abort", message)
        kind, wrong = judges[self.run.status]()
        return Outcome(kind, wrong or self.said(), message)

    def said(self):
        """What no run may say."""
        if re.search(r"PETSC ERROR|MPI_ERR|MPI_Abort|terminate called|\brank [0-9]+: ", self.run.stderr):
            return "a trace, or a message of PETSc or MPI"
        if re.search(r"\\x[89a-f][0-9a-f]", self.run.stderr):
            return "text that is not UTF-8"
        if self.run.status in (DONE, STOPPED) and re.search(r"(?<![\w/.])-?(nan|inf)\b", self.run.stdout):
            return "prints a number that is not finite"
        return ""

    def done(self):
        if self.errors:
            return "0 done", f"other lines on stderr: {self.errors[:2]}"
        if only_prints(self.arguments):
            return "0 printed", "" if self.run.stdout else "prints nothing"
        task = task_of(self.arguments)
        if task == "check":
            return "0 checked", "" if "-picture" in self.arguments or self.before == self.after else "check wrote files"
        missing = [name for name in WRITTEN[task] if not os.path.exists(self.run.path(name))]
        if missing:
            return "0 done", f"no {missing}"
        numbers = [name for name in (*WRITTEN[task], "history.jsonl", "sensitivity.json")
                   if name.endswith((".json", ".jsonl", ".h5")) and name != "config.json" and os.path.exists(self.run.path(name))]
        bad = [f"{name}: {problem}" for name in numbers for problem in [bad_numbers(self.run.path(name))] if problem]
        return "0 done", "; ".join(bad)

    def refused(self):
        kind = "2 refused"
        if self.before != self.after:
            changed = {path for path, _ in set(self.after.items()) ^ set(self.before.items())}
            return kind, f"written or removed before the refusal: {sorted(changed)[:3]}"
        return kind, self.one_message(r"(^|[\s'\"(:])(/[A-Za-z0-9_]+|-[A-Za-z]\w*)|case\.json|a_file|PETSc|belongs to no option")

    def failed(self):
        task = task_of(self.arguments)
        if task in ("optimize", "simulate"):
            try:
                summary = self.run.json("summary.json")
            except (OSError, ValueError) as error:
                return "3 failed", f"no summary.json: {error}"
            if summary.get("status") != "failed" or not summary.get("reason"):
                return "3 failed", "summary.json does not say that it failed, and why"
        if task == "optimize" and not os.path.exists(self.run.path("checkpoint/newest")):
            return "3 failed", "no checkpoint"
        return "3 failed", self.one_message("")

    def stopped(self):
        wanted = "-max_wall_time" in self.arguments or ENDED_BY_US in self.run.stderr
        return "4 stopped", self.one_message("") if wanted else "nobody asked it to stop"

    def unwritable(self):
        output = value_of(self.arguments, "-output") or ""
        return "5 not written", self.one_message(re.escape(os.path.basename(output.rstrip("/"))[:40]))

    def one_message(self, named):
        """What is wrong with what the run says: it should be one line, which matches the regular expression
        `named`."""
        lines = self.errors
        if len(lines) != 1:
            return f"{len(lines)} lines on stderr: {lines[:3]}"
        if not lines[0].startswith("fabseq: "):
            return f"not a message of fabseq's: {lines[0][:200]}"
        if re.search(r"^fabseq: rank \d+: ", lines[0]):
            return "an exception that nobody expects"
        if len(lines[0]) > 1500:
            return f"a line of {len(lines[0])} characters"
        return "" if re.search(named, lines[0]) else "names neither key nor option nor file"


def difference(one, other):
    """What differs between two runs of a case on different numbers of ranks; "" if nothing does."""
    if one.status != other.status:
        return f"status {one.status} and {other.status}"
    judges = [Judge(run, [], {}, {}) for run in (one, other)]
    errors = [judge.errors for judge in judges]
    if one.status == BAD_INPUT and errors[0] != errors[1]:
        return f"messages {errors[0][:1]} and {errors[1][:1]}"
    if one.status != DONE or not os.path.exists(one.path("history.jsonl")):
        return ""
    first, second = [run.history()[0] for run in (one, other)]
    for key in ("objective", "worst_constraint"):
        a, b = np.atleast_1d(first[key]), np.atleast_1d(second[key])
        if not np.allclose(a, b, rtol=1e-2, atol=1e-9 * max(1, abs(a).max())):
            return f"{key} of the first iteration {a} and {b}"
    return ""
