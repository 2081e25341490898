# SPDX-License-Identifier: MIT
"""Five-axis G-code with tool centre point control (RTCP).

X, Y, Z: the wire's tip in millimetres (G21), absolute (G90), in coordinates fixed to the part: origin and
axes of the config's box, Z along the plate's normal. F: millimetres per minute (G94) of the tip along the
part.

Rotary axes in degrees, absolute, as the torch turns with respect to the part: counter-clockwise is positive,
looking from the positive end of the axis (LinuxCNC, "CNC Machine Overview", Rotational Axes,
linuxcnc.org/docs/html/gcode/machining-center.html). With --rotary AC the torch's axis, from the tip away, is
RotZ(C) RotX(A) z = (sin A sin C, -sin A cos C, cos A), with BC RotZ(C) RotY(B) z = (sin B cos C, sin B sin C,
cos B): C turns the part or carries the other axis, in a table or in a head. --table-signs turns both signs,
for controls that count the turn of the table: LinuxCNC's xyzac-trt-kins and xyzbc-trt-kins do so (its forward
kinematics, src/emc/kinematics/trtfuncs.c). Angles go on without jumps while the arc is on, and C may leave a
turn. Beyond 360 the next travel turns it back by whole turns.

--control fanuc: G43.4 H1 and G49 switch tool centre point control (type 1) on and off (FANUC Series 30i
Descriptions B-63942EN/02, "List of functions and program format",
www.cncmanuals.com/fanuc/657/series-30i-300i-300is-model-a-descriptions/page/441), G4 X is a pause in seconds,
M98 P calls a program, O1001 that of layer 1. --control linuxcnc: M428 and M429 do so in its configurations
with switchable kinematics, G64 P is the tolerance of its path, G4 P a pause in seconds, o<layer_001> call a
file of that name.

M3 lights the arc and M5 puts it out: with your codes, replace them. The wire feed is constant. Travels are
G1, too, since G0 need not be straight. main.nc calls the layers; the way to the first point is yours."""

import dataclasses

import numpy as np

from fabseq_tools.paths.frames import turning_angles
from fabseq_tools.run.command_line import RunError

POST = "gcode"
ENDINGS, KEPT = (".nc", ".ngc"), ()

MOST_TURN = 360.0  # degrees of C after which it is turned back
MOST_LAYERS = 999


@dataclasses.dataclass
class Control:
    """Words of a control. `tcp_on`: may have a place for the tolerance; `pause`: has one for seconds, and
    `call`, `begin`, `end` and the name of the `file` for the number of a layer. `frame`: around each file."""

    tcp_on: str
    tcp_off: str
    pause: str
    file: str
    call: str
    begin: str
    end: str
    frame: str


CONTROLS = {
    "fanuc": Control("G43.4 H1", "G49", "G4 X{:.3f}", "O{:04d}.nc", "M98 P{:04d}", "%\nO{:04d}", "M99\n%", "%"),
    "linuxcnc": Control("G64 P{:.4f}\nG43 H1\nM428", "M429\nG49", "G4 P{:.3f}", "layer_{:03d}.ngc", "o<layer_{:03d}> call",
                        "o<layer_{:03d}> sub", "o<layer_{0:03d}> endsub\nM2", "")}


def add_options(group):
    group.add_argument("--rotary", choices=("AC", "BC"), default="AC", help="rotary axes (default: %(default)s)")
    group.add_argument("--table-signs", action="store_true", help="angles count the turn of the table")
    group.add_argument("--control", choices=list(CONTROLS), default="fanuc", help="default: %(default)s")


def program_files(program, options):
    if not np.allclose(program.up, (0.0, 0.0, 1.0)):
        raise RunError("build_plate: found another face than z-; allowed for --post gcode: z-")
    if program.layers[-1].number > MOST_LAYERS:
        raise RunError(f"layers: found {program.layers[-1].number}; allowed for --post gcode: {MOST_LAYERS}")
    control = CONTROLS[options.control]
    extent = np.concatenate([one.points for layer in program.layers for one in layer.stretches])
    low, high = (" ".join(f"{axis}{number(value)}" for axis, value in zip("XYZ", end))
                 for end in (extent.min(axis=0), extent.max(axis=0)))
    kind = control.file.rpartition(".")[2]
    main = [*filter(None, [control.frame]), *(["O1000"] if options.control == "fanuc" else []),
            f"({plain(program.name)}: {len(program.layers)} layers, plate at Z{number(program.plate)})",
            f"(tip from {low})", f"(to {high})", "G21 G90 G94 G17 G40 G54", control.tcp_on.format(program.tolerance)]
    files, angles = {f"main.{kind}": ""}, Angles(options)
    for layer in program.layers:
        own = numbered(layer, options)
        files[control.file.format(own)] = text_of(layer, angles, control, own)
        main += [f"({layer.words()})", control.call.format(own)]
    main += [control.tcp_off, "M30", *filter(None, [control.frame])]
    files[f"main.{kind}"] = "\n".join(main) + "\n"
    return {name: text.upper() for name, text in files.items()} if options.control == "fanuc" else files


def numbered(layer, options):
    return layer.number + (1000 if options.control == "fanuc" else 0)


def text_of(layer, angles, control, own):
    lines = [control.begin.format(own), f"({layer.words()})"]
    for one in layer.stretches:
        turns = angles.of(one)
        blocks = [block(*values) for values in zip(one.points, turns, one.speeds)]
        lines += [blocks[0], "M3", *blocks[1:], "M5"] if one.arc else blocks
    if layer.pause:
        lines.append(control.pause.format(layer.pause))
    return "\n".join([*lines, control.end.format(own)]) + "\n"


class Angles:
    """Words of the rotary axes along a program."""

    def __init__(self, options):
        self.names, self.sign = options.rotary, -1.0 if options.table_signs else 1.0
        self.last = None

    def of(self, stretch):
        """Of its points, as texts. On the way to a start C may be turned back by whole turns."""
        turned = turning_angles(stretch.axes, self.last)
        shift = np.pi / 2.0 if self.names == "AC" else 0.0
        if stretch.coming and abs(np.degrees(turned[0, 0] + shift)) > MOST_TURN:
            turned[:, 0] -= 2.0 * np.pi * np.round((turned[0, 0] + shift) / (2.0 * np.pi))
        self.last = turned[-1]
        turning, tilting = self.sign * np.degrees(turned[:, 0] + shift), self.sign * np.degrees(turned[:, 1])
        return [f"{self.names[0]}{number(tilt)} C{number(turn)}" for tilt, turn in zip(tilting, turning)]


def block(point, turns, speed):
    return " ".join(["G1", *(f"{axis}{number(value)}" for axis, value in zip("XYZ", point)), turns, f"F{60.0 * speed:.1f}"])


def number(value):
    text = f"{value:.4f}"
    return "0.0000" if text == "-0.0000" else text


def plain(name):
    """Without what a comment cannot hold."""
    return "".join(sign if sign.isalnum() and sign.isascii() else "_" for sign in name)
