# SPDX-License-Identifier: MIT
"""Other commands as steps of a plan: what they print goes to a file."""

import contextlib


def quiet(main, words, log):
    """Runs a command with these words; what it prints stands in `log`."""
    with open(log, "w", encoding="utf-8") as file, contextlib.redirect_stdout(file), contextlib.redirect_stderr(file):
        main(words)
