#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# PrusaSlicer 2.5.0 (Debian 12: prusa-slicer 2.5.0+dfsg-4), reading 3MF files of the core specification.
#
# Guess:     an object that no item of the build names is left out, as the specification has it. An object
#            of type "support", put beside the part that it carries as a component, is left out or loaded
#            as a support.
# Behaviour: either makes the whole file unreadable. Only objects of type "support" or "other" that
#            nothing names may stand in a file beside those that are built.
# Seen:      a cube beside a second one that is not built: "Unable to find object"; a cube and its support
#            as components: "Found component with invalid object id"; no volume is printed for the right
#            cube. The same support, not named: 1 mm³.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian prusa-slicer=2.5.0+dfsg-4

debian_python - <<'EOF'
from solids import mesh_3mf, write_3mf


def cube(number, size, kind="model"):
    return f'<object id="{number}" type="{kind}">{mesh_3mf(size)}</object>'


item, second = '<item objectid="1"/>', '<item objectid="2" transform="1 0 0 0 1 0 0 0 1 10 0 0"/>'
write_3mf("built.3mf", cube(1, 1) + cube(2, 2), item + second)
write_3mf("not_built.3mf", cube(1, 1) + cube(2, 2), item)
write_3mf("support.3mf", cube(1, 1) + cube(2, 2, "support") + '<object id="3" type="model"><components>'
          '<component objectid="1"/><component objectid="2"/></components></object>', '<item objectid="3"/>')
write_3mf("support_not_built.3mf", cube(1, 1) + cube(2, 2, "support"), item)
EOF
read_by_slicer() {
  prusa-slicer --info "$1.3mf" > log.txt 2>&1 || true
  sed -n 's/^volume = \([0-9]*\)\..*/\1 mm3/p; s/.*\[error\] *\(.*[Oo]bject.*\)/\1/p' log.txt | paste -sd,
}
prusa-slicer --help > help.txt 2>&1 || true
grep -m 1 '^PrusaSlicer' help.txt
expect "both built" "1 mm3,8 mm3" "$(read_by_slicer built)"
expect "the second not built" "Unable to find object" "$(read_by_slicer not_built)"
expect "a support as a component" "Found component with invalid object id" "$(read_by_slicer support)"
expect "a support that is not named" "1 mm3" "$(read_by_slicer support_not_built)"
finish
