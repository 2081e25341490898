#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How figures are written for readers."""

import unittest

from fabseq_tools.run.words import number


class NumberTest(unittest.TestCase):
    def test_three_digits_or_a_whole_number_or_a_power_of_ten(self):
        for value, text in ((0, "0"), (0.127, "0.127"), (3.07e-3, "3.07·10⁻³"), (999.4, "999"), (999.6, "1,000"),
                            (1093.4, "1,093"), (-1093, "-1,093"), (9999.4, "9,999"), (9999.6, "1.00·10⁴"),
                            (16400, "1.64·10⁴")):
            self.assertEqual(number(value), text, value)


if __name__ == "__main__":
    unittest.main()
