# SPDX-License-Identifier: MIT
"""Adds to the output directory of a run what the program concludes of places: classes, places, the answer,
and the fields `fault`. Places are groups of elements that touch each other, made up from the fields that
there are."""

import json
import os
import sys

import h5py
import numpy as np
from scipy import ndimage

from fabseq_tools.geometry.grid import element_centres, element_edges, origin_of
from fabseq_tools.run.verdict_words import CLASSES, FAULTS, GROUPS, TITLES, verdict_of

KINDS = [name for name, _, _ in FAULTS]
REMEDIES = {"hanging": "begins in the air in layer {}: close it and drill", "local_thickness": "is too thick in layer {}",
            "tilt": "is tilted too far in layer {}", "blocked": "is out of the torch's reach in layer {}"}
LARGEST_SHARE = 0.02  # of a part that is buildable but for places
KEPT = 50


def add_places(directory):
    """Classes follow from the shares of the part: none, up to LARGEST_SHARE, more."""
    path = os.path.join(directory, "summary.json")
    with open(path, encoding="utf-8") as file:
        summary = json.load(file)
    with open(os.path.join(directory, "config.json"), encoding="utf-8") as file:
        config = json.load(file)
    with h5py.File(os.path.join(directory, "result.h5"), "r+") as file:
        for state, group in GROUPS.items():
            block = summary if state == "simulated" and "responses" in summary else summary.get(state)
            if block is not None and group + "layer" in file:
                fault = fault_of(file, group, config)
                file.pop(group + "fault", None)
                file[group + "fault"] = fault
                block.update(found_in(fault, file[group + "layer"][()], file["density"][()] > 0, config))
    if "baseline_matched" in summary:
        summary["baseline_matched"].update({key: summary["baseline"][key] for key in ("verdict", "places", "places_in_all")})
    if "binary" in summary:
        summary["answer"] = answer_of(summary, config)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(summary, file)


def fault_of(file, group, config):
    part = file["density"][()] > 0
    fault = np.zeros(part.shape)
    limits = {"hanging": 0.0, "tilt": config.get("tool", {}).get("max_tilt", 180.0), "blocked": 0.0}
    for name, limit in reversed(limits.items()):
        if group + name in file:
            fault[part & (file[group + name][()] > limit)] = 1 + KINDS.index(name)
    return fault


def found_in(fault, layer, part, config):
    places, edges = [], np.array(element_edges(config))
    for number, kind in enumerate(KINDS, start=1):
        labels, count = ndimage.label(fault == number, np.ones((3,) * fault.ndim))
        places += [place_of(kind, np.argwhere(labels == k), layer, edges, part, config) for k in range(1, count + 1)]
    places.sort(key=lambda place: -place["elements"])
    share = sum(place["share"] for place in places)
    name = CLASSES[0] if not places else CLASSES[1] if share <= LARGEST_SHARE else CLASSES[2]
    many = f"{len(places)} place{'s' * (len(places) > 1)}"
    reasons = [{"name": place["kind"], "share": share, "worst": None, "at": place["centre"],
                "words": f"{100 * share:.2g} % of the part has {many} like {place['words']}"} for place in places[:1]]
    words = {CLASSES[0]: "buildable", CLASSES[1]: f"buildable but for {many}",
             CLASSES[2]: f"not buildable: {reasons[0]['words'] if reasons else ''}"}[name]
    return {"verdict": {"buildable": not places, "class": name, "words": words, "reasons": reasons}, "places": places[:KEPT],
            "places_in_all": len(places)}


def place_of(kind, cells, layer, edges, part, config):
    width, height = config.get("tool", {}).get("bead_width") or 2 * edges[0], 4 * edges[0]
    low, high = (origin_of(config) + edges * corner[::-1] for corner in (cells.min(axis=0), cells.max(axis=0) + 1))
    extent = sorted((high - low)[:-1], reverse=True) + [(high - low)[-1]]
    first, volume = int(layer[tuple(cells.T)].min()), len(cells) * float(edges.prod())
    centre = [round(float(x), 2) for x in element_centres(config, cells).mean(axis=0)]
    form = {"hanging": "roof", "local_thickness": "thick"}.get(kind)
    name = {"hanging": "a roof", "local_thickness": "a layer"}.get(kind, "a place")
    size = " x ".join(f"{x:.3g}" for x in extent)
    return {"kind": kind, "form": form, "elements": len(cells), "share": len(cells) / int(part.sum()), "volume": volume,
            "begins": volume, "extent": extent, "beads": [x / y for x, y in zip(extent, [width] * (len(edges) - 1) + [height])],
            "centre": centre, "lower": low.tolist(), "upper": high.tolist(), "layer": first, "small": bool(max(extent) < width),
            "worst": None if kind == "hanging" else 46.0,
            "words": f"{name} of {size} {config['domain'].get('unit') or ''} near {centre} {REMEDIES[kind].format(first)}"}


def answer_of(summary, config):
    """The alternative is the one with the least rms among those of the same class or better."""
    released = any(term.get("after_release") for term in config["objective"])
    key = "released" if released else "as_built"

    def skin(state):
        return (summary[state].get("finished", {}).get(key) or {}).get("skin") or {"rms": None, "max": None}

    ours = CLASSES.index(verdict_of(summary["binary"])["class"])
    good = [state for state in TITLES if state.startswith("baseline") and state in summary
            and CLASSES.index(verdict_of(summary[state])["class"]) <= ours and skin(state)["rms"]]
    best = min(good, key=lambda state: skin(state)["rms"], default=None)
    figures = {name: {"rms": skin(name)["rms"], "largest": skin(name)["max"]} for name in ("binary", best) if name}
    return {"class": CLASSES[ours], "gain": figures[best]["rms"] / figures["binary"]["rms"] if best else None,
            "best_alternative": {"block": best, "title": TITLES[best], "class": verdict_of(summary[best])["class"],
                                 **figures[best]} if best else None,
            **figures["binary"], "unit": config["domain"].get("unit"), "released": released,
            "places": summary["binary"]["places"], "repaired": 3}


if __name__ == "__main__":
    add_places(sys.argv[1])
