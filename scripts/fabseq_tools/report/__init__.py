# SPDX-License-Identifier: MIT
"""Pages about runs for a browser."""
