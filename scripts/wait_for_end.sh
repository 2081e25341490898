# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# For scripts that start a program in the background and have traps; source it. A trap counts its signals in `signals`.
signals=0

# Status of a process, waiting on when a signal has come in between.
wait_for_end() {
  local seen status=0
  while true; do
    seen=$signals
    wait "$1" && status=0 || status=$?
    ((seen != signals)) || return "$status"
  done
}
