#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""True error, residual and preconditioned residual of lane solves against iteration (docs/formulation.md
4.1), for the lane of each case that takes longest, at half resolution (40 x 20 x 40 elements):

    benchmarks/convergence.py build/release/benchmarks/hard_cases convergence.png [CASE...]
"""
import csv
import sys

import program_run

import matplotlib.pyplot as plt

CASES = ["normal", "quiet", "wavy_sharp", "column_2", "sheets", "walls"]
ITERATIONS = 40
CURVES = {"error": ("true error of u", "black"), "preconditioned_residual": ("preconditioned residual", "tab:blue"),
          "residual": ("residual |f - Ku| / |f|", "tab:red")}


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, picture, *cases = sys.argv[1:]
    cases = cases or CASES
    figure, all_axes = plt.subplots(2, -(-len(cases) // 2), figsize=(11, 7), sharey=True, squeeze=False)
    for case, axes in zip(cases, all_axes.flat):
        printed = program_run.run_command([program, "-scale", 0.5, "-history", ITERATIONS, "-only", case]).stdout
        lines = [{key: float(line[key]) for key in ("iteration", *CURVES)}
                 for line in csv.DictReader(printed.splitlines())]
        iterations = [line["iteration"] for line in lines]
        for key, (label, color) in CURVES.items():
            axes.semilogy(iterations, [line[key] for line in lines], color=color, label=label)
        axes.set_ylim(1e-9, 1e3)
        axes.set_title(case)
        axes.set_xlabel("iteration")
        axes.grid(alpha=0.3)
        # How far the error lies from what the solver judges by, where there are digits left.
        ratios = [line["error"] / line["preconditioned_residual"] for line in lines if line["error"] > 1e-9]
        print(f"{case}: error / preconditioned residual {min(ratios):.2g} to {max(ratios):.2g}, "
              f"in the end {ratios[-1]:.2g}")
    all_axes[0][0].legend()
    figure.tight_layout()
    figure.savefig(picture, dpi=100)


if __name__ == "__main__":
    program_run.run_script(main)
