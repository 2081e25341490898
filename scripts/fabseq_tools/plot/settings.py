# SPDX-License-Identifier: MIT
"""Draws which setting matters, of runs that differ from defaults by one setting each.

    fabseq-tools plot-settings GROUP... [--picture settings.png]

A GROUP is a directory of runs, each in a folder SETTING_VOID with VOID `absent` or `quiet`, as a study with a
table like defaults_study.csv of benchmarks/evidence/studies leaves them; its folders `defaults_VOID` are what
the others are compared with. For each setting a row: how many times less than planar layers the optimized
sequence distorts, with smooth layers (circles) and with binary ones (diamonds); hollow where a constraint is
violated. Lines show the defaults. A panel each group and void model; the rows are in the order of the best
binary figure of the first.
"""

import os

import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullLocator

from fabseq_tools.plot.drawing import INK, OPTIMIZED, SOFT_INK, save, tidy
from fabseq_tools.run.command_line import RunError, parser_of, warn
from fabseq_tools.run.read_run import Run

COMMAND = "plot-settings"

VOIDS = ("absent", "quiet")


class Panel:
    """The finished runs of one group with one void model, by setting."""

    def __init__(self, directory, void):
        self.title = f"{os.path.basename(os.path.normpath(directory))}, void {void}"
        self.runs = {}
        for folder in sorted(os.listdir(directory)):
            setting, _, end = folder.rpartition("_")
            if end != void or not setting:
                continue
            try:
                self.runs[setting] = Run(os.path.join(directory, folder), with_fields=False)
            except RunError as reason:
                warn(COMMAND, reason)

    def gain(self, setting, block):
        """Distortion of planar layers over that of the run; 0 if there is no run."""
        run = self.runs.get(setting)
        return run.distortion("baseline") / run.distortion(block) if run else 0.0


def draw(panels):
    first = panels[0]
    settings = sorted(dict.fromkeys(s for panel in panels for s in panel.runs if s != "defaults"),
                      key=lambda s: max(first.gain(s, "binary"), 1e-9))
    settings.append("defaults")
    figure, axes = plt.subplots(1, len(panels), figsize=(3.0 + 2.6 * len(panels), 1.2 + 0.26 * len(settings)), sharey=True,
                                squeeze=False, constrained_layout=True)
    for axis, panel in zip(axes[0], panels):
        draw_panel(axis, panel, settings)
    axes[0, 0].set_yticks(range(len(settings)), [s.replace("_", " ") for s in settings])
    axes[0, 0].legend(frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(0.0, 1.07), ncols=2, borderaxespad=0.0)
    return figure


def draw_panel(axis, panel, settings):
    for block, colour, mark, label in (("optimized", OPTIMIZED, "o", "smooth layers"), ("binary", INK, "D", "binary layers")):
        if "defaults" in panel.runs:
            axis.axvline(panel.gain("defaults", block), color=colour, lw=1.0, ls="--" if block == "optimized" else "-", alpha=0.5)
        for row, setting in enumerate(settings):
            if setting not in panel.runs:
                continue
            feasible = panel.runs[setting].summary.get("feasible", True)
            axis.plot(panel.gain(setting, block), row, mark, ms=6, mec=colour, mfc=colour if feasible else "white", label=label)
            label = None
    axis.set_xscale("log")
    low, high = axis.get_xlim()
    stretch = max(1.0, 10.0 * low / high) ** 0.5  # a decade at least, so that a small factor looks small
    axis.set_xlim(low / stretch, high * stretch)
    axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.xaxis.set_major_formatter("{x:g}")
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_title(panel.title, fontsize=9, loc="left")
    axis.set_xlabel("planar / optimized", color=SOFT_INK)
    tidy([axis])


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("groups", nargs="+", metavar="GROUP")
    parser.add_argument("--picture", default="settings.png", help="picture to write (default: %(default)s)")
    arguments = parser.parse_args(words)
    panels = [panel for group in arguments.groups for void in VOIDS if (panel := Panel(group, void)).runs]
    if not panels:
        raise RunError("no finished run in any folder SETTING_absent or SETTING_quiet")
    save(draw(panels), arguments.picture, 150)
