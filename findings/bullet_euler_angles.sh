#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Bullet 3.24 (Debian 12: libbullet-dev 3.24+dfsg-2), btMatrix3x3::getEulerZYX.
#
# Guess:     where an Euler angle is at its limit (a tool that points straight down or up), two of the
#            angles are not defined each by itself, and one of many triples is given; set back, it gives
#            the same frame.
# Behaviour: there the sign of the middle angle is lost: the triple belongs to a frame turned by 180
#            degrees. getEulerYPR of the same matrix is right, and both are right elsewhere.
# Seen:      yaw 30, roll 10 degrees, double precision. Pitch 90: getEulerZYX gives 0, -90, 90, off by 180
#            degrees when set back; pitch -90: 0, 90, 270, off by 180 as well. getEulerYPR: off by 0.
#            Pitch 89: both off by 0.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian_alone libbullet-dev=3.24+dfsg-2

cat > angles.cc <<'EOF'
#include <initializer_list>
#include <LinearMath/btMatrix3x3.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
int main() {
  const double degree = std::acos(-1.0) / 180;
  for (double pitch : {89.0, 90.0, -90.0}) {
    btMatrix3x3 frame;
    frame.setEulerYPR(30 * degree, pitch * degree, 10 * degree);
    for (bool zyx : {false, true}) {
      btScalar yaw, middle, roll;
      if (zyx) frame.getEulerZYX(yaw, middle, roll); else frame.getEulerYPR(yaw, middle, roll);
      btMatrix3x3 back;
      back.setEulerYPR(yaw, middle, roll);
      const btMatrix3x3 between = frame.transposeTimes(back);
      const double cosine = (between[0][0] + between[1][1] + between[2][2] - 1) / 2.0;
      const double off = std::acos(std::min(1.0, std::max(-1.0, cosine)));
      std::printf("%s at %g: %.0f, %.0f, %.0f, off by %.0f\n", zyx ? "ZYX" : "YPR", pitch, yaw / degree, middle / degree,
                  roll / degree, off / degree);
    }
  }
}
EOF
g++ -D BT_USE_DOUBLE_PRECISION -Iroot/usr/include/bullet angles.cc -o angles
./angles > seen.txt
angles() { sed -n "s/^$1: //p" seen.txt; }
expect "getEulerZYX, pitch 89" "30, 89, 10, off by 0" "$(angles "ZYX at 89")"
expect "getEulerZYX, pitch 90" "0, -90, 90, off by 180" "$(angles "ZYX at 90")"
expect "getEulerZYX, pitch -90" "0, 90, 270, off by 180" "$(angles "ZYX at -90")"
expect "getEulerYPR, pitch 90" "off by 0" "$(angles "YPR at 90" | sed 's/.*, //')"
expect "getEulerYPR, pitch -90" "off by 0" "$(angles "YPR at -90" | sed 's/.*, //')"
finish
