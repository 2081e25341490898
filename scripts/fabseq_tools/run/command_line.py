# SPDX-License-Identifier: MIT
"""What all commands share: words of the command line, mistakes, and the files that they write."""

import argparse
import csv
import json
import math
import os
import shutil
import subprocess
import sys

from fabseq_tools.run.places import ENVIRONMENT, NAME

BAD_INPUT = 2  # the exit status, as of the program
INTERRUPTED = 130
TO_NOTICE, TO_CHECKPOINT = 2.0, 60.0  # seconds that an interrupted command gets
VALUE_OF = "argument "  # begins what argparse says of the value of an option
WARNING = "warning: "  # begins the program's own
TRACEBACK = "FABSEQ_TRACEBACK"  # the variable with which errors of Python show where they come from


class RunError(Exception):
    """What a script cannot go on with, and why."""


class Parser(argparse.ArgumentParser):
    """Says in one line which option has a value that is not allowed; of other mistakes also the usage."""

    def error(self, message):
        if message.startswith(VALUE_OF):
            self.exit(BAD_INPUT, f"{self.prog}: {message.removeprefix(VALUE_OF)}\n")
        super().error(message)


def parser_of(text, command=None, **more):
    """A parser of the words behind a command, or of a script's, which prints a docstring as it stands."""
    if command:
        more["prog"] = f"{NAME} {command}"
    return Parser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter, **more)


def number(allowed, holds=lambda value: True, kind=float):
    """The type of an option: a finite number for which `holds` is true; `allowed`: which these are, in
    words."""
    def read(text):
        try:
            value = kind(text)
            if math.isfinite(value) and holds(value):
                return value
        except (ValueError, OverflowError):
            pass
        raise argparse.ArgumentTypeError(f"found {text}; allowed: {allowed}")

    return read


def whole_number(least, most=None):
    """The type of an option that is an integer from `least` on, up to `most`."""
    allowed = f"an integer >= {least}" if most is None else f"an integer from {least} to {most}"
    return number(allowed, lambda value: least <= value and (most is None or value <= most), int)


def between(least, most):
    """The type of an option that is a number between two."""
    return number(f"a number from {least:g} to {most:g}", lambda value: least <= value <= most)


finite = number("a finite number")
positive = number("a number > 0", lambda value: value > 0)
non_negative = number("a number >= 0", lambda value: value >= 0)
share = between(0, 1)
count = whole_number(1)


def parse(parser, words=None):
    """The options among the words, which are the script's own by default, and as `rest` those of the program,
    which stand behind --."""
    words = sys.argv[1:] if words is None else words
    end = words.index("--") if "--" in words else len(words)
    options = parser.parse_args(words[:end])
    options.rest = words[end + 1:]
    if getattr(options, "program", None):
        os.environ["FABSEQ_PROGRAM"] = options.program  # reads meshes, too
    return options


def run_script(main, command=None, words=()):
    """Ends the command, or the script, with one line and status 2 where something is missing or cannot be
    used. `words`: its own, among which are the files that it reads."""
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except Exception as error:
        if TRACEBACK in os.environ:
            raise
        name = f"{NAME} {command}" if command else os.path.basename(sys.argv[0])
        print(f"{name}: {reason(error, words)}".replace("\n", " "), file=sys.stderr)
        sys.exit(BAD_INPUT)


def reason(error, words):
    """Why a command cannot go on. Readers say it of what is missing or of another kind (RunError). What lies
    deeper in a damaged file is met by whoever uses it, as an error of any kind."""
    if isinstance(error, (RunError, OSError)):
        return error
    given = ", ".join(word for word in words if os.path.exists(word)) or "what it was given"
    what = f"{type(error).__name__} {error}".strip()
    return (f"cannot use {given}: a file there is damaged, of another version or of another kind of run ({what[:200]}); "
            f"allowed: whole files of this version; with {TRACEBACK}=1 in the environment you see where")


def warn(command, text):
    print(f"{NAME} {command}: warning: {text}", file=sys.stderr)


def run_command(command, capture=True, statuses=(0,), given=None, **more):
    """Runs a command in the environment of all scripts, where there may be more ranks than cores, on the text
    `given`. Raises RunError if it ends with another exit status than these."""
    command = list(map(str, command))
    in_environment = 'source "$0"; allow_more_ranks_than_cores; exec "$@"'
    words = ["bash", "-c", in_environment, ENVIRONMENT, *command]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} if capture else {}
    if given is not None:
        pipes["stdin"] = subprocess.PIPE
    with subprocess.Popen(words, text=True, **pipes, **more) as process:
        try:
            output, errors = process.communicate(given)
        except BaseException:
            end(process)
            raise
    if process.returncode not in statuses:
        raise RunError(f"status {process.returncode}: {' '.join(command)}\n{(errors or '').strip()}".strip())
    return subprocess.CompletedProcess(words, process.returncode, output, errors)


def end(process):
    """Waits until a command that was interrupted has written its checkpoint: a terminal interrupts it as
    well, what else interrupts the tool alone does not."""
    for ask, patience in ((lambda: None, TO_NOTICE), (process.terminate, TO_CHECKPOINT), (process.kill, None)):
        try:
            ask()
            process.communicate(timeout=patience)
            return
        except subprocess.TimeoutExpired:
            continue


def require_program(program):
    """Raises RunError where there is none of that name."""
    if shutil.which(program) is None:
        raise RunError(f"{program}: no such program")


def run_program(arguments, path, task, *options, rest=None, warn_of=None):
    """What the program prints of a task, with the ranks of the script and the options behind its --, or
    `rest` in place of these. `warn_of`: is called with each of the program's warnings. Raises RunError with
    the program's own line if it refuses or fails."""
    ranks = ["mpirun", "-np", arguments.ranks] if arguments.ranks > 1 else []
    words = arguments.rest if rest is None else rest
    try:
        result = run_command([*ranks, arguments.program, "-config", path, "-task", task, *words, *options])
    except RunError as error:
        raise RunError(reason_of(error)) from error
    for line in result.stderr.splitlines() if warn_of else ():
        if line.startswith(WARNING):
            warn_of(line.removeprefix(WARNING))
    return result.stdout


def reason_of(error):
    """The program's own line among those of mpirun, or else the last that says something."""
    lines = [line for line in str(error).splitlines() if line.strip("- ")]
    return next((line.removeprefix("fabseq: ") for line in lines if line.startswith("fabseq: ")), lines[-1])


def write_json(path, content):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(content, file, indent=1)
        file.write("\n")


def write_rows(path, rows, columns=None):
    """A table (CSV); its columns are those of the first row unless given."""
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns or list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
