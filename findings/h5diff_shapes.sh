#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# HDF5 1.10.8 (Debian 12: hdf5-tools 1.10.8+repack1-1), h5diff.
#
# Guess:     exit status 1 for files whose dataset of one name has another shape, or holds integers
#            instead of reals; 0 is for files that hold the same.
# Behaviour: a line says that some objects are not comparable, and the status is 0, as for equal files: a
#            test that asks for the status alone passes. Other values are told: 1.
# Seen:      a field of 5 values against 6 values, 5 x 1 values, 5 integers: status 0 each; against 5
#            other values: 1.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian hdf5-tools=1.10.8+repack1-1

# field NAME CLASS RANK SIZES: text to HDF5 by the package's own h5import.
field() {
  local name=$1 class=$2 rank=$3 sizes=$4
  printf '%s\n' "PATH u" "INPUT-CLASS $class" "RANK $rank" "DIMENSION-SIZES $sizes" "OUTPUT-CLASS ${class/TEXT/}" \
    > "$name.conf"
  h5import "$name.txt" -c "$name.conf" -o "$name.h5" > "$name.log"
}
printf '%s\n' 0.0 1.0 2.0 3.0 4.0 > a.txt
printf '%s\n' 0.0 1.0 2.0 3.0 4.0 > same.txt
printf '%s\n' 0.0 1.0 2.0 3.0 4.5 > values.txt
printf '%s\n' 0.0 1.0 2.0 3.0 4.0 5.0 > longer.txt
printf '%s\n' 0.0 1.0 2.0 3.0 4.0 > column.txt
printf '%s\n' 0 1 2 3 4 > integers.txt
for name in a same values; do field $name TEXTFP 1 5; done
field longer TEXTFP 1 6
field column TEXTFP 2 "5 1"
field integers TEXTIN 1 5
h5diff --version
compare() {
  local status=0
  h5diff a.h5 "$1.h5" > diff.txt 2>&1 || status=$?
  echo "status $status$(grep -c 'not comparable' diff.txt | sed 's/^0$//; s/^[1-9].*/, not comparable/' || true)"
}
expect "the same" "status 0" "$(compare same)"
expect "other values" "status 1" "$(compare values)"
expect "6 values for 5" "status 0, not comparable" "$(compare longer)"
expect "5 x 1 values for 5" "status 0, not comparable" "$(compare column)"
expect "integers for reals" "status 0, not comparable" "$(compare integers)"
finish
