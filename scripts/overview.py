#!/usr/bin/python3
"""One picture of an optimization: OUTPUT_DIRECTORY/overview.png.

    scripts/overview.py OUTPUT_DIRECTORY [--picture FILE.png] [--charts-only]

Shows the layers and the distorted shape of the planar and the optimized sequence side by side, how the optimization
went, and the thickness of the layers. Reads result.h5, summary.json, history.jsonl and config.json. Draws the parts with
VTK through xvfb-run; where that does not work it says so and draws the charts alone.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys

os.environ.setdefault("MPLBACKEND", "Agg")

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import FuncFormatter, MaxNLocator

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import render_part

INK, SOFT_INK, GRID = "#22262b", "#6b727b", "#e6e8eb"
OPTIMIZED, PLANAR, ALLOWED, VIOLATED = "#1f6f8b", "#b0762b", "#e3f0ea", "#c2452d"
DRAWN_DISPLACEMENT = 0.12  # largest drawn displacement, of the box's longest edge
RENDERING = "FABSEQ_RENDERING"  # set while this program runs again under xvfb-run


class Run:
    """What a finished optimization left in its directory."""

    def __init__(self, directory):
        self.directory = directory
        self.summary = self.read_json("summary.json")
        self.config = self.read_json("config.json")
        for block in ("optimized", "baseline"):
            if block not in self.summary:
                sys.exit(f"overview.py: {directory}/summary.json has no block '{block}': not an optimization's result")
        with open(os.path.join(directory, "history.jsonl"), encoding="utf-8") as file:
            self.history = [json.loads(line) for line in file if line.strip()]
        with h5py.File(os.path.join(directory, "result.h5")) as file:
            self.part = render_part.VoxelPart(file["density"][:], tuple(self.config["domain"]["size"]),
                                              self.config.get("build_plate", "z-"))
            self.layer = {"planar": file["planar/layer"][:], "optimized": file["layer"][:]}
            self.displacement = {"planar": render_part.node_vectors(self.part, file["planar/displacement"][:]),
                                 "optimized": render_part.node_vectors(self.part, file["displacement"][:])}

    def read_json(self, name):
        path = os.path.join(self.directory, name)
        try:
            with open(path, encoding="utf-8") as file:
                return json.load(file)
        except FileNotFoundError:
            sys.exit(f"overview.py: {path} is missing: not the directory of a finished run")

    @property
    def name(self):
        return self.config.get("name", "part").replace("_", " ")

    def distortion_index(self):
        """Number of the objective term that the picture is about: the first distortion, or the first term."""
        terms = [r for r in self.summary["baseline"]["responses"] if r["name"].startswith("objective_")]
        for index, term in enumerate(terms):
            if term["type"] == "distortion":
                return index
        return 0

    def distortion(self, block):
        name = f"objective_{self.distortion_index()}"
        return next(r["value"] for r in self.summary[block]["responses"] if r["name"] == name)

    def factor(self, block):
        value = self.distortion(block)
        return self.distortion("baseline") / value if value else float("inf")

    def thickness_constraint(self):
        return next((c for c in self.config.get("constraints", []) if c["type"] == "layer_thickness"), None)


def three_digits(value):
    """12.3, 1,234, 0.0123: three significant digits, no exponent for what a reader can take in."""
    if value == 0 or not np.isfinite(value):
        return f"{value:g}"
    if 1e-3 <= abs(value) < 1e6:
        digits = max(0, 2 - int(np.floor(np.log10(abs(value)))))
        return f"{value:,.{digits}f}"
    return f"{value:.2e}"


def style():
    plt.rcParams.update({
        "font.family": "DejaVu Sans", "font.size": 11, "text.color": INK, "axes.labelcolor": SOFT_INK,
        "axes.edgecolor": "#c5c9ce", "axes.spines.top": False, "axes.spines.right": False, "axes.titlesize": 13,
        "axes.titlelocation": "left", "axes.titleweight": "bold", "axes.titlepad": 12, "axes.grid": True,
        "axes.axisbelow": True, "grid.color": GRID, "grid.linewidth": 0.8, "xtick.color": SOFT_INK,
        "ytick.color": SOFT_INK, "xtick.labelsize": 10, "ytick.labelsize": 10, "axes.labelsize": 10.5,
        "legend.frameon": False, "legend.fontsize": 10, "xtick.major.size": 3, "ytick.major.size": 3})


def draw(run, picture, with_parts):
    style()
    figure = plt.figure(figsize=(16, 11.2), facecolor="white")
    headline(figure, run)
    if with_parts:
        draw_parts(figure, run)
        rows = (0.075, 0.235)
    else:
        rows = (0.12, 0.60)
    bottom, height = rows
    draw_convergence(figure.add_axes([0.065, bottom, 0.25, height]), run)
    draw_violation(figure.add_axes([0.385, bottom, 0.25, height]), run)
    draw_thickness(figure.add_axes([0.705, bottom, 0.265, height]), run)
    figure.savefig(picture, dpi=150)


def headline(figure, run):
    summary, blocks = run.summary, {"binary": "sharp layers", "optimized": "smooth layers"}
    present = [b for b in blocks if b in summary]
    factor = run.factor(present[0])
    if factor >= 1:
        text = f"{run.name}: {three_digits(factor)} times less distortion than planar layers"
    else:
        text = f"{run.name}: {three_digits(1 / factor)} times more distortion than planar layers"
    figure.text(0.035, 0.952, text[0].upper() + text[1:], fontsize=22, fontweight="bold")
    measures = ", ".join(f"{three_digits(run.distortion(b))} with {blocks[b]}" for b in present)
    layers = len(summary["optimized"]["layers"])
    elements = " × ".join(str(n) for n in run.part.density.shape[::-1])
    figure.text(0.035, 0.922, f"Distortion measure (sum of squared displacements): planar {three_digits(run.distortion('baseline'))},"
                f" optimized {measures}.   {elements} elements, {layers} layers, {summary['iterations']} iterations"
                f" in {duration(summary['seconds'].get('total', 0.0))}.", fontsize=11, color=SOFT_INK)


def duration(seconds):
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def draw_parts(figure, run):
    """Upper half: layers (left pair) and exaggerated distortion (right pair), all four in the same view."""
    part = run.part
    used = np.unique(part.faces)
    length = {kind: np.linalg.norm(vectors, axis=1) for kind, vectors in run.displacement.items()}
    largest = max(length[kind][used].max() for kind in length)
    exaggeration = round_number(DRAWN_DISPLACEMENT * max(part.size) / largest) if largest > 0 else 1.0
    displaced = {kind: exaggeration * vectors for kind, vectors in run.displacement.items()}
    frame = np.vstack([part.nodes[used]] + [part.nodes[used] + displaced[kind][used] for kind in displaced])

    top, height, width = 0.455, 0.38, 0.225
    lefts = {("layer", "planar"): 0.030, ("layer", "optimized"): 0.262, ("shape", "planar"): 0.518, ("shape", "optimized"): 0.750}
    pixels = (int(16 * width * 300), int(11.2 * height * 300))
    for (what, kind), left in lefts.items():
        if what == "layer":
            colours = render_part.layer_colours(part, run.layer[kind], run.layer[kind].max())
            image = render_part.render(part, face_colours=colours, frame=frame, pixels=pixels)
            label = f"{kind}, {used_layers(run.layer[kind])} layers"
        else:
            colours = render_part.scalar_colours(length[kind], largest, render_part.DISPLACEMENT_COLOURS)
            image = render_part.render(part, node_colours=colours, offset=displaced[kind], ghost=True, frame=frame, pixels=pixels)
            label = f"{kind}, largest displacement {three_digits(length[kind][used].max())}"
        axes = figure.add_axes([left, top, width, height])
        axes.imshow(image, interpolation="antialiased")
        axes.set_axis_off()
        figure.text(left + width / 2, top - 0.006, label, ha="center", va="top", fontsize=11,
                    color=PLANAR if kind == "planar" else OPTIMIZED, fontweight="bold")
    heading = dict(fontsize=13, fontweight="bold", va="bottom")
    figure.text(0.035, 0.857, "Layers, in the order they are built", **heading)
    figure.text(0.523, 0.857, f"Distorted shape, displacement drawn {exaggeration:g} times larger", **heading)
    scale(figure, [0.170, 0.405, 0.180, 0.012], render_part.LAYER_COLOURS, "built first", "built last")
    scale(figure, [0.658, 0.405, 0.180, 0.012], render_part.DISPLACEMENT_COLOURS, "0", three_digits(largest),
          "displacement")


def used_layers(layer):
    return len(np.unique(layer[layer > 0]))


def round_number(value):
    """The largest 1, 2 or 5 times a power of ten that is not above `value`."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(m * power for m in (1, 2, 5) if m * power <= value * (1 + 1e-12)))


def scale(figure, place, colours, low, high, title=""):
    axes = figure.add_axes(place)
    bar = figure.colorbar(ScalarMappable(Normalize(0, 1), colormaps[colours]), cax=axes, orientation="horizontal")
    bar.set_ticks([])
    bar.outline.set_visible(False)
    axes.grid(False)
    text = dict(transform=axes.transAxes, fontsize=10, color=SOFT_INK, va="center")
    axes.text(-0.03, 0.5, low, ha="right", **text)
    axes.text(1.03, 0.5, high, ha="left", **text)
    if title:
        axes.text(0.5, -1.2, title, ha="center", **text)


def draw_convergence(axes, run):
    index, planar = run.distortion_index(), run.distortion("baseline")
    values = np.array([entry["objective"][index] for entry in run.history]) / planar
    iterations = [entry["iteration"] for entry in run.history]
    axes.axhline(1.0, color=PLANAR, linewidth=1.2)
    axes.semilogy(iterations, values, color=OPTIMIZED, linewidth=2.0)
    axes.set_title("Distortion relative to planar")
    axes.set_xlabel("iteration")
    axes.xaxis.set_major_locator(MaxNLocator(6, integer=True))
    low, high = min(values.min(), 1.0), max(values.max(), 1.0)
    axes.set_ylim(low / 1.8, high * 2.5)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}" if v >= 1e-4 else f"{v:.0e}"))
    axes.yaxis.set_minor_formatter(lambda v, _: "")
    axes.annotate("planar", (1.0, 1.0), xycoords=("axes fraction", "data"), xytext=(0, 4), textcoords="offset points",
                  ha="right", color=PLANAR, fontsize=10)


def draw_violation(axes, run):
    iterations = [entry["iteration"] for entry in run.history]
    worst = [entry.get("worst_constraint") for entry in run.history]
    axes.set_title("Worst constraint violation")
    axes.set_xlabel("iteration")
    axes.xaxis.set_major_locator(MaxNLocator(6, integer=True))
    if not any(isinstance(value, (int, float)) for value in worst):
        axes.set_axis_off()
        axes.text(0.5, 0.5, "no constraints", transform=axes.transAxes, ha="center", color=SOFT_INK)
        return
    percent = np.array([np.nan if value is None else 100.0 * value for value in worst])
    axes.plot(iterations, percent, color=VIOLATED, linewidth=2.0)
    axes.set_yscale("symlog", linthresh=1.0, linscale=0.6)
    low, high = min(-1.0, 1.3 * np.nanmin(percent)), max(10.0, 1.8 * np.nanmax(percent))
    axes.set_ylim(low, high)
    axes.axhspan(low, 0.0, color=ALLOWED, zorder=0)
    axes.axhline(0.0, color="#7fa893", linewidth=1.0)
    decades = [10.0**k for k in range(0, 7) if 10.0**k <= high]
    axes.set_yticks([-d for d in decades if -d >= low][::-1] + [0.0] + decades)
    axes.set_yticks([], minor=True)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g} %"))
    axes.text(0.99, 0.0, "satisfied", transform=axes.get_yaxis_transform(), ha="right", va="top", color="#4f7d66", fontsize=10)


def draw_thickness(axes, run):
    thickness = [row["thickness"] for row in run.summary["optimized"]["layers"]]
    numbers = np.arange(1, len(thickness) + 1)
    heights = np.array([np.nan if value is None else value for value in thickness], dtype=float)
    constraint = run.thickness_constraint()
    axes.grid(False, axis="x")
    axes.set_title("Thickness of the layers")
    axes.set_xlabel("layer")
    axes.xaxis.set_major_locator(MaxNLocator(8, integer=True))
    axes.set_xlim(0.3, len(thickness) + 0.7)
    outside = np.zeros(len(thickness), dtype=bool)
    top = np.nanmax(heights) if np.isfinite(heights).any() else 1.0
    if constraint:
        low, high = (constraint["target"] * (1 + sign * constraint.get("tolerance", 0.1)) for sign in (-1, 1))
        axes.axhspan(low, high, color=ALLOWED, zorder=0)
        axes.axhline(constraint["target"], color="#7fa893", linewidth=1.0, zorder=1)
        axes.text(1.0, 1.0, f"allowed: {three_digits(low)} to {three_digits(high)}", transform=axes.transAxes, ha="right",
                  va="bottom", color="#4f7d66", fontsize=10)
        with np.errstate(invalid="ignore"):
            outside = (heights < low * (1 - 1e-3)) | (heights > high * (1 + 1e-3))
        top = max(top, high)
    axes.bar(numbers, heights, width=0.72, color=np.where(outside, VIOLATED, OPTIMIZED), zorder=2)
    axes.set_ylim(0, 1.12 * top)
    for number in numbers[~np.isfinite(heights)]:
        axes.text(number, 0, "–", ha="center", va="bottom", color=SOFT_INK)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory")
    parser.add_argument("--picture", help="file to write (default: overview.png in the directory)")
    parser.add_argument("--charts-only", action="store_true", help="leave out the pictures of the part")
    arguments = parser.parse_args()
    picture = arguments.picture or os.path.join(arguments.directory, "overview.png")
    run = Run(arguments.directory)
    if arguments.charts_only:
        draw(run, picture, with_parts=False)
    elif os.environ.get(RENDERING):
        draw(run, picture, with_parts=True)
    else:
        problem = draw_under_virtual_display()
        if problem:
            print(f"overview.py: the parts cannot be rendered ({problem}); the picture shows the charts alone", file=sys.stderr)
            draw(run, picture, with_parts=False)
    print(f"wrote {picture}")


def draw_under_virtual_display():
    """Runs this program again under xvfb-run, in a process of its own since a missing display ends VTK's. None, or what failed."""
    if not shutil.which("xvfb-run"):
        return "xvfb-run is not installed; scripts/setup.sh installs it"
    command = ["xvfb-run", "-a", "/usr/bin/python3", os.path.abspath(__file__)] + sys.argv[1:]
    done = subprocess.run(command, env={**os.environ, RENDERING: "1"}, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode == 0:
        return None
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    return f"exit status {done.returncode}" + (f", {lines[-1].strip()}" if lines else "")


if __name__ == "__main__":
    main()
