# SPDX-License-Identifier: MIT
"""A shell at a terminal, as a user has it, for the tests of this folder."""

import os
import pty
import re
import select
import signal
import time

CONTROL_C = "\x03"


class Terminal:
    """An interactive bash without anybody's settings, to be used in a with statement."""

    def __init__(self, directory, environment, patience):
        self.patience, self.shown = patience, ""
        self.process, self.descriptor = pty.fork()
        if self.process == 0:
            os.chdir(directory)
            os.execvpe("bash", ["bash", "--noprofile", "--norc", "--noediting", "-i"], {**environment, "PS1": "ready> "})
        self.wait_for("ready> ")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
        os.kill(self.process, signal.SIGKILL)
        os.waitpid(self.process, 0)

    def close(self):
        """As closing its window does: what runs there gets HUP."""
        if self.descriptor is not None:
            os.close(self.descriptor)
            self.descriptor = None

    def type(self, text):
        os.write(self.descriptor, text.encode())

    def wait_for(self, pattern):
        """The match of a regular expression in what has been shown since the last one that was waited for."""
        end = time.monotonic() + self.patience
        while not (found := re.search(pattern, self.shown)):
            if not select.select([self.descriptor], [], [], max(0, end - time.monotonic()))[0]:
                raise AssertionError(f"no {pattern!r} after {self.patience} s: {self.shown}")
            self.shown += os.read(self.descriptor, 65536).decode(errors="replace")
        self.shown = self.shown[found.end():]
        return found

    def run(self, command):
        """Types a command whose exit status wait_for_status() tells."""
        self.type(f'{command}; echo "status=$?"\n')

    def wait_for_status(self):
        return int(self.wait_for(r"status=(\d+)\r\nready> ")[1])
