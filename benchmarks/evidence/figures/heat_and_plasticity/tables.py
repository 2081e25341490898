# SPDX-License-Identifier: MIT
"""Tables of with_heat.py and one_factor.py, as they stand in benchmarks/evidence/results/with_heat.md."""

from heat_and_plasticity.compared import BRICKS, FLOW, FLOWS, LINEAR, REFINED, best_gain, gain

FIRST, OTHER = BRICKS
FINEST = REFINED[FIRST]
# Whose differences tell what the size of the elements and the type of brick change.
PAIRS = ((FIRST, FINEST), (OTHER, FINEST), (OTHER, REFINED[OTHER]), (REFINED[OTHER], FINEST), (OTHER, FIRST))


def print_tables(cases):
    """`cases`: {name: figures of with_heat.py}."""
    print_rows(("part", "layers", "highest interpass, °C: CalculiX", "fabseq", f"rms, mm: {FIRST}", OTHER, FLOW,
                f"error to {FIRST}", f"to {OTHER}", f"{OTHER} from {FIRST}"), cases, flow_cells)
    print_rows(("rms, mm, and difference", *BRICKS, *REFINED.values(), *(f"{one} from {other}" for one, other in PAIRS)),
               cases, refined_cells)
    print_rows((f"error to {FINEST} ({REFINED[OTHER]}), %", *FLOWS), cases, refined_flow_cells)
    print_rows(("gain over planar", "CalculiX", *BRICKS, *FLOWS, *LINEAR), cases, gain_cells)
    print_rows(("gain over planar", "CalculiX", *(f"{model}, off by" for model in FLOWS)), cases, off_cells)
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
            *(percent(row[FLOW][kind]["error"]) for kind in BRICKS), percent(row[OTHER]["difference"][FIRST])]


def refined_cells(row, _planar):
    if FINEST not in row:
        return []
    return [*(f"{row[kind]['rms']:.3f}" if kind in row else "" for kind in (*BRICKS, *REFINED.values())),
            *(percent(row[one]["difference"][other]) if one in row and other in row else "" for one, other in PAIRS)]


def gain_cells(row, planar):
    """Gains over planar; a factor does not change a model's. That of CalculiX has an error bar."""
    if row is planar:
        return []
    return [bar_of(row, planar), *(f"{gain(row, planar, name):.2f}" for name in (*BRICKS, *FLOWS, *LINEAR))]


def off_cells(row, planar):
    """By how much gains with plastic flow are off CalculiX's, and whether that is within its error bar."""
    if row is planar:
        return []
    theirs, bar = best_gain(row, planar)
    cells = [bar_of(row, planar)]
    for model in FLOWS:
        ours = gain(row, planar, model)
        cells.append(f"{100 * (ours / theirs - 1):+.0f} %" + (", within the bar" if abs(ours - theirs) <= bar else ""))
    return cells


def bar_of(row, planar):
    return "{:.2f} ± {:.2f}".format(*best_gain(row, planar))


def other_flow_cells(row, _planar):
    return two_errors(row, FIRST, OTHER)


def refined_flow_cells(row, _planar):
    return two_errors(row, FINEST, REFINED[OTHER]) if FINEST in row else []


def two_errors(row, first, other):
    """Errors of the models with plastic flow to two types of brick, the second in brackets if it is there."""
    return [f"{100 * row[model][first]['error']:.0f}" + (f" ({100 * row[model][other]['error']:.0f})" if other in row else "")
            for model in FLOWS]


def linear_cells(row, planar):
    factors = [f"{planar[model][FIRST]['scale']:.3g}" if row is planar else "" for model in LINEAR]
    return [*(percent(row[model][FIRST]["error"]) for model in LINEAR), *factors]


def factor_cells(records, _planar):
    return [*(f"{record['factor']:.3g}" for record in records.values()), percent(next(iter(records.values()))["left_before"]),
            *(percent(record["left_of_measurement"]) for record in records.values())]


def percent(value):
    return f"{100 * value:.0f} %"
