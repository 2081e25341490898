#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Time and memory over the number of elements: benchmarks/size.sh benchmarks/v_shape.json --memory 20; --help says more.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../scripts/environment.sh"
allow_more_ranks_than_cores
exec /usr/bin/python3 "$here/size.py" "$@"
