# SPDX-License-Identifier: MIT
"""Lets a script run where its Python lacks the packages that it needs: once an import finds no NumPy, h5py,
Matplotlib, Pillow or VTK, the script starts again with $FABSEQ_PYTHON, or else with Debian's Python. If these
lack it, too, the script ends with one line. command_line.py imports this module, so that a script imports
command_line before any of these packages."""

import importlib.util
import os
import sys

PACKAGES = {"numpy": "python3-numpy", "h5py": "python3-h5py", "matplotlib": "python3-matplotlib", "PIL": "python3-pil",
            "vtkmodules": "python3-paraview"}  # module: Debian's package
DEBIAN = "/usr/bin/python3"
RESTARTED = "FABSEQ_PYTHON_OF_FIRST_START"
first_python = os.environ.pop(RESTARTED, None)


class Finder:
    """The last that is asked for a module: nobody else has found it."""

    @staticmethod
    def find_spec(name, _path=None, _target=None):
        if name in PACKAGES and is_script():
            start_again()
        return None


def is_script():
    """Whether a script of this tree runs, rather than a program that uses its modules."""
    program = getattr(sys.modules["__main__"], "__file__", None) or ""
    return tree_of(program) == tree_of(__file__)


def tree_of(path):
    return os.path.dirname(os.path.dirname(os.path.realpath(path)))


def start_again():
    python = os.environ.get("FABSEQ_PYTHON") or DEBIAN
    if first_python is None:
        try:
            os.execve(python, [python, *sys.argv], {**os.environ, RESTARTED: sys.executable or "this Python"})
        except OSError as error:
            end(f"{sys.executable}, and {python} does not start ({error.strerror})")
    end(sys.executable if first_python == sys.executable else f"{first_python} nor in {sys.executable}")


def end(pythons):
    sys.meta_path.remove(Finder)
    missing = [name for name in PACKAGES if importlib.util.find_spec(name) is None]
    sys.exit(f"{os.path.basename(sys.argv[0])}: no {', '.join(missing)} in {pythons}; install "
             f"{' '.join(PACKAGES[name] for name in missing)} (Debian), or name a Python that has them in FABSEQ_PYTHON")


sys.meta_path.append(Finder)
