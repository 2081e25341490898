# SPDX-License-Identifier: MIT
"""The order of the lines of a layer: few starts, short travels."""

import itertools

import numpy as np

SWEEPS, STRETCH = 8, 30  # of the search for shorter travels; lines that it turns around at once
MOST_STARTS = 6  # outlines that are tried as the first one


def ordered(lines, position, longest):
    """Lines in an order with few gaps beyond `longest` and short ones, from a position on (None: any); lines
    may be turned, and closed ones begin anywhere. Outlines come before the hatch."""
    outlines, hatch = ([line for line in lines if (line.kind == "hatch") == wanted] for wanted in (False, True))
    starts = [*outlines[:MOST_STARTS], None] if outlines else [None]
    orders = []
    for start in starts:
        first = greedy(outlines, position, start)
        orders.append(first + greedy(hatch, first[-1].points[-1] if first else position))
        first = improved(first, position)
        orders.append(first + improved(greedy(hatch, first[-1].points[-1] if first else position),
                                       first[-1].points[-1] if first else position))
    return min(orders, key=lambda order: cost(order, position, longest))


def cost(order, position, longest):
    gaps = [gap(line.points[-1], other.points[0]) for line, other in itertools.pairwise(order)]
    return sum(way > longest for way in gaps), sum(gaps) + gap(position, order[0].points[0])


def greedy(lines, position, start=None):
    """Always goes to the nearest line, first to `start` where it is given."""
    left, result = list(lines), []
    if left and position is None:
        position = left[0].points[0]
    while left:
        found = [entry(line, position) for line in left]
        best = int(np.argmin([line is not start and distance for line, (distance, _) in zip(left, found)]))
        line = entered(left.pop(best), found[best][1])
        result.append(line)
        position = line.points[-1]
    return result


def entry(line, position):
    """Distance of a line's nearest entry, and the number of its point."""
    distances = np.linalg.norm((line.points if line.closed else line.points[[0, -1]]) - position, axis=1)
    best = int(np.argmin(distances))
    return distances[best], best if line.closed or best == 0 else len(line.points) - 1


def entered(line, number):
    """The line from a point on: turned, or a closed one that begins there."""
    if line.closed:
        points = np.concatenate([line.points[number:-1], line.points[:number + 1]])
    else:
        points = line.points if number == 0 else line.points[::-1]
    return type(line)(points, line.kind, line.closed, line.row)


def improved(lines, position):
    """Turns around stretches of the order while that makes travels shorter (2-opt)."""
    lines = list(lines)
    for _ in range(SWEEPS):
        shorter = False
        for first in range(len(lines)):
            for last in range(first, min(first + STRETCH, len(lines))):
                before = lines[first - 1].points[-1] if first else position
                after = lines[last + 1].points[0] if last + 1 < len(lines) else None
                old = gap(before, lines[first].points[0]) + gap(lines[last].points[-1], after)
                new = gap(before, lines[last].points[-1]) + gap(lines[first].points[0], after)
                if new < old * (1.0 - 1e-9):
                    lines[first:last + 1] = [entered(line, len(line.points) - 1) if not line.closed else line
                                             for line in lines[first:last + 1][::-1]]
                    shorter = True
        if not shorter:
            break
    return lines


def gap(a, b):
    return 0.0 if a is None or b is None else float(np.linalg.norm(b - a))


def passes(lines, longest, on_surface):
    """Lines that are deposited without a stop, as lists: those whose gap is no longer than `longest` and, by
    `on_surface`, on the layer."""
    result = []
    for line in lines:
        if result and gap(result[-1][-1].points[-1], line.points[0]) <= longest and on_surface(
                result[-1][-1].points[-1], line.points[0]):
            result[-1].append(line)
        else:
            result.append([line])
    return result
