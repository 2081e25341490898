#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Seconds a layer over the number of layers and of ranks: benchmarks/layers.sh configs/demo.json; --help says more.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../scripts/environment.sh"
allow_more_ranks_than_cores
exec /usr/bin/python3 "$here/layers.py" "$@"
