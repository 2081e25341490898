# SPDX-License-Identifier: MIT
"""ABB RAPID: MoveL, and ArcLStart, ArcL and ArcLEnd with the arc on.

Positions: the wire's tip in millimetres in the work object wPlate: origin and axes of the config's box. The
tool's z axis points out of the torch into the layer; its x axis is that of --x-axis.

Orientations are quaternions [q1, q2, q3, q4], q1 the scalar, of the matrix whose columns are the tool's x, y
and z axes in the work object: q1 = sqrt(x1 + y2 + z3 + 1) / 2, q2 = sqrt(x1 - y2 - z3 + 1) / 2 with the sign
of y3 - z2, q3 and q4 likewise (ABB, "RAPID Reference Manual", orient, pages 7-orient-1 to 4,
www.yumpu.com/en/document/view/5679047/basic-characteristics-rapid/198). Signs of neighbours are alike.

Weld data hold until the position that their instruction goes to, and follow a path by other data (the same
manual, welddata, page 639 there): wNNNN welds at NNN.N mm/s with constant wire feed. Arguments of the
instructions stand as in programs for RobotWare Arc (ProcessDataModule.mod and Template_1001_Module.mod of
github.com/zwj12/ZhongXunRapid, RAATCfg/RAPID/TASK1/PROGMOD): target, speed, seam, weld, zone, tool. The
components of seamdata and welddata depend on the robot's configuration; these have nine numbers per set of
arc data, as there. --rapid-arc gives those of welding. Tool, work object and seam of fabseq_data.mod are
yours to measure; a file of that name is left as it is.

fabseq.pgf loads all modules; main calls the layers. Configurations of the axes are not monitored (ConfL
\\Off); the way to the first point is yours."""

import numpy as np
from scipy.spatial.transform import Rotation

from fabseq_tools.run.command_line import RunError

POST = "rapid"
ENDINGS, KEPT = (".mod", ".pgf"), ("fabseq_data.mod",)

EXTERNAL = "[9E9,9E9,9E9,9E9,9E9,9E9]"
ARC_DATA = "[0,0,0,0,0,0,0,0,0]"
DATA = f"""MODULE fabseq_data
  ! Measure tool and work object, and set the seam, before the arc is lit.
  TASK PERS tooldata tTorch:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,50],[1,0,0,0],0,0,0]];
  TASK PERS wobjdata wPlate:=[FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  TASK PERS seamdata seam1:=[0,0,{ARC_DATA},0,0,0,0,0,{ARC_DATA},0,0,{ARC_DATA},0,0,{ARC_DATA},0];
ENDMODULE
"""
MOST_LAYERS = 999
SPEED_STEP = 0.1  # mm/s, of weld data
ZONE = "z1"  # that points with the arc on are passed in


def add_options(group):
    group.add_argument("--rapid-zone", default=ZONE, help="of points with the arc on (default: %(default)s)")
    group.add_argument("--rapid-arc", default=ARC_DATA, help="arc data of the weld data (default: %(default)s)")


def program_files(program, options):
    if program.layers[-1].number > MOST_LAYERS:
        raise RunError(f"layers: found {program.layers[-1].number}; allowed for --post rapid: {MOST_LAYERS}")
    orientations, files, speeds = Orientations(), {}, set()
    for layer in program.layers:
        text = layer_module(layer, orientations, options.rapid_zone, speeds)
        files[f"layer_{layer.number:03d}.mod"] = text
    return {"fabseq.pgf": program_file(["fabseq_main.mod", "fabseq_data.mod", *files]), "fabseq_data.mod": DATA,
            "fabseq_main.mod": main_module(program, speeds, options.rapid_arc), **files}


def layer_module(layer, orientations, zone, speeds):
    lines = []
    for one in layer.stretches:
        targets = [target(*values) for values in zip(one.points, orientations.of(one))]
        if not one.arc:
            lines += [f"MoveL {place}, vTravel, {ZONE}, tTorch\\WObj:=wPlate;" for place in targets]
            continue
        names = ["ArcLStart", *["ArcL"] * (len(targets) - 2), "ArcLEnd"]
        for name, place, speed in zip(names, targets, one.speeds[[1, *range(1, len(targets))]]):
            speeds.add(tenths(speed))
            lines.append(f"{name} {place}, vTravel, seam1, w{tenths(speed):04d}, {zone if name == 'ArcL' else 'fine'}, "
                         "tTorch\\WObj:=wPlate;")
    lines[-1] = lines[-1].replace(f", {ZONE}, ", ", fine, ")
    if layer.pause:
        lines.append(f"WaitTime {layer.pause:.3f};")
    return module(f"Layer_{layer.number:03d}", [f"! {layer.words()}", *procedure(f"layer{layer.number:03d}", lines)])


def main_module(program, speeds, arc):
    """`speeds`: of the weld data, in steps of SPEED_STEP."""
    weld = [f"TASK PERS welddata w{speed:04d}:=[{speed * SPEED_STEP:.1f},0,{arc},{ARC_DATA}];" for speed in sorted(speeds)]
    lines = ["ConfL\\Off;", "ConfJ\\Off;", "SingArea\\Wrist;", *(f"layer{layer.number:03d};" for layer in program.layers)]
    return module("fabseq_main", [f"! {program.name}: {len(program.layers)} layers",
                                  f"CONST speeddata vTravel:=[{program.rapid_speed:g},100,5000,1000];", *weld,
                                  *procedure("main", lines)])


def module(name, lines):
    return "\n".join([f"MODULE {name}", *(f"  {line}" for line in lines), "ENDMODULE"]) + "\n"


def procedure(name, lines):
    return [f"PROC {name}()", *(f"  {line}" for line in lines), "ENDPROC"]


def program_file(names):
    return "\n".join(['<?xml version="1.0" encoding="ISO-8859-1" ?>', "<Program>",
                      *(f"  <Module>{name}</Module>" for name in names), "</Program>"]) + "\n"


class Orientations:
    """Quaternions along a program."""

    def __init__(self):
        self.last = np.array([1.0, 0.0, 0.0, 0.0])

    def of(self, stretch):
        result = quaternions(stretch.x_axes, np.cross(-stretch.axes, stretch.x_axes), -stretch.axes)
        for number, one in enumerate(result):
            self.last = result[number] = -one if one @ self.last < 0 else one
        return result


def quaternions(x, y, z):
    """q1 to q4 (n, 4) of matrices with these columns (n, 3)."""
    return np.roll(Rotation.from_matrix(np.stack([x, y, z], axis=2)).as_quat(), 1, axis=1)  # SciPy's scalar is the last


def tenths(speed):
    return max(1, int(round(speed / SPEED_STEP)))


def target(point, orientation):
    numbers = ["[" + ",".join(plain(value, digits) for value in values) + "]"
               for values, digits in ((point, 4), (orientation, 8))]
    return f"[{numbers[0]},{numbers[1]},[0,0,0,0],{EXTERNAL}]"


def plain(value, digits):
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
