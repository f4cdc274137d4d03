#!/usr/bin/env bash
# gi-server as a service: what it says, its operator's socket, caps, signals, recordings that do not
# fit; and clients that do not get what they asked for.
. "$(dirname "$0")/common.sh"
gicodec=$2 testdata=$3 trace=$4
"$gicodec" encode -q -o tomb.gic "$testdata/tomb-converged" || failed "encode"

# play NAME FILE OPTIONS...: a server of a recording; its process in $server, its address in $address.
play() {
  local name=$1
  shift
  rm -f "$name.port"
  start "$name" "$bin/gi-server" --play "$@" --port-file "$name.port"
  server=$last
  address=127.0.0.1:$(port_of "$name")
}

# The operator lists and drops; caps hold whatever clients ask for.
operator() {
  local server address dropped stays stamp
  play played ../tomb.gic --loop --no-culling --rate 20 --control socket --stats json --log-updates capped.csv \
    --max-kbps-per-client 160
  start dropped "$bin/gi-client" --connect $address --budget-bytes 1000000000
  dropped=$last
  wait_for played "joined as client 1"
  [ "$(stat -c %a socket)" = 600 ] || failed "the socket is open to others"
  start list "$bin/gi-server" --ask socket list
  ends 0 $last list
  says list "^ *1 .*127.0.0.1:[0-9]* *unicast "
  start taken "$bin/gi-server" --play ../tomb.gic --control socket
  ends 4 $last taken
  says taken "another server answers there"
  start nobody "$bin/gi-server" --ask socket "drop 77"
  ends 3 $last nobody
  start unknown "$bin/gi-server" --ask socket restart
  ends 3 $last unknown
  says unknown "list, drop"
  start leaves "$bin/gi-client" --connect $address --updates 5
  ends 0 $last leaves
  start drop "$bin/gi-server" --ask socket "drop 1"
  ends 0 $last drop
  ends 4 $dropped dropped
  says dropped "operator"
  wait_for played "left as client 2"
  stamp="^20[0-9-]*T[0-9:]*\.[0-9]*Z gi-server: 127.0.0.1:[0-9]*"
  says played "$stamp left as client 2 after [0-9.]* s, [0-9.]* MB in [0-9]* updates"
  says played "$stamp dropped: the server's operator ended it, as client 1 after [0-9.]* s, [0-9.]* MB in"
  start stays "$bin/gi-client" --connect $address
  stays=$last
  wait_for played "joined as client 3"
  kill -HUP $server
  ends 0 $server played
  ends 0 $stays stays
  says played "let go: the server ends, as client 3"
  says played '^{"time":"20[0-9-]*T[0-9:.]*Z","second"'
  says played '"summary":{"time":"20'
  [ -e socket ] && failed "the socket is left"
  start ask "$bin/gi-server" --ask socket list
  ends 4 $last ask
  # A second's worth and the bytes of a message around its packets.
  awk -F, 'NR > 1 {n += $8 > 0; if ($8 > most) most = $8} END {exit !(n > 4 && most <= 21000)}' capped.csv ||
    failed "a client was sent more than it may be"
}

# A socket that a server left behind is taken over; fewer updates than asked for are a failure.
left_socket() {
  local server address
  play killed ../tomb.gic --control socket
  kill -KILL $server
  ends 137 $server killed
  play short ../tomb.gic --control socket --no-culling --rate 20 --updates 3 --wait 1
  start fewer "$bin/gi-client" --connect $address --updates 10
  ends 1 $last fewer
  says fewer "received 3 of 10 updates: the server has ended"
  ends 0 $server short
}

# A recording that was cut off.
cut_off() {
  local server address size file
  size=$(stat -c %s ../tomb.gic)
  head -c $((size / 2)) ../tomb.gic >cut.gic
  head -c $((size - 5)) ../tomb.gic >tail.gic
  # Damage in the middle, in a packet that no reader of the index would look at.
  cp ../tomb.gic hurt.gic
  printf X | dd of=hurt.gic bs=1 seek=$((size / 2)) conv=notrunc status=none
  for file in cut.gic tail.gic; do
    start $file "$bin/gi-server" --play $file
    ends 3 $last $file
    says $file "$file: its end is missing (cut off, or still being written): it holds frames 0-[0-9].*[0-9] whole frames are before that.*--allow-incomplete"
  done
  start hurt "$bin/gi-server" --play hurt.gic
  ends 3 $last hurt
  says hurt "hurt.gic: .*after frame [0-9]*: .*checksum.*; [0-9] whole frames are before that.*--allow-incomplete"
  for file in cut.gic hurt.gic; do
    play left-$file $file --allow-incomplete --no-culling --loop --rate 20 --updates 20 --wait 1 --proofs
    start rest-$file "$bin/gi-client" --connect $address --updates 20 --expect-proofs
    ends 0 $last rest-$file
    ends 0 $server left-$file
    says left-$file "$file: .*whole frames are before that and played"
  done
}

hurt_dumps() {
  local server address
  cp -r "$testdata/tomb-converged" dumps
  head -c 100 dumps/vis.0003.exr >dumps/short && mv dumps/short dumps/vis.0003.exr
  start hurt-dumps "$bin/gi-server" --play dumps
  ends 3 $last hurt-dumps
  says hurt-dumps "vis.0003.exr: .*; 3 whole frames are before that"
  play incomplete dumps --allow-incomplete --no-culling --updates 3 --wait 1
  start rest "$bin/gi-client" --connect $address --updates 3
  ends 0 $last rest
  ends 0 $server incomplete
}

# Damage that comes while it plays is met by all with an end, and a reason.
hurt_later() {
  local server address watching
  cp ../tomb.gic later.gic
  play later later.gic --no-culling --loop --rate 20
  start watching "$bin/gi-client" --connect $address
  watching=$last
  wait_for later "joined as client 1"
  printf X | dd of=later.gic bs=1 seek=$(($(stat -c %s later.gic) / 2)) conv=notrunc status=none
  ends 3 $server later
  ends 0 $watching watching
  says later "later.gic: .*after frame [0-9]*: .*checksum"
}

# What was lost before is told. x265 leaks.
lossy() {
  local server address
  if "$gicodec" backends | grep -q "^hevc .*x265"; then
    ASAN_OPTIONS=detect_leaks=0 "$gicodec" encode -q -o lossy.gic --backend hevc --lossy qp=20 \
      "$testdata/tomb-converged" || failed "encode --lossy"
    play lossy lossy.gic --updates 1
    ends 0 $server lossy
    says lossy "lossy.gic: texture color was coded LOSSY (qp=20)"
  fi
}

# Names that clients would refuse.
strange_names() {
  local dump
  mkdir strange
  for dump in "$testdata"/tomb-converged/color.*; do ln -s "$dump" strange/$'\xff'"$(basename "$dump")"; done
  start strange "$bin/gi-server" --play strange
  ends 3 $last strange
  says strange "xffcolor is not UTF-8; rename its dumps"
}

# Dumps that do not say that they are of probes get there by a container; those of other blocks never.
layouts() {
  local server address layout
  for layout in rtxgi bevy; do
    "$trace" -q --gltf $room --grid 3x2x3 --rays 16 --frames 1 --layout $layout -o $layout-traced.gic || failed "gi-trace"
    "$gicodec" decode -q $layout-traced.gic --files dds -o "$layout dds" || failed "decode --files"
    start silent "$bin/gi-server" --play "$layout dds"
    ends 3 $last silent
    says silent "$layout dds: its dumps do not say.* gicodec encode --layout NAME --grid XxYxZ -o FILE.gic \"$layout dds\"$"
  done
  "$gicodec" encode -q --layout rtxgi --grid 3x2x3 -o rtxgi.gic "rtxgi dds" || failed "encode --layout"
  play rtxgi rtxgi.gic --updates 1
  ends 0 $server rtxgi
  "$gicodec" decode -q bevy-traced.gic -o cells || failed "decode"
  start cells "$bin/gi-server" --play cells
  ends 3 $last cells
  says cells "cells: its dumps are of other blocks than probes"
  grep -q "gicodec encode" cells.log && failed "what is advised does not help"
}

# Another scene is refused; nothing is drawn without probes.
scenes() {
  local server address load
  start mistaken "$bin/gi-server" --play ../tomb.gic --scene villa
  ends 3 $last mistaken
  says mistaken "traced in tomb, not in villa"
  play villa "$testdata/villa-converged" --loop
  for load in "--updates 3" "--simulate 2"; do
    start other "$bin/gi-client" --connect $address --scene tomb $load
    ends 3 $last other
    says other "streams villa, and the scene here is tomb: use --scene villa"
  done
  kill -TERM $server
  ends 0 $server villa
}

# A server that goes without a word, and one that may not start beside it: its reports stay.
gone() {
  local server address crowd
  play gone "$testdata/tomb-converged" --loop --stats-file stats --control socket
  start crowd "$bin/gi-client" --connect $address --simulate 2 --discard --patience 1 --timeout 1
  crowd=$last
  until_true test -s stats
  start second "$bin/gi-server" --play "$testdata/tomb-converged" --stats-file stats --control socket
  ends 4 $last second
  [ -s stats ] || failed "a server that did not start emptied another's statistics"
  kill -KILL $server
  ends 4 $crowd crowd
  says crowd "no server answers"
}

unseen() {
  local server address
  play unseen "$testdata/villa-converged" --updates 3 --wait 1
  start away "$bin/gi-client" --connect $address --camera 0,1000,0,0,2000,0 --frames 1 -o away
  ends 1 $last away
  ends 0 $server unseen
  says away "pictures begin when light has come"
  says away "drew 0 of 1 picture: the server has ended"
  [ -e away ] && failed "something was drawn without probes"
}

# Signals while a scene loads, which never ends here, and while the first frame is traced.
# hears PROCESS: it takes signals in its own way by now.
hears() { until_true catches "$1" || failed "process $1 does not hear SIGHUP"; }
catches() {
  local caught
  # The name first: between fork and exec what is caught is the shell's.
  grep -q "^gi-" "/proc/$1/comm" || return
  caught=$(sed -n 's/^SigCgt:[[:space:]]*//p' "/proc/$1/status")
  [ -n "$caught" ] && ((0x$caught & 1))
}
signal_loading() {
  mkfifo slow.gic
  exec 9<>slow.gic
  start loading "$bin/gi-server" --play slow.gic --stats json
  hears $last
  kill -HUP $last
  ends 0 $last loading
  says loading '"summary".*"updates":0'
  exec 9>&-
}

signal_connecting() {
  start connecting "$bin/gi-client" --connect 127.0.0.1:1 --patience 1000 --updates 3
  hears $last
  kill -HUP $last
  ends 1 $last connecting
  says connecting "received 0 of 3 updates: interrupted"
}

# Interrupted, maybe while its scene loads, a client says what it was to do and did not.
signal_viewing() {
  local client=("$bin/gi-client" --connect 127.0.0.1:1 --patience 1000 --scene street)
  start unproven "${client[@]}" --expect-proofs
  hears $last
  kill -HUP $last
  ends 1 $last unproven
  says unproven "no proof"
  start unrecorded "${client[@]}" --record never.gic
  hears $last
  kill -HUP $last
  ends 1 $last unrecorded
  says unrecorded "had nothing to write"
  [ ! -e never.gic ] || failed "there is a recording of nothing"
}

signal_tracing() {
  start tracing "$bin/gi-server" --scene villa --mode noisy --rays 65536 --control tracing.socket
  until_true test -e tracing.socket
  kill -TERM $last
  ends 0 $last tracing
  says tracing "^0 updates"
  grep -q listening tracing.log && failed "the first frame was traced to its end"
}

beside operator lossy layouts gone cut_off scenes signal_tracing
beside left_socket hurt_dumps hurt_later strange_names unseen signal_loading signal_connecting
beside signal_viewing
finish
