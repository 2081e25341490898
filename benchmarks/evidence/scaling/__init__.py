# SPDX-License-Identifier: MIT
"""Measured on single cores of a virtual machine (AMD EPYC, triad 37.5 GB/s); nodes and network are assumed.

A model of what a design iteration computes and sends: checked by counting, and used to predict strong
scaling. In the root of the repository:

    export PYTHONPATH=scripts
    python3 -m benchmarks.evidence.scaling check --splits 1x4 2x4   counts of small runs and the model's
    python3 -m benchmarks.evidence.scaling predict                  time over cores, by the model
    python3 -m benchmarks.evidence.scaling parts --splits 1x1 4x16  what an iteration's time is made of

`check` runs the program with a library preloaded that counts MPI calls (message_count.cc), on two small
boxes, one all of material and one with a void, oversubscribed if need be: counts do not depend on that. It
compares the last design iteration with the model, given its numbers of CG iterations, and the whole run with
PETSc's -log_view.

`predict` times the counts on a stated machine (machine.py): --latency, --network and so on change it. For
each number of cores it takes the fastest split into groups x domain ranks on no more cores that fits the
memory. --plot draws it; --measured adds the figures of a CSV of strong_scaling.py, --before those of another
prediction's --csv: before.csv is that of the last version in which small levels were whole on every rank.

How box, layers and rows are dealt out is asked of the program (plan.cc, built with the tests and with
FABSEQ_BENCHMARKS).
"""
