#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Time and memory over the number of elements, up to the largest box that fits:

    benchmarks/size.py benchmarks/v_shape.json --ranks 2 --memory 20 --csv size.csv --plot size.png [--
    OPTIONS]

The config's box is refined in all directions alike, each time to twice as many elements; parts read from
voxels cannot be. The last size is as large as --memory (GB) allows if memory grows in proportion to the
elements. Each run is an optimization of a few iterations; memory is the peak of all ranks together, as the
system reports it, set-up and planar baseline included; seconds are medians over the iterations after the
warm-up, of all repetitions.
"""
import math
import os
import tempfile

import program_run
from program_run import PHASES, RunError

# Of --memory: a margin for what does not grow in proportion.
USABLE = 0.95
# A larger last size must be worth it.
LEAST_GROWTH = 1.2


def refined(elements, total):
    """Element counts in the same proportions, even ones, of about `total` elements."""
    factor = (total / math.prod(elements))**(1.0 / len(elements))
    return [max(2, 2 * round(count * factor / 2)) for count in elements]


def in_box(elements):
    """Options for a box of so many elements."""
    return ["-set", "domain.elements=[" + ",".join(map(str, elements)) + "]"]


def measure(options, elements, directory):
    arguments = [*in_box(elements), *(["-layers", options.layers] if options.layers else [])]
    size = program_run.problem_size(options, directory, arguments)
    record = program_run.median_iteration(options, options.ranks, directory,
                                          [*arguments, "-layer_groups", options.groups])
    return {**size, "box": "x".join(map(str, elements)), "cg_iterations": record.pop("cg") / 2 / size["layer_count"], **record}


def next_size(last, memory):
    """Elements of the next box: twice as many, or as many as fit; None if there is no more room."""
    most = USABLE * memory / (last["gigabytes"] / last["elements"])
    if most < LEAST_GROWTH * last["elements"]:
        return None
    return min(2 * last["elements"], int(most))


def run_all(options, directory):
    """Records of all sizes, smallest first."""
    elements = program_run.resolved_config(options, os.path.join(directory, "settings"))["domain"]["elements"]
    records, total = [], options.smallest
    while total and (options.largest is None or total <= options.largest):
        record = measure(options, refined(elements, total), os.path.join(directory, "optimize"))
        print_line(record)
        if record["gigabytes"] > options.memory:
            print(f"more than {options.memory:g} GB: not what was expected of it")
            break
        records.append(record)
        total = next_size(record, options.memory)
    return records


def print_line(record):
    record = {**record, "each": 1e6 * record["gigabytes"] / record["part_elements"],
              "work": 1e6 * record["total"] / record["unknowns"] / record["layer_count"]}
    print(f"{record['box']:>14s}{record['elements']:11d}{record['part_elements']:10d}{record['gigabytes']:8.2f}"
          f"{record['each']:12.2f}{record['cg_iterations']:8.1f}"
          + program_run.cells(record, [*PHASES, "work"], "10.3f"), flush=True)


def plot(path, title, records):
    elements = [record["elements"] for record in records]
    with program_run.figure(path, title, 2, figsize=(11, 4.5)) as (left, right):
        program_run.draw_phases(left, elements, records)
        right.loglog(elements, [record["gigabytes"] for record in records], "k-o", label="peak, all ranks", markersize=4)
        for axes, key, label in ((left, "total", "seconds per iteration"), (right, "gigabytes", "GB")):
            first = records[0][key]
            axes.loglog(elements, [first * count / elements[0] for count in elements], "k:", label="in proportion")
            axes.set(xlabel="elements of the box", ylabel=label)


def parse_arguments():
    parser = program_run.common_parser(__doc__)
    parser.set_defaults(repetitions=1)
    parser.add_argument("--ranks", type=int, default=2, metavar="P", help="default: %(default)s")
    parser.add_argument("--groups", type=int, default=1, metavar="G",
                        help="layer groups; one needs least memory (default: %(default)s)")
    parser.add_argument("--layers", type=int, metavar="N", help="default: the config's; thickness targets stay")
    parser.add_argument("--memory", type=float, default=20.0, metavar="GB", help="of all ranks (default: %(default)s)")
    parser.add_argument("--smallest", type=int, default=32000, metavar="E",
                        help="elements of the first box (default: %(default)s)")
    parser.add_argument("--largest", type=int, metavar="E", help="end there, whatever the memory")
    return program_run.parse_iterations(parser, "", "size", iterations=3)


def main():
    options = parse_arguments()
    title = f"{options.title}, {options.groups} x {options.ranks // options.groups} ranks"
    machine = program_run.machine_before()
    print(f"{title}, up to {options.memory:g} GB, {options.repetitions} repetitions")
    print(f"{'box':>14s}{'elements':>11s}{'part':>10s}{'GB':>8s}{'kB/part el.':>12s}{'CG its':>8s}"
          + program_run.heads([*PHASES, "us/unk,lay"], 10))
    with tempfile.TemporaryDirectory() as directory:
        records = run_all(options, directory)
    machine = program_run.machine_after(machine)
    print(program_run.machine_text(machine))
    if not records:
        raise RunError(f"not even {options.smallest} elements fit into {options.memory:g} GB")
    record = {"ranks": options.ranks, "groups": options.groups, "memory": options.memory, "machine": machine, "runs": records}
    program_run.write_results(options, record, records, lambda path: plot(path, title, records))


if __name__ == "__main__":
    program_run.run_script(main)
