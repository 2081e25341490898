# SPDX-License-Identifier: MIT
"""The two systems of coordinates of a part, the build plate's and its drawing's, and their units."""

import os

import numpy as np

FRAMES = ("drawing", "plate")
MILLIMETRES = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8, "µm": 1e-3, "um": 1e-3, "μm": 1e-3, "micron": 1e-3,
               "inch": 25.4, "inches": 25.4, '"': 25.4, "feet": 304.8, "millimetre": 1.0, "millimeter": 1.0, "centimetre": 10.0,
               "centimeter": 10.0, "metre": 1000.0, "meter": 1000.0}  # the first name of a length is its short one
PLURALS = "metres", "meters", "microns"


class Placement:
    """From the config's coordinates, those of its box and of the build plate, to those of a frame: `drawing`,
    the part's own (of its mesh file, or else the config's), or `plate`, the config's themselves.

    `unit`: that of lengths in the frame, None where it has no name. `scale`: factor of lengths from the
    config to the frame. `system`: the coordinates in words. `millimetres`: how many of the placed part one
    unit of the frame is, None where `domain.unit` has a name that is not known; lengths of a config without
    unit are millimetres here."""

    def __init__(self, config, frame="drawing"):
        drawn = config if frame == "drawing" else {}
        matrix = np.array(drawn.get("run", {}).get("mesh_placement", np.eye(3, 4)), float)
        mesh = drawn.get("part", {}).get("mesh")
        self.frame, self.system = frame, f"those of {os.path.basename(mesh['file'])}" if mesh else "those of the config"
        self.inverse, self.shift = np.linalg.inv(matrix[:, :3]), matrix[:, 3]
        self.scale = float(np.cbrt(np.linalg.det(self.inverse)))
        given = config["domain"].get("unit") or None
        of_config = millimetres_of(given)
        self.millimetres = None if of_config is None else of_config / self.scale
        self.unit = given if np.isclose(self.scale, 1.0) else name_of_unit(self.millimetres) if given else None

    def points(self, points):
        return (points - self.shift) @ self.inverse.T

    def directions(self, directions):
        return directions @ self.inverse.T / self.scale

    def to_config(self, points):
        return points @ np.linalg.inv(self.inverse).T + self.shift

    def facts(self):
        """What files say of their coordinates."""
        return {"unit": self.unit, "frame": self.frame, "coordinates": self.system}


def millimetres_of(unit):
    """The length of a unit by its name, in mm; 1 without a name, None for one that is not known."""
    if unit is None:
        return 1.0
    name = unit.strip().lower()
    return MILLIMETRES.get(name.removesuffix("s") if name.endswith(PLURALS) else name)


def name_of_unit(millimetres):
    """None for a length that has no name."""
    return next((name for name, length in MILLIMETRES.items() if millimetres and np.isclose(length, millimetres)), None)
