# SPDX-License-Identifier: MIT
"""Pictures of runs and parts."""
