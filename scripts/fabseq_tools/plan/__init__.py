# SPDX-License-Identifier: MIT
"""From a drawing and a machine to what is welded: the command `plan`, a module per step."""
