# For the tests beside it: starts programs, waits for ports and ends, stops everything at the end.
# Use: common.sh's folder is sourced with BIN (the folder of gi-server and so on) as first argument.
set -uo pipefail
bin=$1
work=$(mktemp -d)
cd "$work" || exit
failures=0
skips=0
started=()
names=()  # of those that `beside` started
# A room with lamps that move, which is traced at once: small enough for a slow machine under
# AddressSanitizer.
room=$work/room.gltf
python3 "$(dirname "${BASH_SOURCE[0]}")/../../tools/train/make_room.py" 2 "$room" || exit
small="--gltf $room --grid 6x3x6 --rays 16 --trace-threads 1 --threads 1"
view="--camera 6,2,6,0,2,0"  # without a scene: starts at once
scene="--gltf $room --size 48x27"
slower=${GICODEC_SLOWER:-1}  # how much longer programs are given, as under ThreadSanitizer
mkfifo never && exec {never}<>never

stop_all() {
  for process in "${started[@]}"; do kill "$process" 2>/dev/null; done
  wait
}
trap 'stop_all; rm -rf "$work"' EXIT

# enough: seconds in which whoever is honest says what is due, by how long a program takes to begin here: more
# under sanitizers and on a busy machine.
enough() {
  local begin=${EPOCHREALTIME/[^0-9]/}
  "$bin/gi-client" --version >/dev/null
  local seconds=$((5 * slower + (${EPOCHREALTIME/[^0-9]/} - begin) * 40 / 1000000))
  echo $((seconds < 40 ? seconds : 40))
}

# nap: waits for a moment, without a program.
nap() { read -rt 0.03 -u "$never" || true; }

# beside FUNCTION...: what each does goes on beside all else, in a folder of its own, until `together`.
beside() {
  local name
  for name in "$@"; do
    mkdir "$name"
    (
      trap stop_all EXIT
      cd "$name" || exit
      failures=0 started=() names=()
      "$name"
      exit $((failures > 0))
    ) >"$name.out" 2>&1 &
    started+=("$!")
    names+=("$!:$name")
  done
}
# together: waits for those beside.
together() {
  local one
  for one in "${names[@]}"; do
    wait "${one%%:*}" || failed "${one#*:}"
    cat "${one#*:}.out"
  done
  names=()
}

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

# until_true COMMAND...: waits until it succeeds, at most 120 s.
until_true() {
  local end=$((SECONDS + 120))
  until "$@"; do
    ((SECONDS < end)) || return 1
    nap
  done
}

# port_of NAME: waits for NAME.port.
port_of() {
  until_true test -s "$1.port"
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

# wait_for NAME TEXT [TIMES]: until the log has it in so many lines (1), at most 120 s.
wait_for() {
  until_true log_has "$@" && return
  failed "$1 never said \"$2\""
  cat "$1.log"
}

log_has() { [ "$(grep -ce "$2" "$1.log" 2>/dev/null)" -ge "${3:-1}" ]; }

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

# skip WHAT: it cannot be tried here, which the exit code tells (77) unless something else fails.
skip() {
  echo "skipped: $*"
  skips=$((skips + 1))
}

finish() {
  together
  [ "$failures" -eq 0 ] || exit 1
  [ "$skips" -eq 0 ] || exit 77
  echo "all as expected"
  exit
}
