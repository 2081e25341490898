#!/usr/bin/env bash
# Checks that need no run: format, clang-tidy, include graph, scripts, reference table. Needs the release build
# (scripts/setup.sh --ci). All checks run; the exit status is 1 if one of them found something.
#
#   scripts/lint.sh [FILE.cc...]     with files: clang-tidy looks at these only
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh

failed=()
step() {
  local name=$1
  shift
  echo "== $name"
  "$@" || failed+=("$name")
}

sources() { find include src tests benchmarks \( -name '*.cc' -o -name '*.h' \) -print0 2>/dev/null || true; }
shell_scripts() { find scripts benchmarks .ci -type f \( -name '*.sh' -o -path '.ci/run' \) -print0; }
python_scripts() { find scripts tests benchmarks -name '*.py' -print0 2>/dev/null || true; }

format() { sources | xargs -0 clang-format --dry-run -Werror; }
bash_syntax() { shell_scripts | xargs -0 -n 1 bash -n; }
python_syntax() {
  python_scripts | xargs -0 /usr/bin/python3 -c 'import ast, sys; [ast.parse(open(n, encoding="utf-8").read(), n) for n in sys.argv[1:]]'
}

# The program is what is checked (the tests would double the time); warnings in system headers are counted by clang-tidy on stderr, to no one's use.
tidy() {
  local log status=0
  log=$(mktemp)
  if (($#)); then
    printf '%s\0' "$@"
  else
    /usr/bin/python3 -c 'import json; print(*sorted({c["file"] for c in json.load(open("build/release/compile_commands.json")) if "/src/" in c["file"]}), sep="\0", end="\0")'
  fi | xargs -0 -n 1 -P "$(compile_jobs)" clang-tidy -p build/release --quiet >"$log" 2>&1 || status=1
  grep -vE '^[0-9]+ warnings? (and [0-9]+ errors? )?generated\.$|^Suppressed |^Use -header-filter' "$log" || true
  rm -f "$log"
  return $status
}

step "clang-format" format
step "include graph" /usr/bin/python3 scripts/check_include_graph.py
step "shell syntax" bash_syntax
step "Python syntax" python_syntax
step "reference table of the user's guide" /usr/bin/python3 scripts/reference_table.py
step "clang-tidy" tidy "$@"

if ((${#failed[@]})); then
  printf 'lint: failed: %s\n' "${failed[@]}"
  exit 1
fi
echo "lint: all checks passed"
