# SPDX-License-Identifier: MIT
"""A display in memory for each command, however many start at once."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOL = Path(__file__).resolve().parents[2] / "scripts/fabseq-tools", "virtual-display"


def start(*command, **environment):
    return subprocess.Popen([*TOOL, *command], env={**os.environ, **environment}, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def server_of(process):
    """Process number of the server that `process`, fabseq-tools virtual-display, has started."""
    for child in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split():
        if Path(f"/proc/{child}/comm").read_text().strip() == "Xvfb":
            return child
    raise AssertionError(f"{process.pid} has no Xvfb")


class VirtualDisplay(unittest.TestCase):
    def test_each_command_has_its_own_and_it_ends_with_it(self):
        # Each waits for the end of its input, so that all displays are there at once; another test may take
        # their numbers afterwards.
        waiting = [start(sys.executable, "-c", "import os, sys; print(os.environ['DISPLAY'], flush=True); sys.stdin.read()")
                   for _ in range(6)]
        displays = [process.stdout.readline().strip() for process in waiting]
        servers = [server_of(process) for process in waiting]
        for process in waiting:
            process.communicate(timeout=60)
        self.assertEqual(len(set(displays)), len(displays), displays)
        for display, server in zip(displays, servers, strict=True):
            self.assertRegex(display, r"^:\d{3}$")  # mpirun looks at the first ten
            self.assertFalse(Path(f"/proc/{server}").exists(), display)

    def test_status_of_the_command(self):
        for code, status in (("", 0), ("import sys; sys.exit(7)", 7), ("import os; os.kill(os.getpid(), 15)", 143)):
            process = start(sys.executable, "-c", code)
            process.communicate(timeout=60)
            self.assertEqual(process.returncode, status, code)

    def test_windows_one_after_the_other(self):
        """A server that resets when its last client leaves refuses the next one now and then."""
        windows = ("from vtkmodules import vtkRenderingOpenGL2\n"
                   "from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow\n"
                   "for _ in range(60):\n"
                   "    window = vtkRenderWindow()\n"
                   "    window.AddRenderer(vtkRenderer())\n"
                   "    window.Render()\n"
                   "    window.Finalize()\n"
                   "    del window\n")
        process = start("/usr/bin/python3", "-c", windows, DISPLAY="")
        self.assertEqual((process.communicate(timeout=120)[1], process.returncode), ("", 0))

    def test_missing_command_and_missing_server(self):
        missing = start("no-such-program")
        self.assertIn("no-such-program: No such file or directory", missing.communicate(timeout=60)[1])
        self.assertEqual(missing.returncode, 1)
        with tempfile.TemporaryDirectory() as empty:
            process = subprocess.run([sys.executable, *TOOL, "pvpython"], env={"PATH": empty}, capture_output=True, text=True)
        self.assertEqual((process.returncode, process.stderr),
                         (1, "pvpython: needs a display, or Xvfb, which scripts/setup.sh installs\n"))


if __name__ == "__main__":
    unittest.main()
