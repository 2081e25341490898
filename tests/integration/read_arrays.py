# SPDX-License-Identifier: MIT
"""Saves what ParaView reads from an XDMF file:  fabseq-tools virtual-display pvpython read_arrays.py
FILE.xdmf ARRAYS.npz

Arrays "Cell NAME" and "Node NAME" in ParaView's order (x fastest), and positions of its cells' centres and
points.
"""

import sys

import numpy as np

from read_xdmf import read

if __name__ == "__main__":
    _, _, arrays, places = read(sys.argv[1])
    named = {f"{center} {name}": values for (center, name), values in arrays.items()}
    named.update({f"{center} position": values for center, values in places.items()})
    np.savez(sys.argv[2], **named)
