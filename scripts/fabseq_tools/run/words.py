# SPDX-License-Identifier: MIT
"""Figures in words, as reports, pictures and tables show them."""


def duration(seconds):
    if seconds < 120:
        return f"{seconds:.0f} s" if seconds >= 1 else f"{seconds:.1g} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def factor(value):
    """As many digits as mean something: 1.3, 41, 1,060."""
    return f"{value:.1f}" if value < 9.95 else f"{value:,.0f}"


def alike(first, second):
    """Whether two lengths differ by less than what a sentence should make of them."""
    return 0.95 * second < first < 1.05 * second


def less(value):
    """How a length compares with one that is `value` times as long, which is named next."""
    if alike(value, 1.0):
        return "about as much as"
    return f"{factor(value)} times less than" if value > 1 else f"{factor(1 / value)} times more than"


def whole(words):
    """A sentence of words that begin it or not; none of none."""
    return f"{words[:1].upper()}{words[1:]}." if words else ""


def number(value):
    """Three digits, or four of a whole number, with a power of ten where needed: 0.127, 1,093, 3.07·10⁻³."""
    if 999.5 <= abs(value) < 9999.5:
        return f"{value:,.0f}"
    if value == 0 or 1e-2 <= abs(value) < 999.5:
        return f"{value:.3g}"
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{mantissa}·10" + str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def quantity(value, unit):
    """A number with its unit, where it has one."""
    return f"{number(value)} {unit}".rstrip()
