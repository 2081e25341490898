# SPDX-License-Identifier: MIT
"""Part, heat and plasticity as decks for CalculiX: what with_heat.py holds predictions against."""
