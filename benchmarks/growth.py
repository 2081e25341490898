#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How seconds and memory of an iteration grow with the layers and with the unknowns, with fitted exponents:

    benchmarks/growth.py benchmarks/v_shape.json [--layers 25 50 100 200] [--sizes 65000 260000 1000000]
                         [--ranks 1 2] [--csv growth.csv] [--plot growth.png] [-- OPTIONS]

One series has all --layers in the first box of --sizes (elements), the other all boxes with the first number
of layers. Seconds are medians over the iterations after the warm-up; memory is the peak of all ranks, with
set-up and baselines. A fit is a line through the logarithms of a series; in proportion is an exponent of 1.
"""
import os
import tempfile

import program_run
from layers import fitting_targets
from size import in_box, refined

import numpy as np

SERIES = {"layers": "layer_count", "unknowns": "unknowns"}  # and by which figure it grows
FIGURES = {"total": "seconds per iteration", "gigabytes": "GB, all ranks"}


def measure(options, directory, ranks, layers, box, targets):
    arguments = [*in_box(box), "-layers", layers, *targets(layers)]
    size = program_run.problem_size(options, directory, arguments)
    return {"ranks": ranks, **size, "box": "x".join(map(str, box)),
            **program_run.median_iteration(options, ranks, directory, arguments)}


def run_all(options, directory):
    """Records by series and ranks, in order of growth; the smallest run belongs to both series."""
    config = program_run.resolved_config(options, os.path.join(directory, "settings"))
    targets = fitting_targets(config, program_run.problem_size(options, directory)["layer_count"])
    boxes = [refined(config["domain"]["elements"], size) for size in options.sizes]

    def run(ranks, layers, box):
        record = measure(options, os.path.join(directory, "run"), ranks, layers, box, targets)
        print_line(record)
        return record

    records = {}
    for ranks in options.ranks:
        records["layers", ranks] = [run(ranks, layers, boxes[0]) for layers in options.layers]
        more = [run(ranks, options.layers[0], box) for box in boxes[1:]]
        records["unknowns", ranks] = [records["layers", ranks][0], *more]
    return records


def print_line(record):
    print(f"{record['ranks']:6d}{record['layer_count']:8d}{record['unknowns']:10d}{record['gigabytes']:8.2f}"
          + program_run.cells(record, program_run.PHASES, "10.3f"), flush=True)


def exponent(records, by, of):
    """Of the growth of a figure of two runs or more; None of one."""
    if len(records) < 2:
        return None
    return float(np.polyfit(np.log([each[by] for each in records]), np.log([each[of] for each in records]), 1)[0])


def fits_of(records):
    return [{"series": series, "ranks": ranks, **{of: exponent(runs, SERIES[series], of) for of in FIGURES}}
            for (series, ranks), runs in records.items()]


def plot(path, title, records):
    with program_run.figure(path, title, 2, figsize=(11, 4.5)) as axes:
        for panel, (of, label) in zip(axes, FIGURES.items()):
            for (series, ranks), runs in records.items():
                work = [each["layer_count"] * each["unknowns"] for each in runs]
                power = exponent(runs, SERIES[series], of)
                name = f"{series}, {ranks} rank{'s' * (ranks > 1)}"
                if power is not None:
                    name += f": exponent {power:.2f}"
                style = "-o" if series == "layers" else "--s"
                panel.loglog(work, [each[of] for each in runs], style, label=name, markersize=4)
            panel.set(xlabel="layers times unknowns", ylabel=label)


def parse_arguments():
    parser = program_run.common_parser(__doc__)
    parser.set_defaults(repetitions=1)
    parser.add_argument("--layers", type=int, nargs="+", default=[25, 50, 100, 200], metavar="N",
                        help="default: %(default)s")
    parser.add_argument("--sizes", type=int, nargs="+", default=[65000, 260000, 1000000], metavar="E",
                        help="elements of the boxes (default: %(default)s)")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2], metavar="P", help="default: %(default)s")
    return program_run.parse_iterations(parser, "", "run", iterations=3)


def main():
    options = parse_arguments()
    machine = program_run.machine_before()
    print(f"{options.title}, {options.repetitions} repetitions")
    print(f"{'ranks':>6s}{'layers':>8s}{'unknowns':>10s}{'GB':>8s}" + program_run.heads(program_run.PHASES, 10))
    with tempfile.TemporaryDirectory() as directory:
        records = run_all(options, directory)
    machine, fits = program_run.machine_after(machine), fits_of(records)
    print(program_run.machine_text(machine))
    for fit in fits:
        print(f"{fit['series']}, {fit['ranks']} rank(s): exponents "
              + ", ".join(f"{of} {fit[of]:.2f}" for of in FIGURES if fit[of] is not None))
    rows = [{"series": series, **each} for (series, _), runs in records.items() for each in runs]
    program_run.write_results(options, {"machine": machine, "fits": fits, "runs": rows}, rows,
                              lambda path: plot(path, options.title, records))


if __name__ == "__main__":
    program_run.run_script(main)
