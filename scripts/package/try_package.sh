#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tries a Debian package of fabseq on a bare Debian 12: installs it, optimizes the demo for two iterations on two ranks,
# draws an overview, removes the package, and compares the files before and after.
#
#   scripts/package/try_package.sh FABSEQ.deb COMMAND [WORD]...   COMMAND runs a program as root on the bare Debian
#   scripts/package/try_package.sh FABSEQ.deb --tree FOLDER       a tree that debootstrap has made (as root)
#
#   scripts/package/try_package.sh build/package/fabseq_*.deb podman run --rm -i debian:12-slim
#   debootstrap --variant=minbase bookworm bare && scripts/package/try_package.sh build/package/fabseq_*.deb --tree bare
#
# The package goes in through standard input, so COMMAND needs no folder of this machine. The packages that it depends on
# or recommends are fetched there, and stay.
set -euo pipefail
(($# > 1)) || { echo "usage: scripts/package/try_package.sh FABSEQ.deb {--tree FOLDER | COMMAND [WORD]...}" >&2; exit 2; }
package=$1
shift
[[ -r $package ]] || { echo "try_package.sh: $package: cannot be read" >&2; exit 2; }

# A tree gets /proc, /sys and /dev in a mount namespace of its own, which takes them along when it ends.
in_tree() {
  local proxies
  mapfile -t proxies < <(env | grep -iE '^(https?|no)_proxy=' || true)
  # shellcheck disable=SC2016  # the inner shell's variables
  unshare --mount bash -c 'mount -t proc proc "$0/proc" && mount --rbind /sys "$0/sys" && mount --rbind /dev "$0/dev" &&
    exec chroot "$0" "$@"' "$tree" \
    env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "${proxies[@]}" "$@"
}
if [[ $1 == --tree ]]; then
  tree=${2:?"--tree needs a folder"}
  [[ -x $tree/bin/bash ]] || { echo "try_package.sh: $tree: no tree of a Debian" >&2; exit 2; }
  set -- in_tree
fi

{
  cat <<'END'
set -eu
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
quietly() { "$@" >"$folder/log" 2>&1 </dev/null || { tail -n 20 "$folder/log"; exit 1; }; }
# All files but those of running programs, caches, and the package manager's own notes.
files() {
  find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /run -o -path /tmp -o -path /var/cache -o -path /var/log \
    -o -path /var/lib/dpkg -o -path /var/lib/apt \) -prune -o -print | sort
}
base64 -d >"$folder/fabseq.deb" <<'PACKAGE'
END
  base64 "$package"
  cat <<'END'
PACKAGE
chmod 755 "$folder"
echo "== what it depends on and recommends"
quietly apt-get update
quietly apt-get satisfy -y --no-install-recommends "$(dpkg-deb -f "$folder/fabseq.deb" Depends)" \
  "$(dpkg-deb -f "$folder/fabseq.deb" Recommends)"
files >"$folder/before"
echo "== install"
quietly dpkg -i "$folder/fabseq.deb"
fabseq -version
for name in fabseq fabseq-tools; do test -s "/usr/share/man/man1/$name.1.gz" || dpkg-query -S "/usr/share/man/man1/$name.1.gz"; done
test -s /usr/share/doc/fabseq/examples/demo.json || dpkg-query -S /usr/share/doc/fabseq/examples
echo "== demo"
cd "$folder"
export HOME=$folder XDG_CACHE_HOME=$folder MPLCONFIGDIR=$folder OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
/usr/share/fabseq/scripts/use/run.sh -np 2 -config /usr/share/fabseq/configs/demo.json -max_iterations 2 -output demo
test -s demo/summary.json
fabseq-tools overview demo --table
test -s demo/overview.png
echo "== remove"
cd /
quietly dpkg --purge fabseq
files >"$folder/after"
diff "$folder/before" "$folder/after" || { echo "files are left (>) or missing (<)"; exit 1; }
echo "== nothing is left"
END
} | "$@" bash -s
