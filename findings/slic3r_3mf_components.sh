#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Slic3r 1.3.0 (Debian 12: slic3r 1.3.0+dfsg1-5+b2), components of a 3MF file.
#
# Guess:     a component stands where its transform puts it, mirrored or not.
# Behaviour: the last digit of the transform's last number, the height, is lost. A mirrored component
#            comes tilted.
# Seen:      a 1 mm cube moved up by 57: z from 5 to 6; by 1234: 123 to 124; by 57.0: 57 to 58. Mirrored
#            in x (meant: x from -1 to 0, z from 1 to 2): x from -0.33 to 1.19, z from 0.80 to 2.29.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian slic3r=1.3.0+dfsg1-5+b2

debian_python - <<'EOF'
from solids import mesh_3mf, write_3mf
for name, transform in (("57", "1 0 0 0 1 0 0 0 1 0 0 57"), ("1234", "1 0 0 0 1 0 0 0 1 0 0 1234"),
                        ("57.0", "1 0 0 0 1 0 0 0 1 0 0 57.0"), ("mirrored", "-1 0 0 0 1 0 0 0 1 0 0 1.0")):
    write_3mf(name + ".3mf", f'<object id="1" type="model">{mesh_3mf()}</object><object id="2" type="model"><components>'
              f'<component objectid="1" transform="{transform}"/></components></object>', '<item objectid="2"/>')
EOF
perl=$folder/root/usr
export PERL5LIB=$perl/share/perl5:$perl/lib/x86_64-linux-gnu/perl5/5.36:$perl/lib/slic3r
PERL5LIB+=:$perl/share/perl/5.36:$perl/lib/x86_64-linux-gnu/perl/5.36
for name in 57 1234 57.0 mirrored; do slic3r --info "$name.3mf" > "$name.txt"; done
extent() { awk -v axis="_$2" '$1 == "min" axis {low = $3} $1 == "max" axis {printf "%.2f to %.2f", low, $3}' "$1.txt"; }
expect "moved up by 57" "z 5.00 to 6.00" "z $(extent 57 z)"
expect "moved up by 1234" "z 123.00 to 124.00" "z $(extent 1234 z)"
expect "moved up by 57.0" "z 57.00 to 58.00" "z $(extent 57.0 z)"
expect "mirrored in x, moved up by 1.0" "x -0.33 to 1.19, z 0.80 to 2.29" "x $(extent mirrored x), z $(extent mirrored z)"
finish
