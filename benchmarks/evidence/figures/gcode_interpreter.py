#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Runs five-axis programs through LinuxCNC's interpreter, and holds what it does against the waypoints.

    figures/gcode_interpreter.py RUN [--bead-width W] [--rs274 PROGRAM]

`fabseq-tools paths RUN --post gcode --control linuxcnc` writes a program for each pair of rotary axes and
either sign. rs274 reads all its files and says to which positions it moves (canonical commands). Those with
the arc on must be waypoints of paths.csv within 1e-3 mm and 1e-3 degrees of the axis, and layers, arcs and
pauses must agree with the run, whose unit of length must be mm. Without --rs274 the PATH is searched; where
it has no interpreter, Debian's package linuxcnc-uspace is unpacked in a temporary folder (`apt-get update`
first; nothing is installed). Ends with status 1 if anything differs."""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import RunError, parser_of, positive, run_script
from fabseq_tools.run.places import ENTRY

import numpy as np
from scipy.spatial.transform import Rotation

PACKAGES = "linuxcnc-uspace", "libboost-python1.74.0"
MOST = 1e-3  # mm and degrees
COMMAND = re.compile(r"(STRAIGHT_FEED|START_SPINDLE_CLOCKWISE|STOP_SPINDLE_TURNING|DWELL)\(([^)]*)\)")


def main():
    parser = parser_of(__doc__)
    parser.add_argument("run")
    parser.add_argument("--bead-width", type=positive)
    parser.add_argument("--rs274")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        installed = arguments.rs274 or shutil.which("rs274")
        interpreter, libraries = (installed, "") if installed else unpacked(folder)
        print("| rotary axes | moves | with the arc on | arcs | pauses, s | off, mm | off, degrees |\n|" + " --- |" * 7)
        alike = [one_program(arguments, folder, interpreter, libraries, rotary, sign)
                 for rotary in ("AC", "BC") for sign in (1, -1)]
    sys.exit(0 if all(alike) else 1)


def unpacked(folder):
    """The interpreter of Debian's package, and the folders of its libraries."""
    packages = os.path.join(folder, "packages")
    os.makedirs(packages)
    try:
        subprocess.run(["apt-get", "download", "-o", "APT::Sandbox::User=", *PACKAGES], cwd=packages, check=True,
                       capture_output=True)
        for name in os.listdir(packages):
            subprocess.run(["dpkg-deb", "--extract", name, "root"], cwd=packages, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise RunError(f"{', '.join(PACKAGES)} cannot be had from Debian's archive; allowed: --rs274 PROGRAM") from error
    root = os.path.join(packages, "root", "usr")
    return os.path.join(root, "bin", "rs274"), f"{root}/lib:{root}/lib/x86_64-linux-gnu"


def one_program(arguments, folder, interpreter, libraries, rotary, sign):
    """Prints its row. Returns whether all is as it should be."""
    output = os.path.join(folder, f"{rotary}{sign}")
    width = ["--bead-width", str(arguments.bead_width)] if arguments.bead_width else []
    done = subprocess.run([sys.executable, ENTRY, "paths", arguments.run, *width, "--no-picture", "--frame", "plate", "--output",
                           output, "--post", "gcode", "--control", "linuxcnc", "--rotary", rotary,
                           *["--table-signs"] * (sign < 0)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RunError(done.stderr.strip())
    moves, lit, arcs, pauses = interpreted(output, interpreter, libraries)
    with open(os.path.join(output, "paths.csv"), encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    with open(os.path.join(output, "paths_summary.json"), encoding="utf-8") as file:
        record = json.load(file)
    off, turned = farthest(moves[lit], rows, rotary, sign)
    expected = [layer["pause"] for layer in record["layers"][:-1] if layer["pause"]]
    same = (lit.sum() + arcs == record["programs"]["welded_points"] and arcs == record["starts"]
            and np.allclose(pauses, expected, atol=1e-3) and off < MOST and turned < MOST)
    print(f"| {'' if sign > 0 else '-'}{rotary} | {len(moves)} | {lit.sum()} | {arcs} | {sum(pauses):.0f} | {off:.2g} | "
          f"{turned:.2g} |{'' if same else ' differs'}", flush=True)
    return same


def interpreted(output, interpreter, libraries):
    """Positions x, y, z, a, b, c of moves (n, 6), whether the arc burns (n), how often it is lit, pauses."""
    folder = os.path.join(output, "gcode")
    for code in ("tcp_on", "tcp_off"):  # M428 and M429 switch the machine's kinematics, of which there is none
        with open(os.path.join(output, f"{code}.ngc"), "w", encoding="ascii") as file:
            file.write(f"o<{code}> sub\no<{code}> endsub\nM2\n")
    files = {"machine.ini": f"[RS274NGC]\nSUBROUTINE_PATH = {folder}:{output}\nREMAP = M428 modalgroup=10 ngc=tcp_on\n"
                            "REMAP = M429 modalgroup=10 ngc=tcp_off\n", "tools.tbl": "T1 P1 Z0 D0\n", "parameters.var": ""}
    for name, text in files.items():
        with open(os.path.join(output, name), "w", encoding="ascii") as file:
            file.write(text)
    done = subprocess.run([interpreter, "-g", "-i", "machine.ini", "-t", "tools.tbl", "-v", "parameters.var",
                           os.path.join(folder, "main.ngc")], cwd=output, capture_output=True, text=True, check=False,
                          env={**os.environ, **({"LD_LIBRARY_PATH": libraries} if libraries else {})})
    if done.returncode or "PROGRAM_END()" not in done.stdout:
        raise RunError(f"rs274: status {done.returncode}: {(done.stdout + done.stderr).strip()[-300:]}")
    moves, lit, arcs, pauses, burns = [], [], 0, [], False
    for name, words in COMMAND.findall(done.stdout):
        if name == "DWELL":
            pauses.append(float(words))
        elif name == "STRAIGHT_FEED":
            moves.append([float(word) for word in words.split(",")])
            lit.append(burns)
        else:
            arcs += name == "START_SPINDLE_CLOCKWISE"
            burns = name == "START_SPINDLE_CLOCKWISE"
    return np.array(moves), np.array(lit), arcs, pauses


def farthest(moves, rows, rotary, sign):
    """Of moves from the waypoints next to them, in mm and in degrees of the axis."""
    waypoints, axes = (np.array([[float(row[name]) for name in names] for row in rows])
                       for names in (("x", "y", "z"), ("axis_x", "axis_y", "axis_z")))
    angles = sign * moves[:, [5, 3 if rotary == "AC" else 4]]
    found = Rotation.from_euler("ZX" if rotary == "AC" else "ZY", angles, degrees=True).apply([0.0, 0.0, 1.0])
    away = np.array([np.linalg.norm(waypoints - move[:3], axis=1) for move in moves])
    near = axes[np.argmin(away, axis=1)]
    return away.min(axis=1).max(), np.degrees(2.0 * np.arcsin(0.5 * np.linalg.norm(near - found, axis=1))).max()


if __name__ == "__main__":
    run_script(main)
