# SPDX-License-Identifier: MIT
"""python3 -m fabseq_tools: the same as fabseq-tools."""

import sys

from fabseq_tools.entry import main
from fabseq_tools.run.places import ENTRY

sys.argv[0] = ENTRY  # what starts again, with another Python or a display, starts that
main()
