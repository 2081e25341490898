# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# What the scripts of this folder share: each sources this file first. It prints the comment on top of the
# script, makes a temporary folder, works there, and removes it at the end. Exit status of a script: 0 if the
# behaviour is as seen, 1 if it changed, 2 if the packages cannot be had.
set -euo pipefail

findings=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
sed -n '/^source/q; 3,$s/^# \{0,1\}//p' "$0" # what it is about, what one would guess, what happens
cd "$folder"
changed=0

cannot_fetch() {
  tail -n 5 fetch.log >&2
  echo "cannot be fetched: $* (Debian 12 with the lists of 'apt-get update', and npm, are needed)" >&2
  exit 2
}

# fetch_debian NAME=VERSION...: unpacks the packages, and what they need beyond what is installed, in the
# folder; installs nothing.
fetch_debian() {
  local archive root=$folder/root
  mkdir -p archives/partial "$root"
  DEBIAN_FRONTEND=noninteractive apt-get install --download-only --reinstall --allow-downgrades --yes \
    --no-install-recommends -o Debug::NoLocking=1 -o "Dir::Cache::archives=$folder/archives" "$@" > fetch.log 2>&1 ||
    cannot_fetch "$@"
  for archive in archives/*.deb; do dpkg-deb --extract "$archive" "$root"; done
  export PATH=$root/usr/bin:$PATH
  local libraries=$root/usr/lib/x86_64-linux-gnu
  export LD_LIBRARY_PATH=$libraries:$root/usr/lib:$root/lib/x86_64-linux-gnu:$libraries/blas:$libraries/lapack
  LD_LIBRARY_PATH+=:$libraries/pulseaudio
  echo "packages: $*"
}

# fetch_debian_alone NAME=VERSION...: the same without what the packages need.
fetch_debian_alone() {
  local archive
  apt-get download -o APT::Sandbox::User= "$@" > fetch.log 2>&1 || cannot_fetch "$@"
  for archive in ./*.deb; do dpkg-deb --extract "$archive" root; done
  echo "packages: $*"
}

# fetch_npm NAME@VERSION...: puts the packages into the folder's node_modules; none of their scripts is run.
fetch_npm() {
  echo '{"private": true, "type": "module"}' > package.json
  npm install --ignore-scripts --no-audit --no-fund "$@" > fetch.log 2>&1 || cannot_fetch "$@"
  echo "packages: $*"
}

# Builds lib3mf_volume.cc with the unpacked lib3mf.
build_lib3mf_volume() {
  g++ -Iroot/usr/include/lib3mf "$findings/lib3mf_volume.cc" root/usr/lib/x86_64-linux-gnu/lib3MF.so.1 -o lib3mf_volume
}

# Debian's Python with the unpacked packages and solids.py.
debian_python() {
  PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$findings:$folder/root/usr/lib/python3/dist-packages /usr/bin/python3 "$@"
}

# What stands in an ASCII STL file: extent and signed volume.
stl_solid() { debian_python "$findings/solids.py" "$1"; }

# Eight nodes of a cube of 1 mm, as lines of an Abaqus or CalculiX deck, in the order of a brick.
cube_nodes() {
  cat <<'EOF'
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
EOF
}

# expect WHAT SEEN NOW: compares what was seen with what this run shows.
expect() {
  if [[ $2 == "$3" ]]; then
    echo "as seen: $1: $3"
  else
    echo "changed: $1: seen $2, now $3"
    changed=1
  fi
}

# Ends a script.
finish() { exit "$changed"; }
