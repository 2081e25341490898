# SPDX-License-Identifier: MIT
"""What a machine does to build a part, as post-processors take it: layers of stretches with the arc on or
off, in millimetres of the build plate's coordinates."""

import dataclasses
import os

import numpy as np

from fabseq_tools.geometry.grid import plate_height
from fabseq_tools.paths.thinning import kept, speeds_of_ways


@dataclasses.dataclass
class Stretch:
    """What the torch's tip does with the arc on or off. `points` (n, 3) in mm, unit `axes` (n, 3) from the
    layer towards the torch, unit `x_axes` (n, 3) of the tool's frames, whose z axes are `-axes`; `speeds` (n)
    in mm/s, each on the way to that point. The torch comes to the first point with the arc off; with `arc`,
    it is lit there and put out at the last. `coming`: it has the arc off and leads to a start."""

    arc: bool
    points: np.ndarray
    axes: np.ndarray
    x_axes: np.ndarray
    speeds: np.ndarray
    coming: bool = False


@dataclasses.dataclass
class ProgramLayer:
    """`number`: of the layer, from 1; `pause`: seconds after it. Its first and last stretch have the arc
    off."""

    number: int
    stretches: list
    pause: float

    def welding(self):
        """Length in mm and seconds with the arc on."""
        ways = [(lengths(one.points), one.speeds[1:]) for one in self.stretches if one.arc]
        return float(sum(way.sum() for way, _ in ways)), float(sum((way / speed).sum() for way, speed in ways))

    def words(self):
        length, seconds = self.welding()
        return (f"layer {self.number}: {sum(one.arc for one in self.stretches)} passes, {length:.0f} mm, "
                f"{seconds:.0f} s with the arc on, pause {self.pause:.0f} s")


@dataclasses.dataclass
class Program:
    """`name`: of the part; `layers`: in the order of deposition; `up`: unit normal of the plate; `plate`: its
    height along that, mm; `rapid_speed`: mm/s with the arc off; `tolerance`: of points left out, mm."""

    name: str
    layers: list
    up: np.ndarray
    plate: float
    rapid_speed: float
    tolerance: float

    def points(self, arc=False):
        """How many there are, or only those with the arc on."""
        return sum(len(one.points) for layer in self.layers for one in layer.stretches if one.arc or not arc)

    def seconds(self):
        """With the arc on, with it off but for the way to the first point, and of the pauses."""
        off, stretches = 0.0, [one for layer in self.layers for one in layer.stretches]
        for before, one in zip([None, *stretches], stretches):
            way = one.points[:1] if one.arc else one.points
            off += lengths(way if before is None else np.concatenate([before.points[-1:], way])).sum()
        return (sum(layer.welding()[1] for layer in self.layers), float(off / self.rapid_speed),
                sum(layer.pause for layer in self.layers))


def lengths(points):
    """Of the ways from each point to the next."""
    return np.linalg.norm(np.diff(points, axis=0), axis=1)


def program_of(part, passes, ways, speeds, pauses, tolerances, rapid_speed, millimetres):
    """The program of passes that have their frames, in the config's coordinates. `ways`: Travels; `speeds`:
    at the waypoints of each pass, in lengths of the config per second, `pauses`: by number of the layer;
    `tolerances`: to which points are thinned; `rapid_speed`: mm/s; `millimetres`: of a length of the
    config."""
    layers = []

    def off(way, one, end):
        count = len(way)
        return Stretch(False, millimetres * way, np.tile(one.axes[end], (count, 1)), np.tile(one.x_axes[end], (count, 1)),
                       np.full(count, rapid_speed), end == 0)

    for one, speed, before, after in zip(passes, speeds, ways[:-1], ways[1:]):
        if not layers or layers[-1].number != one.layer:
            layers.append(ProgramLayer(one.layer, [], pauses.get(one.layer) or 0.0))
        layers[-1].stretches += [off(before.coming, one, 0), welded(one, speed, tolerances, rapid_speed, millimetres),
                                 off(after.leaving, one, -1)]
    layers[-1].pause = 0.0
    return Program(part.name, layers, part.up, millimetres * plate_height(part.config), rapid_speed,
                   millimetres * tolerances.distance)


def welded(one, speeds, tolerances, rapid_speed, millimetres):
    """The stretch of a pass."""
    numbers = kept(one.points, one.axes, 1.0 / speeds, tolerances)
    on_ways = millimetres * speeds_of_ways(one.points, speeds, numbers)
    return Stretch(True, millimetres * one.points[numbers], one.axes[numbers], one.x_axes[numbers],
                   np.insert(on_ways, 0, rapid_speed))


def write_files(files, folder, endings, kept_names=()):
    """Writes texts by name into a folder, which then has no others with these endings. Files with one of the
    last names are left as they are where they are there."""
    os.makedirs(folder, exist_ok=True)
    for name in set(os.listdir(folder)) - set(files):
        if name.endswith(endings):
            os.remove(os.path.join(folder, name))
    for name, text in files.items():
        path = os.path.join(folder, name)
        if name not in kept_names or not os.path.exists(path):
            with open(path, "w", encoding="ascii", errors="replace", newline="\r\n") as file:
                file.write(text)
