# SPDX-License-Identifier: MIT
"""Figures that stand on more than one page are those of results/figures.json, on every one of them."""

import copy
import unittest

import run_fabseq
from figure_list import faults, read_figures


class FiguresTest(unittest.TestCase):
    def test_pages_say_what_the_list_says(self):
        self.assertEqual(faults(read_figures()), [])

    def test_every_figure_stands_on_more_than_one_page(self):
        for figure in read_figures():
            self.assertGreater(len({page for page, _ in figure["pages"]}), 1, figure["name"])
            self.assertEqual(len({"run", "by"} & set(figure)), 1, figure["name"])

    def test_another_figure_is_found_on_each_page(self):
        for figure in read_figures():
            changed = copy.deepcopy(figure)
            changed["value"] += "1"
            self.assertEqual(len(faults([changed])), len(figure["pages"]), figure["name"])


if __name__ == "__main__":
    run_fabseq.main()
