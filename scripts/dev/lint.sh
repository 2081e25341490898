#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Checks that need no run: format, clang-tidy, include graph, comments, scripts, Doxygen, lists of keys, manual page. Needs the release build
# (scripts/setup.sh --ci). All checks run; the exit status is 1 if one of them found something.
#
#   scripts/dev/lint.sh [--tidy | --no-tidy] [FILE.cc...]     with files: clang-tidy looks at these only
#
#   --tidy     clang-tidy only, which takes most of the time
#   --no-tidy  all but clang-tidy
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source scripts/environment.sh

part=all
case ${1:-} in
  --tidy | --no-tidy) part=${1#--}; shift ;;
esac

failed=()
step() {
  local name=$1
  shift
  echo "== $name"
  "$@" || failed+=("$name")
}

sources() { find include src tests benchmarks findings docs/example \( -name '*.cc' -o -name '*.h' \) -print0 2>/dev/null || true; }
shell_scripts() { find scripts benchmarks findings .ci -type f \( -name '*.sh' -o -name '*.bash' -o -path '.ci/run' \) -print0; }
python_scripts() { find scripts tests benchmarks findings docs/example -type f \( -name '*.py' -o -name fabseq-tools \) -print0 2>/dev/null || true; }

format() { sources | xargs -0 clang-format --dry-run -Werror; }
bash_syntax() { shell_scripts | xargs -0 -n 1 bash -n; }
python_format() {
  python_scripts | xargs -0 autopep8 --diff --exit-code --max-line-length 130 --ignore E402,E741,W503,W505
}
doxygen_pages() {
  mkdir -p build
  doxygen docs/Doxyfile
}

if [[ $part != tidy ]]; then
  step "clang-format" format
  step "include graph" /usr/bin/python3 scripts/dev/check_include_graph.py
  step "comments and subjects of commits" /usr/bin/python3 scripts/dev/check_comments.py
  step "shell syntax" bash_syntax
  step "Python format" python_format
  step "flake8" flake8 scripts scripts/fabseq-tools tests benchmarks findings docs/example
  step "Doxygen" doxygen_pages
  step "lists of keys in docs/reference.md" /usr/bin/python3 scripts/dev/reference_table.py
  step "manual page" mandoc -Tlint docs/fabseq.1
fi
if [[ $part != no-tidy ]]; then
  step "clang-tidy" /usr/bin/python3 scripts/dev/check_tidy.py --jobs "$(compile_jobs)" "$@"
fi

if ((${#failed[@]})); then
  printf 'lint: failed: %s\n' "${failed[@]}"
  exit 1
fi
echo "lint: all checks passed"
