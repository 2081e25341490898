# SPDX-License-Identifier: MIT
"""Where things lie: the program and the scripts, in a source tree or where `cmake --install` has put them."""

import os

NAME = "fabseq-tools"
SCRIPTS = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
ROOT = os.path.dirname(SCRIPTS)  # of the source tree, or share/fabseq
ENTRY = os.path.join(SCRIPTS, NAME)
ENVIRONMENT = os.path.join(SCRIPTS, "environment.sh")


def find_program():
    """FABSEQ_PROGRAM, the installed program, or the one of the tree's release build, there or not."""
    installed = os.path.join(ROOT, "fabseq")  # a link
    tree = os.path.join(ROOT, "build", "release", "fabseq")
    return os.environ.get("FABSEQ_PROGRAM") or (installed if os.path.isfile(installed) else tree)


PROGRAM = find_program()
