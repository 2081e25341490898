# SPDX-License-Identifier: MIT
"""The bars of `fabseq-tools compare-families`."""

import matplotlib.pyplot as plt
import numpy as np

from fabseq_tools.plot.drawing import INK, OPTIMIZED, SOFT_INK, plain_text, save, tidy
from fabseq_tools.run.verdict_words import CLASSES, COLOURS

BARS = (("skin", "as built", OPTIMIZED), ("skin_released", "after the release", INK))
FILLINGS = {CLASSES[0]: {}, CLASSES[1]: {"alpha": 0.5}}  # of bars, by class
HEIGHT, DOTS = 0.38, 130  # of a bar; per inch


def draw(rows, record, path):
    """PATH.png: a pair of bars for each kind of layers: full where it can be built, pale where it can but for
    some places, else hatched, with the verdict beside it."""
    with plain_text():
        figure, axis = plt.subplots(figsize=(11.0, 0.75 * len(rows) + 1.4), constrained_layout=True)
        tidy([axis])
        most = max(row[key] or 0.0 for row in rows if "reason" not in row for key, _, _ in BARS)
        for place, row in enumerate(rows):
            values = [row.get(key) or 0.0 for key, _, _ in BARS]
            for number, (value, (_, _, colour)) in enumerate(zip(values, BARS)):
                filling = {"facecolor": colour} | FILLINGS.get(row.get("class"), {"facecolor": "white", "hatch": "///"})
                axis.barh(place + HEIGHT * (number - 0.5), value, 0.92 * HEIGHT, edgecolor=colour, **filling)
            axis.text(max(values) + 0.01 * most, place, words_of(row), va="center", fontsize=8,
                      color=COLOURS.get(row.get("class"), SOFT_INK))
        axis.set_yticks(np.arange(len(rows)), [row["layers"] for row in rows])
        axis.invert_yaxis()
        axis.set_xlim(0.0, 1.6 * most)
        unit = f", {record['unit']}" if record["unit"] else ""
        axis.set_xlabel(f"deviation of the skin, root mean square{unit} (pale: buildable but for places; hatched: not buildable)")
        axis.legend(handles=[plt.Rectangle((0, 0), 1, 1, color=colour) for _, _, colour in BARS],
                    labels=[label for _, label, _ in BARS], frameon=False, fontsize=9, loc="lower right")
        save(figure, path + ".png", DOTS)
        plt.close(figure)


def words_of(row):
    if "reason" in row:
        return f"refused: {row['reason'][:90]}"
    reasons = [reason.partition(" (")[0] for reason in row["violated"]] if row["class"] == CLASSES[-1] else []
    return "\n".join([row["verdict"] or "not judged", *reasons])
