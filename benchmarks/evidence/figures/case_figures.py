# SPDX-License-Identifier: MIT
"""What a run of a published case comes to: rows of the table of figures, results/cases/cases.csv."""

import math

from fabseq_tools.run.read_run import Run, read_json
from fabseq_tools.run.words import duration

# Of a row; all are texts, empty where there is nothing to say. `cut_into`: of how many layers the figures
# are, if the pseudo-time was cut again. A factor is how many times less than planar layers the sequence
# distorts. `..._nominal` is of binary layers and the planar ones where material goes to nominal positions.
# Thickness is relative to the target, or a length (`thickness_in`).
COLUMNS = ("case", "cut_into", "planar", "smooth", "smooth_factor", "binary", "binary_factor", "planar_nominal",
           "binary_nominal", "nominal_factor", "constraints", "thickness_in", "thickness_smooth", "thickness_binary",
           "thickness_geometric", "print_angles", "interior_minima", "run")
TARGETS, LENGTHS = "targets", "lengths"


def rows_of(name, case, directory, thickness, resliced):
    """The rows of a case, from the output directory of its run. `thickness`: the geometric record, None for
    planar layers in sub-parts; `resliced`: by the number of layers summaries by kind and their record."""
    if case.get("task") == "simulate":
        return [{"case": name, **simulated(directory)}]
    return [{"case": name, **optimized(directory, thickness)},
            *({"case": name, "cut_into": str(count), **cut(found)} for count, found in resliced.items())]


def simulated(directory):
    summary = read_json(directory, "summary.json")
    nominal = summary["deposition"]["nominal"]
    published, built = (", ".join(number(r["value"]) for r in terms)
                        for terms in (filter(is_distortion, summary["responses"]), nominal["distortion"]))
    return {"planar": published, "planar_nominal": built,
            "run": f"simulated, largest displacement {number(summary['displacement']['max'])}, "
                   f"{number(nominal['displacement']['max'])} nominal"}


def optimized(directory, thickness):
    run = Run(directory, with_fields=False)
    summary = run.summary
    planar, smooth, binary = (distortion(summary[block]["responses"]) for block in ("baseline", "optimized", "binary"))
    worst = summary["worst_constraint"]
    ranks, before = run.config.get("run", {}).get("ranks"), summary.get("coarse_iterations", 0)
    iterations = f"{summary['iterations']} iterations" + (f" after {before} at half the resolution" if before else "")
    return {**gains(planar, smooth, binary), **nominal_gain(summary["baseline"], summary["binary"]),
            "constraints": "" if worst is None else "satisfied" if worst <= 0 else f"{two_digits(100 * worst)} % beyond",
            **(print_angles(summary) if "angles" in summary else thicknesses(run, thickness)),
            "interior_minima": str(summary["interior_minima"]),
            "run": f"{iterations}, {duration(summary['seconds']['total'])} on {ranks} rank{'s' * (ranks != 1)}"}


def cut(found):
    """Of a pseudo-time that was cut again, whose layers have no target of their own."""
    values = (distortion(found[kind]["responses"]) for kind in ("planar", "smooth", "binary"))
    return {**gains(*values), "thickness_in": LENGTHS, "thickness_geometric": geometric_text(found["thickness"], 1.0)}


def gains(planar, smooth, binary):
    return {"planar": number(planar), "smooth": number(smooth), "smooth_factor": factor(planar / smooth),
            "binary": number(binary), "binary_factor": factor(planar / binary)}


def nominal_gain(planar, binary):
    """What the same layers do where material goes to nominal positions."""
    of_planar, of_binary = (sum(term["value"] for term in block["deposition"]["nominal"]["distortion"])
                            for block in (planar, binary))
    return {"planar_nominal": number(of_planar), "binary_nominal": number(of_binary),
            "nominal_factor": factor(of_planar / of_binary)}


def distortion(responses):
    """Sum of all distortion terms, as published for two faces or edges."""
    return sum(r["value"] for r in responses if is_distortion(r))


def is_distortion(response):
    """Whether a response is a term of the objective that measures distortion: limits are none."""
    return response["type"] == "distortion" and response["name"].startswith("objective")


def print_angles(summary):
    """Of every sub-part: elevation, and in 3D the azimuth."""
    angles = ("/".join(f"{math.degrees(angle):.0f}°" for angle in of_part) for of_part in summary["angles"])
    return {"print_angles": ", ".join(angles)}


def thicknesses(run, geometric):
    """By the gradient, smooth and binary, and geometric, each relative to the target where there is one."""
    constraint = run.thickness_constraint()
    target = constraint["target"] if constraint else None
    texts = {f"thickness_{kind}": span(run.layers(block), target or 1.0)
             for kind, block in (("smooth", "optimized"), ("binary", "binary"))
             if all(layer["thickness"] is not None for layer in run.layers(block))}
    return {"thickness_in": TARGETS if target else LENGTHS, **texts,
            "thickness_geometric": geometric_text(geometric, target or 1.0)}


def span(layers, unit):
    values = [layer["thickness"] / unit for layer in layers]
    inner = values[:-1] or values
    return f"{min(inner):.3g} to {max(inner):.3g}; last {values[-1]:.3g}"


def geometric_text(record, unit):
    inner = record["inner"]
    return f"{inner['least'] / unit:.3g} to {inner['largest'] / unit:.3g}" if inner else ""


def number(value):
    """Three digits."""
    if value == 0 or 1e-2 <= abs(value) < 1e4:
        return f"{value:.3g}"
    return f"{value:.2e}".replace("e-0", "e-").replace("e+0", "e")


def two_digits(value):
    return f"{float(f'{value:.2g}'):g}"


def factor(value):
    return f"{value:.1f}" if value < 9.95 else f"{value:.0f}" if value < 99950 else f"{value:.1e}".replace("e+0", "e")
