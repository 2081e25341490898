#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Arcs (G2, G3) in two readers of G-code: three.js 0.187.0 (npm: three@0.187.0), GCodeLoader; Printrun
# 2.0.0rc8 (Debian 12: printrun-common 2.0.0~rc8-2), gcoder.
#
# Guess:     three.js draws arcs as short lines, or says that it does not know them. Printrun's extent
#            holds the bulge of an arc, and its duration the arc's length.
# Behaviour: three.js leaves arcs out without a word, and their end as well: the next move begins where
#            the arc began. Printrun takes the end of an arc alone: the bulge is no part of the extent,
#            and the arc takes no time.
# Seen:      three.js: a half circle from (0, 0) to (20, 0), then a line to (20, 10): one line, from (0,
#            0) to (20, 10). Printrun: a way of 300 mm along x at 10 mm/s, then a half circle of radius
#            300 mm (942 mm, 94 s): y from 0 to 0, 30 s, as without the arc. With a line along its chord:
#            90 s.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_npm three@0.187.0
fetch_debian_alone printrun-common=2.0.0~rc8-2

cat > arc.mjs <<'EOF'
import { GCodeLoader } from 'three/examples/jsm/loaders/GCodeLoader.js';
console.warn = console.error = (text) => console.log(`warning: ${text}`);
const code = ['G21', 'G90', 'M82', 'G92 E0', 'G2 X20 Y0 I10 J0 E1 F600', 'G1 X20 Y10 E2', ''].join('\n');
new GCodeLoader().parse(code).traverse((object) => {
  const p = object.geometry?.attributes.position;
  const point = (i) => `(${p.getX(i)}, ${p.getY(i)})`;
  for (let i = 0; p && i + 1 < p.count; i += 2) console.log(`${point(i)} to ${point(i + 1)}`);
});
EOF
cat > arc.py <<'EOF'
import logging
import sys
logging.disable(logging.WARNING)
from printrun import gcoder
code = gcoder.GCode(["G21", "G90", "M82", "G92 E0", "G1 X300 Y0 Z0.2 F600", *sys.argv[1:]])
print("y %g to %g, %d s" % (code.ymin, code.ymax, code.duration.total_seconds()))
EOF
expect "three.js, a half circle, then a line" "(0, 0) to (20, 10)" "$(node arc.mjs)"
expect "Printrun, the way to the arc's start" "y 0 to 0, 30 s" "$(debian_python arc.py)"
expect "Printrun, with the half circle" "y 0 to 0, 30 s" "$(debian_python arc.py "G3 X-300 Y0 I-300 J0 E9")"
expect "Printrun, with its chord" "y 0 to 0, 90 s" "$(debian_python arc.py "G1 X-300 E9")"
finish
