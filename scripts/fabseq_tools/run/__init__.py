# SPDX-License-Identifier: MIT
"""What a run leaves, how it is started, and figures in words; knows no geometry."""
