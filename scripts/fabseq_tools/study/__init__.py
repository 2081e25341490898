# SPDX-License-Identifier: MIT
"""Several runs of one part that are compared: trade-offs, and kinds of layers."""
