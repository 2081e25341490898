# SPDX-License-Identifier: MIT
"""Tables of with_heat.py and one_factor.py, as they stand in benchmarks/evidence/results/with_heat.md."""

from heat_and_plasticity.compared import BRICKS, FLOW, FLOWS, LINEAR

FIRST, OTHER = BRICKS


def print_tables(cases):
    """`cases`: {name: figures of with_heat.py}."""
    print_rows(("part", "layers", "highest interpass, °C: CalculiX", "fabseq", f"rms, mm: {FIRST}", OTHER, FLOW,
                f"error to {FIRST}", f"to {OTHER}", f"{OTHER} from {FIRST}"), cases, flow_cells)
    print_rows(("gain over planar", *BRICKS, *FLOWS, *LINEAR), cases, gain_cells)
    print_rows((f"error to {FIRST} ({OTHER}), %", *FLOWS), cases, other_flow_cells)
    print_rows((f"error to {FIRST}, and factor of the planar case", *LINEAR, *(f"factor: {model}" for model in LINEAR)),
               cases, linear_cells)


def print_factor_tables(found):
    """`found`: figures of one_factor.py."""
    kinds = list(next(iter(found["factors"].values())))
    columns = next(iter(found["errors"].values()))["planar"]
    print_rows(("fitted to", *(f"factor on {kind}" for kind in kinds), f"error to {FIRST}: none", *kinds),
               {case: {"planar": of} for case, of in found["factors"].items()}, factor_cells)
    print_rows((f"error to {FIRST}", *columns), found["errors"], lambda row, _planar: [percent(error) for error in row.values()])


def print_rows(head, cases, cells_of):
    print("\n| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    for case, found in cases.items():
        for sequence, row in found.items():
            cells = cells_of(row, found["planar"])
            if cells:
                print("| " + " | ".join([f"{case.replace('_', ' ')}, {sequence}", *cells]) + " |")


def flow_cells(row, _planar):
    return [str(row["layers"]), *(f"{max(row['interpass'][name]):.0f}" for name in ("ccx", "fabseq")),
            *(f"{row[kind]['rms']:.3f}" for kind in BRICKS), f"{row[FLOW][FIRST]['rms']:.3f}",
            *(percent(row[FLOW][kind]["error"]) for kind in BRICKS), percent(row[OTHER]["difference"])]


def gain_cells(row, planar):
    """Gains over planar; a factor does not change a model's."""
    if row is planar:
        return []
    return [*(f"{planar[kind]['rms'] / row[kind]['rms']:.2f}" for kind in BRICKS),
            *(f"{planar[model][FIRST]['rms'] / row[model][FIRST]['rms']:.2f}" for model in (*FLOWS, *LINEAR))]


def other_flow_cells(row, _planar):
    return [f"{100 * row[model][FIRST]['error']:.0f} ({100 * row[model][OTHER]['error']:.0f})" for model in FLOWS]


def linear_cells(row, planar):
    factors = [f"{planar[model][FIRST]['scale']:.3g}" if row is planar else "" for model in LINEAR]
    return [*(percent(row[model][FIRST]["error"]) for model in LINEAR), *factors]


def factor_cells(records, _planar):
    return [*(f"{record['factor']:.3g}" for record in records.values()), percent(next(iter(records.values()))["left_before"]),
            *(percent(record["left_of_measurement"]) for record in records.values())]


def percent(value):
    return f"{100 * value:.0f} %"
