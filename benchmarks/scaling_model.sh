#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Messages counted against the model, and strong scaling predicted by it: benchmarks/scaling_model.sh check; --help says more.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../scripts/environment.sh"
allow_more_ranks_than_cores
exec /usr/bin/python3 "$here/scaling_model.py" "$@"
