#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# PCL 1.13.0 (Debian 12: pcl-tools 1.13.0+dfsg-3), a PLY file whose x, y, z are double.
#
# Guess:     double coordinates are turned to the library's float when they are read, as by most readers
#            of PLY, or refused.
# Behaviour: pcl_ply2pcd keeps them as double, and the other tools then find no x, y, z that they know.
#            Some say so ("Failed to find match for field"), all go on, with zeros or without points, and
#            end with status 0.
# Seen:      100 points of a square of 0.9 mm. As float: pcl_voxel_grid keeps 25 points, and
#            pcl_transform_point_cloud moves by 100 mm to x = 101 to 101.9. As double: 0 points, and all
#            100 points at (100, 0, 0).
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian pcl-tools=1.13.0+dfsg-3 libopenni0=1.5.4.0+dfsg-6+b1

tools() {
  local type=$1
  {
    printf '%s\n' ply "format ascii 1.0" "element vertex 100"
    printf '%s\n' "property $type x" "property $type y" "property $type z" end_header
    awk 'BEGIN {for (i = 0; i < 10; i++) for (j = 0; j < 10; j++) print 1 + i / 10, 2 + j / 10, 3}'
  } > points.ply
  {
    pcl_ply2pcd -format 0 points.ply points.pcd &&
      pcl_voxel_grid points.pcd thinned.pcd -leaf 0.2,0.2,0.2 &&
      pcl_transform_point_cloud points.pcd moved.pcd -trans 100,0,0 &&
      pcl_convert_pcd_ascii_binary moved.pcd text.pcd 0 &&
      pcl_convert_pcd_ascii_binary thinned.pcd thin.pcd 0
  } > tools.log 2>&1 || echo "status $?"
  sed '1,/^DATA/d' text.pcd | awk -v kept="$(sed '1,/^DATA/d' thin.pcd | wc -l)" 'NR == 1 {low = high = $1}
    {low = $1 < low ? $1 : low; high = $1 > high ? $1 : high; y = $2 > y ? $2 : y}
    END {printf "%d points kept; %d moved, x %g to %g, y up to %g\n", kept, NR, low, high, y}'
}
expect "float" "25 points kept; 100 moved, x 101 to 101.9, y up to 2.9" "$(tools float)"
expect "double" "0 points kept; 100 moved, x 100 to 100, y up to 0" "$(tools double)"
grep -m 1 "Failed to find" tools.log || true
finish
