# SPDX-License-Identifier: MIT
"""Words on stderr about how far a command has come, for those that take longer than one waits in silence."""

import sys
import time

PAUSE = 10.0     # seconds between two lines of a file
TERMINAL = 0.2   # between two of a terminal, where each takes the place of the one before


class Progress:
    """`with Progress("layers") as progress: progress.say("3 of 27")`. Nothing is printed of what ends within
    a second on a terminal, or within 10 s elsewhere."""

    def __init__(self, what, stream=None, clock=time.monotonic):
        self.what, self.stream, self.clock = what, stream or sys.stderr, clock
        self.on_terminal = self.stream.isatty()
        self.shown, self.last = "", clock() + (1.0 - TERMINAL if self.on_terminal else 0.0)

    def say(self, text):
        now = self.clock()
        if now - self.last < (TERMINAL if self.on_terminal else PAUSE):
            return
        self.last = now
        line = f"{self.what}: {text}"
        if self.on_terminal:
            print(f"\r{line:<{len(self.shown)}}", end="", file=self.stream, flush=True)
            self.shown = line
        else:
            print(line, file=self.stream, flush=True)

    def steps(self, items, name):
        """Goes through the items, and says before each which one it is."""
        items = list(items)
        for number, item in enumerate(items, start=1):
            self.say(f"{name} {number} of {len(items)}")
            yield item

    def clear(self):
        """Takes the line away from the terminal, before other words."""
        if self.shown:
            print(f"\r{'':<{len(self.shown)}}\r", end="", file=self.stream, flush=True)
            self.shown = ""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.clear()


class Silent:
    """For callers that say nothing."""

    def say(self, text):
        pass

    def steps(self, items, _):
        return items


SILENT = Silent()
