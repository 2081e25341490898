# SPDX-License-Identifier: MIT
"""A Python that has the packages which the tools need. One that lacks them starts the tool again with
$FABSEQ_PYTHON, or else with Debian's Python. If this lacks them, too, the tool ends with one line, which says
what is missing and how to get it."""

import importlib.util
import os
import sys

PACKAGES = {"numpy": "python3-numpy", "scipy": "python3-scipy", "h5py": "python3-h5py", "matplotlib": "python3-matplotlib",
            "PIL": "python3-pil", "vtkmodules": "python3-paraview"}  # module: Debian's package
DEBIAN = "/usr/bin/python3"
RESTARTED = "FABSEQ_PYTHON_OF_FIRST_START"
first_python = os.environ.pop(RESTARTED, None)


def missing_packages():
    return [name for name in PACKAGES if importlib.util.find_spec(name) is None]


def require():
    """For a script that needs all packages, before it imports them."""
    if missing_packages():
        start_again()


def start_again():
    """Goes on in another Python, or ends. Does not return."""
    python = os.environ.get("FABSEQ_PYTHON") or DEBIAN
    if first_python is None:
        try:
            os.execve(python, [python, *sys.argv], {**os.environ, RESTARTED: sys.executable or "this Python"})
        except OSError as error:
            end(f"{sys.executable}, and {python} does not start ({error.strerror})")
    end(sys.executable if first_python == sys.executable else f"{first_python} nor in {sys.executable}")


def end(pythons):
    missing = missing_packages()
    sys.exit(f"{os.path.basename(sys.argv[0])}: no {', '.join(missing)} in {pythons}; install "
             f"{' '.join(PACKAGES[name] for name in missing)} (Debian), or name a Python that has them in FABSEQ_PYTHON")
