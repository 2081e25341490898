# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Starts programs so that signals end them in order; source it.

# Status of a process, waiting on when a signal has come in between. Traps of the caller count their signals in
# `signals`, a variable of the caller.
wait_for_end() {
  local seen status=0
  while true; do
    seen=$signals
    wait "$1" && status=0 || status=$?
    ((seen != signals)) || return "$status"
  done
}

# Copies lines, but those with which Open MPI's mpirun comments on a status other than 0, as if the program had crashed:
# the program has said why it ended. They stand between two lines of dashes; other lines may come in between.
leave_out_exit_reports() {
  local line held='' inside=no
  while IFS= read -r line || [[ -n $line ]]; do
    if [[ $inside == yes ]]; then
      case $line in
        ----------*) inside=no ;;
        '' | 'a non-zero exit code.'* | 'the job to be terminated. The first'* | '  Process name: '* | '  Exit code: '*) ;;
        *) printf '%s\n' "$line" ;;
      esac
    elif [[ -n $held && ($line == 'Primary job '*' terminated normally, but '* ||
      $line == 'mpirun detected that one or more processes exited with non-zero status'*) ]]; then
      held='' inside=yes
    else
      [[ -z $held ]] || printf '%s\n' "$held"
      held=''
      if [[ $line == ----------* ]]; then
        held=$line # whatever comes next decides
      else
        printf '%s\n' "$line"
      fi
    fi
  done
  [[ -z $held ]] || printf '%s\n' "$held"
}

# Runs mpirun so that Ctrl-C, TERM and a closed terminal stop the program behind it with a checkpoint:
#
#   launch_stoppable NAME COMMAND [WORD]...     NAME begins the messages
#
# mpirun itself answers them by killing its ranks within two seconds. So it gets a session of its own, which keeps the
# terminal's signals away, and USR1, which it hands on to the ranks. A second signal is handed on, too, and ends them at
# once; a third one, or Ctrl-\, kills mpirun. The status is that of COMMAND. What the terminal types does not reach the
# ranks; other input does. The traps of the shell are as before afterwards.
launch_stoppable() {
  local name=$1 signals=0 stops=0 last=-1000000 early=no launcher='' status=0 errors filter ready turn traps caught=(HUP INT QUIT TERM USR1 USR2 XCPU)
  shift
  exec {ready}<> <(:) # a pipe
  exec {errors}> >(trap '' "${caught[@]}"; echo >&"$ready"; leave_out_exit_reports >&2)
  filter=$!
  read -r -t 10 <&"$ready" || exec {errors}>&2 # until then a signal may end it
  exec {ready}>&-
  trap - URG # until it sets one, a subshell lists the traps of its parent, which it does not have
  traps=$(trap -p "${caught[@]}")
  catch_stops
  setsid "$@" <&0 2>&"$errors" {errors}>&- & # without <&0 a script's background process reads nothing
  launcher=$!
  exec {errors}>&-
  [[ $early == no ]] || hand_on_stop
  wait_for_end "$launcher" || status=$?
  for ((turn = 0; turn < 40; ++turn)); do # what it has got comes before the prompt; a rank that stays must not keep us
    kill -0 "$filter" 2>/dev/null || break
    sleep 0.05
  done
  trap - "${caught[@]}"
  eval "$traps"
  ((status != 4 || signals == 0)) || echo "$name: stopped; the same command with -restart auto continues" >&2
  return "$status"
}

catch_stops() {
  trap hand_on_stop "${caught[@]}"
  trap 'stops=2; hand_on_stop' QUIT
}

# The trap of launch_stoppable. Messages come last, since the terminal may be gone.
hand_on_stop() {
  local now=${EPOCHREALTIME:-$SECONDS.000000}
  now=${now/[.,]/} # microseconds
  signals=$((signals + 1))
  if [[ -z $launcher ]]; then
    early=yes
    return
  fi
  ((now - last > 100000)) || return 0 # `timeout` and others send the same one twice; the program has the same limit
  last=$now # the second may come while this one is looked into
  stops=$((stops + 1))
  if ((stops > 2)); then
    kill -KILL -- "-$launcher" 2>/dev/null || true
  elif ((stops == 2)); then
    kill -USR1 "$launcher" 2>/dev/null || true
    echo "$name: ending at once" >&2 || true
  elif ranks_listen; then
    kill -USR1 "$launcher" 2>/dev/null || true
    echo "$name: stopping after the solve in hand, with a checkpoint; press Ctrl-C again to end at once" >&2 || true
  else # mpirun that begins would lose USR1, and there is nothing to be saved
    kill -TERM "$launcher" 2>/dev/null || true
    kill_if_it_stays </dev/null >/dev/null 2>&1 &
    echo "$name: ending; there is nothing to save yet" >&2 || true
  fi
  last=${EPOCHREALTIME:-$SECONDS.000000} last=${last/[.,]/}
}

# Kills the session of the launcher after five seconds: until mpirun has its ranks, it or the shell that becomes it may
# lose TERM.
kill_if_it_stays() {
  local turn
  trap '' "${caught[@]}"
  for ((turn = 0; turn < 10; ++turn)); do
    sleep 0.5
    kill -0 "$launcher" || return 0
  done
  awk -v session="$launcher" '/^Pid:/ { pid = $2 } /^NSsid:/ && $2 == session { print pid }' /proc/[0-9]*/status |
    xargs -r kill -KILL -- "$launcher"
}

# Whether a process of this machine that mpirun has started catches USR1 (bit 9 of the mask).
ranks_listen() {
  local found
  trap '' "${caught[@]}" # `timeout` signals the group next, in which these commands are
  found=$(cat /proc/[0-9]*/status 2>/dev/null | awk -v session="$launcher" '
    /^Name:/ { is_rank = $2 != "mpirun" }
    /^NSsid:/ { is_rank = is_rank && $2 == session }
    /^SigCgt:/ && is_rank && substr($2, 14, 1) ~ /[2367abef]/ { print "yes" }') || true
  catch_stops
  [[ -n $found ]]
}

# For users' shells and scripts. A subshell keeps traps and notices of jobs out of them; where there is one already, as
# in `mpirun ... &`, it is the one that gets the signals.
function mpirun { # an alias of that name would be replaced in mpirun()
  if [[ $BASHPID == "$$" ]]; then (launch_stoppable mpirun mpirun "$@"); else launch_stoppable mpirun mpirun "$@"; fi
}
