# SPDX-License-Identifier: MIT
"""Saves what ParaView reads from an XDMF file:  scripts/use/virtual_display.py pvpython read_arrays.py
FILE.xdmf ARRAYS.npz

Arrays "Cell NAME" and "Node NAME" in ParaView's order (x fastest), and positions of its cells' centres and
points.
"""

import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scripts"))
from read_xdmf import read  # noqa: E402  (needs the path above)

if __name__ == "__main__":
    _, _, arrays, places = read(sys.argv[1])
    named = {f"{center} {name}": values for (center, name), values in arrays.items()}
    named.update({f"{center} position": values for center, values in places.items()})
    np.savez(sys.argv[2], **named)
