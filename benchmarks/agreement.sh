#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Lanes against the reference path, field by field: benchmarks/agreement.sh configs/v_shape_coarse.json; --help says more.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../scripts/environment.sh"
allow_more_ranks_than_cores
exec /usr/bin/python3 "$here/agreement.py" "$@"
