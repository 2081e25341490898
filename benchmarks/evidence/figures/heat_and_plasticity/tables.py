# SPDX-License-Identifier: MIT
"""Tables of with_heat.py, as in benchmarks/evidence/results/with_heat.md."""

from heat_and_plasticity.compared import BRICKS, FLOW, FLOWS, LINEAR

MODELS = (*FLOWS, *LINEAR)


def print_tables(cases):
    """`cases`: {name: figures of with_heat.py}."""
    print_rows(("part", "layers", "highest interpass, °C: CalculiX", "fabseq", *(f"rms, mm: {kind}" for kind in BRICKS), FLOW,
                *(f"error to {kind}" for kind in BRICKS), f"{BRICKS[1]} from {BRICKS[0]}"), cases, flow_cells)
    print_rows(("gain over planar", *BRICKS, *MODELS), cases, gain_cells)
    print_rows(("part", *(f"error to {kind}: {model}" for kind in BRICKS for model in MODELS)), cases, error_cells)
    print_rows(("part", *(f"factor for {kind}: {model}" for kind in BRICKS for model in LINEAR)), cases, scale_cells)


def print_rows(head, cases, cells_of):
    print("\n| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    for case, found in cases.items():
        for sequence, row in found.items():
            cells = cells_of(row, found["planar"], sequence)
            if cells:
                print("| " + " | ".join([f"{case}, {sequence}", *cells]) + " |")


def flow_cells(row, _planar, _sequence):
    return [str(row["layers"]), *(f"{max(row['interpass'][name]):.0f}" for name in ("ccx", "fabseq")),
            *(f"{row[kind]['rms']:.3f}" for kind in BRICKS), f"{row[FLOW][BRICKS[0]]['rms']:.3f}",
            *(percent(row[FLOW][kind]["error"]) for kind in BRICKS), percent(row[BRICKS[1]]["difference"])]


def gain_cells(row, planar, sequence):
    """Gains over planar; a factor does not change a model's."""
    if sequence == "planar":
        return []
    return [*(f"{planar[kind]['rms'] / row[kind]['rms']:.2f}" for kind in BRICKS),
            *(f"{planar[model][BRICKS[0]]['rms'] / row[model][BRICKS[0]]['rms']:.2f}" for model in MODELS)]


def error_cells(row, _planar, _sequence):
    return [percent(row[model][kind]["error"]) for kind in BRICKS for model in MODELS]


def scale_cells(row, _planar, sequence):
    return [f"{row[model][kind]['scale']:.3g}" for kind in BRICKS for model in LINEAR] if sequence == "planar" else []


def percent(value):
    return f"{100 * value:.0f} %"
