# SPDX-License-Identifier: MIT
"""Readers of the programs that post-processors write: what the machine is told, point by point."""

import dataclasses
import re

import numpy as np
from scipy.spatial.transform import Rotation

NUMBER = r"[-+]?\d*\.?\d+(?:[Ee][-+]?\d+)?"
BLOCK = re.compile(rf"([A-Z])\s*({NUMBER})")
TARGET = re.compile(r"(\w+) \[\[([^\]]*)\],\[([^\]]*)\],\[0,0,0,0\],\[(?:9E9,?){6}\]\], (\w+), (.*);")


@dataclasses.dataclass
class Told:
    """`points` (n, 3); `turns` (n, 3, 3): rotations of the tool's frame, or (n, 3) axes away from the tip;
    `arc` (n): whether it burns on the way to the point; `speeds` in mm/s; `pauses`: seconds, in order."""

    points: np.ndarray
    turns: np.ndarray
    arc: np.ndarray
    speeds: np.ndarray
    pauses: list


def read_gcode(text, rotary, sign=1.0):
    """Of a layer's file. `rotary`: names of the axes, `sign`: of their angles."""
    rows, arc, pauses, angles = [], False, [], []
    for line in re.sub(r"\([^)]*\)", "", text).splitlines():
        words = dict((name, float(value)) for name, value in BLOCK.findall(line)) if line[:1] in "GM" else {}
        if line.startswith(("M3", "M5")):
            arc = line.startswith("M3")
        elif words.get("G") == 4:
            pauses.append(words["X"] if "X" in words else words["P"])
        elif words.get("G") == 1:
            rows.append([words["X"], words["Y"], words["Z"], arc, words["F"] / 60.0])
            angles.append([words["C"], words[rotary[0]]])
    rows, angles = np.array(rows), sign * np.array(angles)
    axes = Rotation.from_euler({"AC": "ZX", "BC": "ZY"}[rotary], angles, degrees=True).apply([0.0, 0.0, 1.0])
    told = Told(rows[:, :3], axes, rows[:, 3] > 0, rows[:, 4], pauses)
    return told, angles


def read_rapid(text, weld, travel):
    """Of a layer's module. `weld`: speeds of the weld data by name, `travel`: of the data vTravel."""
    points, quaternions, arc, speeds, pauses, lit = [], [], [], [], [], False
    for line in text.splitlines():
        if found := re.match(rf"\s*WaitTime ({NUMBER});", line):
            pauses.append(float(found[1]))
        if not (found := TARGET.search(line)):
            continue
        name, rest = found[1], found[5].split(", ")
        points.append([float(value) for value in found[2].split(",")])
        quaternions.append([float(value) for value in found[3].split(",")])
        assert name == "MoveL" and not lit or name == "ArcLStart" and not lit or name in ("ArcL", "ArcLEnd") and lit, line
        assert rest[-1] == "tTorch\\WObj:=wPlate" and found[4] == "vTravel", line
        arc.append(lit)
        speeds.append(weld[rest[1]] if lit else travel)
        lit = name in ("ArcLStart", "ArcL")
    quaternions = np.array(quaternions)
    turns = Rotation.from_quat(np.roll(quaternions, -1, axis=1)).as_matrix()  # SciPy's scalar is the last
    return Told(np.array(points), turns, np.array(arc), np.array(speeds), pauses), quaternions


def weld_speeds(text):
    """Of the main module: by name, and that of travels."""
    weld = {name: float(value) for name, value in re.findall(rf"welddata (\w+):=\[({NUMBER}),", text)}
    return weld, float(re.search(rf"speeddata vTravel:=\[({NUMBER}),", text)[1])
