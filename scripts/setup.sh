#!/usr/bin/env bash
# Installs what is missing from Debian 12 and builds build/release/fabseq:  bash scripts/setup.sh [--ci]
# --ci: also the tools that check the sources.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
packages=(g++ cmake ninja-build pkg-config git petsc-dev libopenmpi-dev openmpi-bin libhdf5-openmpi-dev nlohmann-json3-dev libgtest-dev
  libopenblas0-serial liblapack-dev python3-numpy python3-h5py python3-matplotlib python3-paraview xvfb xauth)
[ "${1:-}" = --ci ] && packages+=(clang-format clang-tidy)

missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null)" = "install ok installed" ] || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  echo "installing ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

# A compiler process takes up to about 1.5 GB.
memory_jobs=$(awk '/MemAvailable/ {jobs = int($2 / 1500000); print jobs < 1 ? 1 : jobs}' /proc/meminfo)
jobs=$(nproc)
[ "$jobs" -le "$memory_jobs" ] || jobs=$memory_jobs
cd "$root"
cmake --preset release >build-configure.log 2>&1 || { cat build-configure.log; exit 1; }
rm -f build-configure.log
cmake --build --preset release --parallel "$jobs"
