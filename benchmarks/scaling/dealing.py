# SPDX-License-Identifier: MIT
"""Deals layers, or rows of the heat problem, out to groups as deal_out_layers does (process/layer_dealing)."""

import functools
from dataclasses import dataclass

WIDEST = 8
WORTHWHILE = 0.02
MOST_HALVINGS = 8
MOST_CANDIDATES = 32


def relative_cost(lanes):
    return 1.0 if lanes > 4 else 0.62 if lanes > 2 else 0.57 if lanes > 1 else 0.55


@dataclass
class Block:
    first: int
    lanes: int
    work: float


def block_work(work):
    ordered = sorted(work, reverse=True)

    def left(lanes):
        return ordered[lanes] if lanes < len(ordered) else 0.0

    return (relative_cost(8) * left(4) + relative_cost(4) * (left(2) - left(4)) + relative_cost(2) * (left(1) - left(2))
            + relative_cost(1) * (left(0) - left(1)))


def deal(blocks, groups):
    """Blocks of each group, and the work of the longest one."""
    sums, result = [0.0] * groups, [[] for _ in range(groups)]
    blocks.sort(key=lambda block: (-block.work, block.first))
    for block in blocks:
        least = sums.index(min(sums))
        result[least].append(block)
        sums[least] += block.work
    return [sorted(of_group, key=lambda block: block.first) for of_group in result], max(sums)


@functools.lru_cache(maxsize=None)
def deal_equal_layers(layers, groups):
    """Of layers that all take the same."""
    return deal_out_layers([1.0] * layers, groups)


def deal_out_layers(work, groups):
    """(first layer, lanes) of each group's blocks."""
    def weighed(first, lanes):
        return Block(first, lanes, block_work(work[first:first + lanes]))

    blocks = [weighed(first, min(WIDEST, len(work) - first)) for first in range(0, len(work), WIDEST)]
    best, longest = deal(blocks, groups)
    total = sum(block.work for block in blocks)
    for _ in range(MOST_HALVINGS * groups if groups > 1 else 0):
        if longest * groups <= (1.0 + WORTHWHILE) * total:
            break
        tries = []
        for number, whole in enumerate(blocks[:MOST_CANDIDATES]):
            if whole.lanes == 1:
                continue
            half = 4 if whole.lanes > 4 else 2 if whole.lanes > 2 else 1
            tried = blocks[:number] + [weighed(whole.first, half)] + blocks[number + 1:] + \
                [weighed(whole.first + half, whole.lanes - half)]
            dealt, of_tried = deal(tried, groups)
            tries.append((of_tried, dealt, tried))
        if not tries:
            break
        of_best, dealt, blocks = min(tries, key=lambda entry: entry[0])
        if of_best < (1.0 - WORTHWHILE) * longest:
            best, longest = dealt, of_best
    return [[(block.first, block.lanes) for block in of_group] for of_group in best]
