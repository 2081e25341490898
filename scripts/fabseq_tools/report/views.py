# SPDX-License-Identifier: MIT
"""What the 3D views of a report show: grids of the part, its times, displacements and other fields, as few
bytes that the page unpacks (report/src/unpack.js)."""

import base64
import math
import zlib

import numpy as np

from fabseq_tools.geometry.grid import element_edges, nodes_of
from fabseq_tools.geometry.slopes import element_slopes, node_slopes
from fabseq_tools.report.words import unit_of
from fabseq_tools.run.check_words import percent, thickness_limits, tilt_limit
from fabseq_tools.run.verdict_words import FAULTS, GROUPS
from fabseq_tools.run.words import number

LARGEST = 4_000_000      # bytes of all views together, as text
MOST_ELEMENTS = 800_000  # of one part; with more the slider would be slow
STEPS = {"time": 4095, "displacement": 1023}  # between the smallest and the largest value
OTHER_STEPS = 255        # of colours only
MISSING = 65535          # where a field has no value
SHOWN_THICKNESS = 1.5    # times the usual one: no larger ones are told apart

# What of result.h5 is shown in the views, and under which name.
FIELDS = {"layer": {"label": "layer", "colours": "layers"},
          "fault": {"label": "what cannot be built", "colours": "faults",
                    "kinds": [{"label": words, "colour": colour} for _, words, colour in FAULTS]},
          "time": {"label": "pseudo-time", "colours": "layers"},
          "displacement": {"label": "displacement", "colours": "heat", "length": True},
          "stress": {"label": "residual stress (von Mises)", "colours": "heat", "unit": "stress units"},
          "local_thickness": {"label": "local layer thickness", "colours": "diverging", "length": True, "open": True},
          "blocked": {"label": "depth of collisions with the torch", "colours": "heat", "length": True},
          "tilt": {"label": "tilt of the torch", "colours": "heat", "unit": "degrees"},
          "interpass_temperature": {"label": "temperature after the layer's pause", "colours": "heat", "unit": "°C"},
          "hanging": {"label": "what begins in the air", "colours": "marked", "words": ["on something", "begins in the air"]},
          "out_of_range": {"label": "thickness out of range", "colours": "marked", "words": ["in its range", "out of range"]}}
MARKS = ("hanging", "out_of_range")  # 0 or 1
FROM_LEAST = ("local_thickness", "interpass_temperature")  # fields whose colours begin at the least value, not at 0
STORED = ("layer", "fault", "local_thickness", "blocked", "tilt", "hanging", "interpass_temperature")  # of elements, each state
ORDER = "start", "baseline", "baseline_tilted", "baseline_even", "binary", "simulated"  # of the views
LARGEST_OF = ("layer", *MARKS, "blocked", "fault")  # fields of which a coarser element shows the largest value, not the mean


def views_of(run, labels):
    """The part and a view for each state that result.h5 holds, as arrays. `labels`: words by state."""
    shapes = {"binary": "binary/"} if "binary/displacement" in run.fields else {}
    prefixes = {state: (GROUPS[state], shapes.get(state, GROUPS[state])) for state in ORDER}
    return [{**view_of(run, state, group, shape), "label": labels[state], "state": state}
            for state, (group, shape) in prefixes.items()
            if state in labels and {group + "time", group + "layer", shape + "displacement"} <= set(run.fields)]


def view_of(run, state, group, shape):
    """Fields of elements, and the displacement; `released` has what is another after the release. `notes`:
    what is said below the view, by field."""
    fields = {name: run.fields[group + name].astype(float) for name in STORED if group + name in run.fields}
    if "local_thickness" not in fields:
        fields |= local_thickness(run, state, group)
    notes = field_notes(run, fields)
    if "local_thickness" in fields:
        limits, thickness = thickness_limits(run), fields["local_thickness"]
        most = limits[1] if limits else SHOWN_THICKNESS * np.nanmedian(thickness[run.fields["density"] > 0])
        fields["local_thickness"] = np.minimum(thickness, most)
        if limits:
            fields["out_of_range"] = 1.0 - ((thickness >= limits[0]) & (thickness <= limits[1]))
            share = np.mean(fields["out_of_range"][run.fields["density"] > 0])
            notes["out_of_range"] = f"{percent(share)} of the part's elements"
    displacement = np.moveaxis(run.fields[shape + "displacement"], -1, 0)
    view = {"time": run.fields[group + "time"], "displacement": displacement, "fields": fields, "notes": notes}
    if state == "simulated" and "residual_stress" in run.fields:
        fields["stress"] = von_mises(run.fields["residual_stress"])
    elif shape + "von_mises" in run.fields:
        fields["stress"] = run.fields[shape + "von_mises"].astype(float)
    if shape + "release_displacement" in run.fields:
        release = np.moveaxis(run.fields[shape + "release_displacement"], -1, 0)
        view["released"] = {"displacement": displacement + release, "fields": {}}
        if "stress" in fields and "released_stress" in run.fields:
            view["released"]["fields"]["stress"] = von_mises(run.fields["released_stress"])
    return view


def field_notes(run, fields):
    """What is said of a field below the view that shows it."""
    notes, part = {}, run.fields["density"] > 0
    if "local_thickness" in fields:
        known = fields["local_thickness"][part & np.isfinite(fields["local_thickness"])]
        ends = list(dict.fromkeys(number(end(known)) for end in (np.min, np.max) if known.size))
        if ends:
            notes["local_thickness"] = f"{'between ' * (len(ends) > 1)}{' and '.join(ends)} {unit_of(run)}"
    for name, words in (("hanging", "in the air"), ("blocked", "out of the torch's reach")):
        if name in fields:
            count = int((fields[name][part] > 0).sum())
            notes[name] = f"{count:,} element{'s' * (count != 1)} {words}"
    if "tilt" in fields:
        notes["tilt"] = f"up to {number(np.max(fields['tilt'][part]))} degrees{'' if tilt_limit(run) else ', no limit'}"
    if "interpass_temperature" in fields:
        least, largest = (number(end(fields["interpass_temperature"][part])) for end in (np.min, np.max))
        notes["interpass_temperature"] = f"between {least} and {largest} °C"
    return notes


def von_mises(stress):
    """Equivalent stress of Voigt components, of plane stress in 2D."""
    if stress.shape[-1] == 3:
        xx, yy, xy = np.moveaxis(stress, -1, 0)
        return np.sqrt(xx**2 - xx * yy + yy**2 + 3 * xy**2)
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.sqrt(0.5 * ((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2) + 3 * (xy**2 + yz**2 + zx**2))


def local_thickness(run, state, group):
    """Step of a layer in pseudo-time over |grad t|, in each element: NaN where the time does not rise. Empty
    where the files do not tell: times of elements, multi-planar layers, varying time points of the start."""
    kind, cut = run.config.get("sequence", {}).get("type"), run.config.get("layers", {})
    time, layer = run.fields[group + "time"], run.fields[group + "layer"]
    block = run.summary.get(state, {}).get("layers") or []
    planar = state == "baseline" or kind == "planar"
    # t of the nodes, or T = 1 − t.
    nodal = next((run.fields[group + name] for name in ("temperature", "nodal_time") if group + name in run.fields), None)
    if not block or not planar and (cut.get("type") != "curved" or nodal is None):
        return {}
    steps = np.full(len(block), 1.0 / len(block))
    if not planar and cut.get("time_points") == "variable":
        if group:
            return {}
        steps = np.diff(np.concatenate([[0.0], run.fields["time_points"], [1.0]]))
    spacing = element_edges(run.config)[::-1]
    slopes = element_slopes(time, run.fields["density"] > 0, spacing) if planar else node_slopes(nodal, spacing)
    steepness = np.sqrt(sum(slope**2 for slope in slopes))
    step = np.take(steps, np.clip(layer.astype(int) - 1, 0, len(steps) - 1)) + np.maximum(np.maximum(time - 1.0, -time), 0.0)
    return {"local_thickness": np.where(steepness > 0, step / np.where(steepness > 0, steepness, 1.0), np.nan)}


def packed_scene(runs):
    """Parts and views of all runs, (run, views) each, ready for JSON, on coarser grids where the page would
    grow too large. Also by how many elements an edge each part is coarser."""
    factors = [1] * len(runs)
    for position, (run, views) in enumerate(runs):
        while views and (coarsened(run.fields["density"], factors[position], np.max) > 0).sum() > MOST_ELEMENTS:
            factors[position] += 1
    while True:
        scene = {"parts": [], "views": [], "fields": {}}
        for (run, views), factor in zip(runs, factors):
            add_part(scene, run, views, factor)
        if sum(map(text_size, (scene["parts"], scene["views"]))) <= LARGEST or not scene["views"]:
            return scene, factors
        factors = [factor + 1 for factor in factors]


def text_size(content):
    """Characters of all the packed arrays in nested lists and dictionaries."""
    if isinstance(content, str):
        return len(content)
    entries = content.values() if isinstance(content, dict) else content if isinstance(content, list) else ()
    return sum(map(text_size, entries))


def add_part(scene, run, views, factor):
    if not views:
        return
    part = run.fields["density"] > 0
    built = coarsened(part.astype(float), factor, np.max) > 0
    spacing = [factor * edge for edge in element_edges(run.config)]
    scene["parts"].append({"spacing": spacing, "plate": run.config.get("build_plate", "z-"), "built": pack(built)})
    for view in views:
        time = coarsened(np.where(part, view["time"], np.nan), factor, np.mean)
        shape = packed_shape(run, view, part, built, factor)
        ranges = {"time": [0.0, 1.0], **shape["ranges"]}
        scene["views"].append({**shape, "label": view["label"], "state": view["state"], "part": len(scene["parts"]) - 1,
                               "ranges": ranges, "time": pack(time, STEPS["time"]), "notes": view["notes"]})
        if "released" in view:
            scene["views"][-1]["released"] = packed_shape(run, view["released"], part, built, factor)
        scene["fields"] |= {name: FIELDS[name] for name in FIELDS if name in ranges}


def packed_shape(run, shape, part, built, factor):
    """Displacement, fields and the ranges of both, as built or released."""
    fields = {name: coarsened(np.where(part, values, np.nan), factor, np.max if name in LARGEST_OF else np.mean)
              for name, values in shape["fields"].items()}
    nodes = np.array([coarsened_nodes(component, part, factor) for component in shape["displacement"]])
    length = np.sqrt((nodes**2).sum(axis=0))[nodes_of(built).reshape(nodes.shape[1:])].max()
    ranges = {"displacement": [0.0, float(length)]} | {name: shown_range(name, values, run) for name, values in fields.items()}
    return {"displacement": pack(nodes, STEPS["displacement"], 1), "ranges": ranges,
            "fields": {name: pack(values) for name, values in fields.items()}}


def shown_range(name, values, run):
    if name == "local_thickness" and thickness_limits(run):
        return thickness_limits(run)
    if name in MARKS:
        return [0.0, 1.0]
    if name == "fault":  # two colours for each kind, by turns from layer to layer
        return [0.0, 2.0 * len(FAULTS) + 1.0]
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return [1.0 if name == "layer" else low if name in FROM_LEAST else 0.0, high]


def coarsened(values, factor, how):
    """Blocks of factor^d elements as one: np.max or np.mean of those that are not NaN."""
    if factor == 1:
        return values
    values = np.pad(values, [(0, -n % factor) for n in values.shape], constant_values=np.nan)
    shape = [k for n in values.shape for k in (n // factor, factor)]
    inner = tuple(range(1, 2 * values.ndim, 2))
    blocks = np.ma.masked_invalid(values.reshape(shape))
    return (blocks.max(axis=inner) if how is np.max else blocks.mean(axis=inner)).filled(np.nan)


def coarsened_nodes(values, part, factor):
    """Every factor-th node; one that is no node of the part has the mean of those around it that are."""
    touched = nodes_of(part).reshape(values.shape)
    if factor == 1:
        return np.where(touched, values, 0.0)
    shape = [math.ceil((n - 1) / factor) + 1 for n in values.shape]
    total, count = np.zeros(shape), np.zeros(shape)
    padded = [np.pad(array, [(factor, (k - 1) * factor + 1 + factor - n) for k, n in zip(shape, array.shape)])
              for array in (np.where(touched, values, 0.0), touched.astype(float))]

    def around(offset):
        at = tuple(slice(o, o + (k - 1) * factor + 1, factor) for o, k in zip(offset, shape))
        return padded[0][at], padded[1][at]

    for offset in np.ndindex(*[2 * factor + 1] * values.ndim):
        value, there = around(offset)
        total, count = total + value, count + there
    own, known = around([factor] * values.ndim)
    return np.where(known > 0, own, total / np.maximum(count, 1.0))


def pack(values, steps=OTHER_STEPS, leading=0):
    """Values as so many steps between the smallest and the largest; differences along each axis but the
    `leading` ones, which are small where a field is smooth; low bytes before high ones; deflated."""
    values = values.astype(float)
    known = np.isfinite(values)
    low, high = (float(values[known].min()), float(values[known].max())) if known.any() else (0.0, 0.0)
    step = (high - low) / steps if high > low else 1.0
    if not np.any(values[known] % 1) and high - low < MISSING:
        step = 1.0  # whole numbers stay what they are
    whole = np.where(known, np.rint((np.where(known, values, low) - low) / step), MISSING).astype(np.uint16)
    for axis in range(leading, values.ndim):
        whole = np.diff(whole, axis=axis, prepend=np.uint16(0))
    small = (whole << 1) ^ np.where(whole & 0x8000, 0xFFFF, 0).astype(np.uint16)
    halves = small.astype("<u2").ravel().view(np.uint8).reshape(-1, 2).T
    text = base64.b64encode(zlib.compress(halves.tobytes(), 9)).decode("ascii")
    return {"shape": list(values.shape), "leading": leading, "low": low, "step": step, "data": text}
