# SPDX-License-Identifier: MIT
"""Runs a command that draws where there is no display, with one in memory (Xvfb).

    fabseq-tools virtual-display COMMAND [ARGUMENTS]

Other than with xvfb-run, any number of these may start at once, each with a number of its own, and a command
may close its last window and open another, as the server does not reset in between. Exit status: the
command's, or 1 with a line where Xvfb is missing or does not start."""

import os
import random
import signal
import subprocess
import sys

from fabseq_tools.run.places import ENTRY, NAME

COMMAND = "virtual-display"


def ensure_display():
    """Starts this Python program again with a display in memory where there is none: VTK would crash."""
    if not os.environ.get("DISPLAY"):
        os.execv(sys.executable, [sys.executable, ENTRY, COMMAND, sys.executable, *sys.argv])


def main(words):
    if not words or words[0] in ("-h", "--help"):
        print(__doc__.strip(), file=sys.stdout if words else sys.stderr)
        sys.exit(0 if words else 1)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # so that the server ends as well
    server, number = start_server(words)
    try:
        status = subprocess.call(words, env={**os.environ, "DISPLAY": f":{number}"})
    except OSError as error:
        sys.exit(f"{NAME} {COMMAND}: {words[0]}: {error.strerror}")
    finally:
        server.terminate()
        server.wait()
    sys.exit(status if status >= 0 else 128 - status)


def start_server(command):
    """The process of Xvfb and the number of its display, once it takes connections. `command`: who wants it.

    Not one of the first ten: hwloc, and with it every mpirun and every rank that starts, looks for graphics
    cards there, and dies with a server that ends just then."""
    for number in random.sample(range(100, 1000), 20):
        reading, writing = os.pipe()
        try:
            server = subprocess.Popen(["Xvfb", f":{number}", "-displayfd", str(writing), "-screen", "0", "1280x1024x24",
                                       "-nolisten", "tcp", "-noreset"], pass_fds=[writing], stdin=subprocess.DEVNULL,
                                      stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        except OSError:
            sys.exit(f"{named(command)}: needs a display, or Xvfb, which scripts/setup.sh installs")
        os.close(writing)
        with os.fdopen(reading) as answer:
            if answer.readline().strip():
                return server, number
        complaint = server.communicate()[1].decode(errors="replace").strip()  # as of a number that is taken
    sys.exit(f"{named(command)}: Xvfb does not start: {complaint or 'no reason given'}")


def named(command):
    """Who wants a display: a command of these tools, a script behind a Python, or another program."""
    words = command[1:] if command[0] == sys.executable and len(command) > 1 else command
    name = os.path.basename(words[0])
    return f"{name} {words[1]}" if name == NAME and len(words) > 1 else name
