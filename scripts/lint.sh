#!/usr/bin/env bash
# Checks the sources: format, clang-tidy, module order, scripts, the reference table. Needs build/release (scripts/setup.sh --ci).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mapfile -t sources < <(git ls-files 'src/*.cc' 'include/*.h' 'tests/*.cc' 'tests/*.h')
clang-format --dry-run -Werror "${sources[@]}"
for script in scripts/*.sh .ci/run; do bash -n "$script"; done
/usr/bin/python3 scripts/check_include_graph.py
build/release/fabseq -help_markdown >build/reference_table.md
sed -n '/<!-- reference table -->/,/<!-- end of reference table -->/p' docs/users-guide.md | sed '1d;$d' | diff - build/reference_table.md ||
  { echo "docs/users-guide.md: the reference table is not what fabseq -help_markdown prints"; exit 1; }
git ls-files 'src/*.cc' | xargs -P "$(nproc)" -n 1 clang-tidy -p build/release --quiet 2>build/clang-tidy.log || { tail -n 40 build/clang-tidy.log; exit 1; }
echo "sources are clean"
