# SPDX-License-Identifier: MIT
"""The first config of a part."""
