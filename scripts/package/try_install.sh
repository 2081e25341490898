#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tries what people install who do not build, with the files of the last commit, on bare Debian 12: builds the image of the
# Containerfile, runs the demo for two iterations in it, and tries the package that it is made of (try_package.sh).
#
#   scripts/package/try_install.sh [FOLDER]     as root, with debootstrap and buildah; FOLDER (default: a temporary one)
#                                               holds trees and images, 15 GB, and is removed
#
# In place of Debian's own image, which has to be pulled, it takes a tree of the same packages that debootstrap makes, with
# the package sources of this machine.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
for program in debootstrap buildah git; do
  command -v "$program" >/dev/null || { echo "try_install.sh: $program: no such program" >&2; exit 2; }
done
((EUID == 0)) || { echo "try_install.sh: this needs root" >&2; exit 2; }

folder=$(mktemp -d "${1:-${TMPDIR:-/tmp}}/try_install.XXXXXX")
trap 'rm -rf --one-file-system "$folder"' EXIT
stage() { printf '== after %d min: %s\n' $((SECONDS / 60)) "$1"; }
quietly() { "$@" >"$folder/log" 2>&1 </dev/null || { tail -n 30 "$folder/log"; return 1; }; }
# Layers as plain folders, and steps in a chroot: this works without a daemon, in most containers as well.
in_store() { buildah --root "$folder/store" --runroot "$folder/run" --storage-driver vfs "$@"; }

stage "a bare Debian 12"
tree=$folder/debian
sources=/etc/apt/sources.list.d/debian.sources
[[ -s $sources ]] || sources=/etc/apt/sources.list
mirror=$(awk '/^URIs:/ || /^deb / {print $2; exit}' "$sources")
quietly debootstrap --variant=minbase bookworm "$tree" "$mirror"
cp -r /etc/apt/apt.conf.d "$tree/etc/apt/"
rm -f "$tree/etc/apt/sources.list"
cp --parents "$sources" "$tree/"
if [[ -d /etc/ssl/certs ]]; then mkdir -p "$tree/etc/ssl" && cp -rL /etc/ssl/certs "$tree/etc/ssl/"; fi

stage "the Containerfile"
base=$(in_store from scratch)
quietly in_store copy "$base" "$tree" /
quietly in_store commit --rm "$base" docker.io/library/debian:12-slim
mkdir "$folder/source"
git archive HEAD | tar -x -C "$folder/source"
build() {
  quietly in_store build --isolation chroot --pull=never --layers "$@" -f "$folder/source/scripts/package/Containerfile" \
    "$folder/source"
}
build --target build -t fabseq-build
build -t fabseq

stage "the demo in its image"
container=$(in_store from --pull=never fabseq)
# shellcheck disable=SC2016  # the inner shell's variables
in_store run --isolation chroot "$container" -- bash -ec '
  export OMPI_MCA_rmaps_base_oversubscribe=1
  /usr/share/fabseq/scripts/use/run.sh -np 2 -config /usr/share/fabseq/configs/demo.json -max_iterations 2 -output demo
  fabseq-tools overview demo --table
  test -s demo/overview.png'
quietly in_store rm "$container"

stage "the package"
container=$(in_store from --pull=never fabseq-build)
cp "$(in_store mount "$container")"/fabseq/build/package/fabseq_*.deb "$folder/"
quietly in_store rm "$container"
scripts/package/try_package.sh "$folder"/fabseq_*.deb --tree "$tree"
stage "package and container: passed"
