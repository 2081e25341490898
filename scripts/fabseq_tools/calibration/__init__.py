# SPDX-License-Identifier: MIT
"""The strain of a material from measured parts."""
