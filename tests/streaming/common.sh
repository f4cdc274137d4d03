# For the tests beside it: starts programs, waits for ports and ends, stops everything at the end.
# Use: common.sh's folder is sourced with BIN (the folder of gi-server and so on) as first argument.
set -uo pipefail
bin=$1
work=$(mktemp -d)
cd "$work" || exit
failures=0
started=()
# Small enough for a slow machine under AddressSanitizer.
small="--scene villa --grid 6x3x6 --rays 16 --trace-threads 1 --threads 1"
view="--camera 0,2,6,0,2,0"  # without a scene: starts at once
scene="--scene villa --size 48x27"

stop_all() {
  for process in "${started[@]}"; do kill "$process" 2>/dev/null; done
  wait
  rm -rf "$work"
}
trap stop_all EXIT

failed() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# start NAME COMMAND...: in the background, output in NAME.log; its process in $last.
start() {
  local name=$1
  shift
  "$@" >"$name.log" 2>&1 &
  last=$!
  started+=("$last")
}

# port_of NAME: waits for NAME.port, at most 120 s.
port_of() {
  local i
  for ((i = 0; i < 1200; ++i)); do
    [ -s "$1.port" ] && break
    sleep 0.1
  done
  cat "$1.port"
}

# server NAME OPTIONS...: its process in $last, its port in $port.
server() {
  local name=$1
  shift
  rm -f "$name.port"
  start "$name" "$bin/gi-server" $small --port-file "$name.port" "$@"
  port=$(port_of "$name")
}

# relay NAME PORT OPTIONS...: likewise, towards PORT.
relay() {
  local name=$1 to=$2
  shift 2
  rm -f "$name.port"
  start "$name" "$bin/gi-relay" --to "127.0.0.1:$to" --port-file "$name.port" "$@"
  port=$(port_of "$name")
}

# wait_for NAME TEXT: until the log has it, at most 120 s.
wait_for() {
  local i
  for ((i = 0; i < 1200; ++i)); do
    grep -qe "$2" "$1.log" && return
    sleep 0.1
  done
  failed "$1 never said \"$2\""
  cat "$1.log"
}

# ends CODE PROCESS NAME: waits; shows the log if the exit code is another one.
ends() {
  wait "$2"
  local got=$?
  [ "$got" -eq "$1" ] && return
  failed "$3 ended with $got instead of $1"
  cat "$3.log"
}

# says NAME TEXT: the log has it.
says() {
  grep -qe "$2" "$1.log" && return
  failed "$1 does not say \"$2\":"
  cat "$1.log"
}

finish() {
  [ "$failures" -eq 0 ] && echo "all as expected"
  exit $((failures > 0))
}
