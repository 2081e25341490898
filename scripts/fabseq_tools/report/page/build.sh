#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes bundle.js.xz, what report.py puts into its pages, from src with the versions of package-lock.json, and
# LICENSES.txt. The first line of the bundle has a hash of what it was made from; the archive has a checksum
# that whoever unpacks it compares. Needs npm (Node.js 18 or later) and the network.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

npm ci --ignore-scripts
hash=$(cat $(printf '%s\n' src/*.js package-lock.json | LC_ALL=C sort) | sha256sum | cut -d ' ' -f 1)
./node_modules/.bin/esbuild src/main.js --bundle --minify --format=iife --target=es2022 --charset=utf8 --loader:.css=text \
  --legal-comments=inline --banner:js="// SPDX-License-Identifier: MIT; made by build.sh from sources with sha256 $hash" --outfile=node_modules/bundle.js
xz -9 --extreme --check=sha256 --stdout node_modules/bundle.js >bundle.js.xz
for package in three uplot; do
  printf '%s %s\n\n' "$package" "$(node -p "require('./node_modules/$package/package.json').version")"
  cat "node_modules/$package/LICENSE"
  printf '\n'
done >LICENSES.txt
