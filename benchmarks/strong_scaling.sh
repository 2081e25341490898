#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Speed-up over groups x domain ranks: benchmarks/strong_scaling.sh configs/demo.json --ranks 1 2 4; --help says more.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../scripts/environment.sh"
allow_more_ranks_than_cores
exec /usr/bin/python3 "$here/strong_scaling.py" "$@"
