#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what is missing (Debian 12; as root or with sudo) and builds the program and the Python module. Its tests are only
# configured: scripts/test.sh builds those that it runs.
#
#   scripts/setup.sh [--ci] [--benchmarks] [--preset NAME | --package]
#
#   --ci           also install what scripts/dev/lint.sh and all tests need, and, if it can be had, Slurm, in which the tests run the batch scripts
#   --benchmarks   also install Google Benchmark and build three of benchmarks/, now and with this preset from now on
#   --preset NAME  release (default), debug, sanitizers or indices64, see CMakePresets.json
#   --package      build build/package/fabseq_*.deb, Debian's package of the program and its tools; installs no tools, builds no module
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh

packages=(g++ cmake ninja-build pkg-config petsc-dev libopenmpi-dev openmpi-bin libhdf5-openmpi-dev liblapack-dev nlohmann-json3-dev
  lib3mf-dev libzip-dev libexpat1-dev libhwloc-dev libgtest-dev libopenblas0-serial)
module_packages=(pybind11-dev python3-dev)
tool_packages=(python3-numpy python3-scipy python3-h5py python3-matplotlib python3-paraview xvfb)
ci_packages=(git clang-format clang-tidy doxygen flake8 python3-autopep8 mandoc chromium calculix-ccx locales
  dpkg-dev file python3-mpi4py)
slurm_packages=()
preset=release
package=no
cmake_options=(-D FABSEQ_UNITY=ON)
targets=(fabseq fabseq_python)
while (($#)); do
  case $1 in
    --ci) tool_packages+=("${ci_packages[@]}"); slurm_packages=(slurm-wlm munge) ;;
    --benchmarks) packages+=(libbenchmark-dev); cmake_options+=(-D FABSEQ_BENCHMARKS=ON); targets+=(kernels voxelize machine_checks) ;;
    --package) package=yes; preset=package; packages+=(dpkg-dev file); module_packages=() tool_packages=() ;;
    --preset) preset=${2:?"--preset needs a name"}; shift ;;
    *) echo "usage: scripts/setup.sh [--ci] [--benchmarks] [--preset NAME | --package]" >&2; exit 2 ;;
  esac
  shift
done

as_root() {
  if ((EUID == 0)); then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    echo "setup.sh: this needs root, and there is no sudo; run as root: $*" >&2
    return 1
  fi
}

# Installs those of the packages that are missing.
install_missing() {
  local missing=() package
  for package in "$@"; do
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  echo "setup.sh: installing ${missing[*]}"
  local log
  log=$(mktemp)
  as_root apt-get update >"$log" 2>&1 || { cat "$log" >&2; return 1; }
  # --no-remove: rather stop than throw out a package that conflicts, such as python3-vtk9 with
  # python3-paraview.
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends --no-remove \
    -o Dpkg::Use-Pty=0 "${missing[@]}" >"$log" 2>&1 || { tail -n 40 "$log" >&2; return 1; }
  rm -f "$log"
}

# Slurm wants users that can log in and more, which not every container gives it. Half installed, it would be
# in the way of others.
install_slurm() {
  ((${#slurm_packages[@]})) || return 0
  install_missing "${slurm_packages[@]}" && return 0
  echo "setup.sh: warning: Slurm cannot be installed here: the tests of the batch scripts will be skipped" >&2
  as_root env DEBIAN_FRONTEND=noninteractive apt-get purge -y "${slurm_packages[@]}" >/dev/null 2>&1 || true
}

# PETSc calls the BLAS that Debian's alternatives select; reference BLAS would make it several times slower.
select_blas() {
  local architecture library alternative selected wanted
  architecture=$(g++ -print-multiarch)
  for library in libblas.so.3 liblapack.so.3; do
    alternative=$library-$architecture
    selected=$(readlink -f "/etc/alternatives/$alternative" || true)
    if [[ $selected != *openblas* ]]; then
      wanted=$(update-alternatives --list "$alternative" | grep openblas-serial || true)
      if [[ -n $wanted ]] && as_root update-alternatives --quiet --set "$alternative" "$wanted"; then
        selected=$wanted
      else
        echo "setup.sh: warning: $library is $selected, not OpenBLAS: dense algebra will be slow" >&2
      fi
    fi
    echo "setup.sh: $library is $selected"
  done
}

if [[ $preset == indices64 ]]; then packages+=(libpetsc64-real-dev); fi

install_missing "${packages[@]}" "${module_packages[@]}"
select_blas
# What the program is not compiled with is fetched and unpacked while it is compiled.
tools_log=$(mktemp)
(install_missing "${tool_packages[@]}" && install_slurm) >"$tools_log" 2>&1 &
tools=$!
trap 'wait "$tools" 2>/dev/null || true' EXIT  # half installed packages would be in the way
cmake --preset "$preset" --log-level=WARNING "${cmake_options[@]}"
cmake --build --preset "$preset" --parallel "$(compile_jobs)" --target "${targets[@]}"
trap - EXIT
wait "$tools" || { cat "$tools_log" >&2; exit 1; }
cat "$tools_log"
rm -f "$tools_log"
[[ $package == no ]] || (cd build/package && cpack -G DEB)
