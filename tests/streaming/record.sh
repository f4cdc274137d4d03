#!/usr/bin/env bash
# gi-client --record: what was received is in the container, bit by bit, under loss, after late
# joins, restarts and kills; full disks and files that exist.
. "$(dirname "$0")/common.sh"
gicodec=$2 testdata=$3 render=$4

# tool CODE NAME ARGUMENTS...: gicodec, output in NAME.log.
tool() {
  local code=$1 name=$2
  shift 2
  start "$name" "$gicodec" "$@"
  ends "$code" $last "$name"
}
# ends_as_served FILE: its last frames are those of the dumps, at which servers stay.
ends_as_served() {
  local texture
  rm -rf out
  tool 0 "decode-$1" decode "$1" -o out
  for texture in color vis; do
    # Textures are not in every frame.
    tool 0 "compare-$1" compare --texels-only "$(ls out/$texture.*.exr | tail -1)" "$testdata/tomb-converged/$texture.0007.exr"
  done
}
# numbers FILE: of its frames, by what is decoded of it.
numbers() {
  rm -rf out
  tool 0 "decode-$1" decode "$1" -o out
  ls out | sed -n 's/^color\.\([0-9]*\)\.exr$/\1/p'
}
# client NAME FILE OPTIONS...: everything that a server on $port sends, recorded.
client() {
  local name=$1 file=$2
  shift 2
  start "$name" "$bin/gi-client" --connect "127.0.0.1:$port" --record "$file" "$@"
}
play() {
  local name=$1
  shift
  rm -f "$name.port"
  start "$name" "$bin/gi-server" --play "$testdata/tomb-converged" --no-culling --proofs --port-file "$name.port" "$@"
  port=$(port_of "$name")
}

# all_sent NAME: by its last statistics the server NAME has sent its last frame to its client, who has
# taken all of it.
all_sent() {
  [[ $(tail -n 1 "$1.jsonl") =~ \"update\":([0-9]+),.*\"in_flight\":0,.*\"pending\":0, ]] && [ "${BASH_REMATCH[1]}" -gt 8 ]
}

# all_recorded SERVER CLIENT NAME: ends a client that has all that there is.
all_recorded() {
  until_true all_sent "$1" || failed "$3 did not get everything"
  kill -INT "$2"
  ends 0 "$2" "$3"
}

# wait_for_file FILE [BYTES]: until there is so much in it (1), at most 120 s.
wait_for_file() { until_true has_bytes "$@" || failed "$1 has not come"; }
has_bytes() { [ "$(stat -c %s "$1" 2>/dev/null || echo 0)" -ge "${2:-1}" ]; }

# Every texel as it was served, of both deliveries. And it can be served again.
every_texel() {
  local delivery=$1 server frame
  play $delivery --wait 1 --rate 20 --stats-file $delivery.jsonl
  server=$last
  client client-$delivery $delivery.gic --delivery $delivery --expect-proofs
  all_recorded $delivery $last client-$delivery
  kill $server
  ends 0 $server $delivery
  says client-$delivery "MB recorded in $delivery.gic"
  [ -e $delivery.gic.partial ] && failed "$delivery.gic.partial was left behind"
  tool 0 info-$delivery info $delivery.gic --format json
  says info-$delivery '"creator":.*gi-client'
  tool 0 verify-$delivery verify $delivery.gic
  ends_as_served $delivery.gic
  [ "$(ls out | wc -l)" -ge 10 ] || failed "$delivery.gic has few frames: $(ls out)"
  frame=$(ls out | sed -n 's/^color\.\([0-9]*\)\.exr$/\1/p' | tail -1)
  tool 0 preview preview $delivery.gic --frame "$((10#$frame))" -o $delivery.png
  start again-$delivery "$bin/gi-server" --play $delivery.gic --no-culling --wait 1 --rate 20 --stats-file again-$delivery.jsonl --port-file again-$delivery.port
  server=$last
  port=$(port_of again-$delivery)
  client second-$delivery again-$delivery.gic --delivery $delivery
  all_recorded again-$delivery $last second-$delivery
  kill $server
  ends 0 $server again-$delivery
  ends_as_served again-$delivery.gic
}
unicast() { every_texel unicast; }
shared() { every_texel shared; }

# Who joins late records from there on, all that there is.
late() {
  local server first
  play late --rate 20 --stats-file late.jsonl
  server=$last
  start early "$bin/gi-client" --connect 127.0.0.1:$port --updates 3
  ends 0 $last early
  client joined late.gic --delivery shared --stats json
  all_recorded late $last joined
  says joined '"recorded":\["late.gic"\]'
  ends_as_served late.gic
  first=$(ls out | sed -n 's/^color\.\([0-9]*\)\.exr$/\1/p' | head -1)
  [ "$((10#${first:-0}))" -ge 3 ] || failed "the recording begins with frame $first"
  kill $server
  ends 0 $server late
}

# A network that loses packets and a relay that breaks down: one file, as it was served.
lossy() {
  local server relay client at to
  play lossy --rate 10 --timeout 2 --stats-file lossy.jsonl
  server=$last
  to=$port
  relay first "$to" --loss 5 --delay 20 --jitter 20 --seed 7
  relay=$last at=$port
  client lost lossy.gic --timeout 2 --patience 60
  client=$last
  # Packets of several updates are lost before it breaks down.
  wait_for_file lossy.gic.partial 20000
  kill $relay
  ends 0 $relay first
  relay second "$to" --listen "127.0.0.1:$at"
  relay=$last
  wait_for lossy "came back"
  until_true all_sent lossy || failed "something did not come through the second relay"
  kill -INT $client
  ends 0 $client lost
  says lost "2 connections, resumed"
  [ -e lossy.2.gic ] && failed "a session that went on has two files"
  kill $relay $server
  ends 0 $relay second
  ends 0 $server lossy
  tool 0 verify-lossy verify lossy.gic
  ends_as_served lossy.gic
}

# Another server in its place: another file, whole from its first frame on.
restarted() {
  local server client to
  play former --rate 20 --timeout 2 --stats-file former.jsonl
  server=$last to=$port
  client restarted restarted.gic --timeout 2 --patience 60 --seconds 600
  client=$last
  until_true all_sent former || failed "something did not come of the first server"
  kill -9 $server
  ends 137 $server former 2>/dev/null
  play another --listen "127.0.0.1:$to" --rate 20 --stats-file another.jsonl
  server=$last
  wait_for_file restarted.2.gic.partial
  until_true all_sent another || failed "something did not come of the second server"
  kill -INT $client
  ends 0 $client restarted
  says restarted "restarted.2.gic: the recording goes on here"
  ends_as_served restarted.gic
  ends_as_served restarted.2.gic
  kill $server
  ends 0 $server another
}

# A client that is killed leaves what it had.
killed() {
  local client
  client killed killed.gic --seconds 600
  client=$last
  # More than two frames of each texture.
  wait_for_file killed.gic.partial 120000
  kill -9 $client
  ends 137 $client killed 2>/dev/null
  [ -e killed.gic ] && failed "a file that is not finished has its name"
  cp killed.gic.partial left.gic
  tool 3 cut decode left.gic -o left
  tool 0 whole decode left.gic -o left --overwrite --allow-incomplete
  [ "$(ls left | wc -l)" -ge 4 ] || failed "the frames before the kill are not there"
  client blocked killed.gic --updates 1
  ends 4 $last blocked
  says blocked "killed.gic.partial: was left over by a program that was killed"
}

# Files that exist stay; --overwrite takes their place. What is read is never written.
existing() {
  local client
  echo "a user's own" >own.txt
  client before own.gic
  client=$last
  wait_for_file own.gic.partial 20000
  kill -INT $client
  ends 0 $client before
  cp own.gic before.gic
  client kept own.gic --updates 1
  ends 4 $last kept
  says kept "own.gic: exists; --overwrite replaces it"
  cmp own.gic before.gic || failed "it was replaced"
  cp own.txt numbered.2.gic
  client numbered numbered.gic --updates 1
  ends 4 $last numbered
  says numbered "numbered.2.gic: exists"
  [ -e numbered.gic ] && failed "a file was made"
  client replaced own.gic --overwrite
  client=$last
  wait_for_file own.gic.partial 20000
  kill -INT $client
  ends 0 $client replaced
  cmp -s own.gic before.gic && failed "it was not replaced"
  echo sesame >token
  chmod 600 token
  client reads token --updates 1 --overwrite --token-file token
  ends 2 $last reads
  says reads "token: is one of the inputs"
  client nowhere nowhere/x.gic --updates 1
  ends 4 $last nowhere
  says nowhere "make it first"
}

# Names and files that others take.
taken() {
  local client
  echo "a user's own" >own.txt
  # A name that is taken meanwhile stays with whom it is.
  client meanwhile meanwhile.gic --seconds 600
  client=$last
  wait_for_file meanwhile.gic.partial
  cp own.txt meanwhile.gic
  kill -INT $client
  ends 4 $client meanwhile
  says meanwhile "meanwhile.gic: has appeared meanwhile.*the result is meanwhile.gic.partial$"
  says meanwhile "MB recorded in meanwhile.gic.partial;"
  cmp own.txt meanwhile.gic || failed "a file that appeared was replaced"
  mv meanwhile.gic.partial unnamed.gic
  tool 0 unnamed verify unnamed.gic
  # Files that are gone, or are another program's, are not told of as if they were there.
  client gone gone.gic --seconds 600 --stats json
  client=$last
  wait_for_file gone.gic.partial
  rm gone.gic.partial
  kill -INT $client
  ends 4 $client gone
  says gone "gone.gic.partial: was removed or renamed while it was written, so that there is no gone.gic;"
  says gone '"recorded":\[\],"recorded_without_name":\[\]'
  grep -q "the client goes on" gone.log && failed "a client that ends is said to go on"
  client theirs theirs.gic --seconds 600
  client=$last
  wait_for_file theirs.gic.partial
  mv theirs.gic.partial moved && cp own.txt theirs.gic.partial
  kill -INT $client
  ends 4 $client theirs
  says theirs "theirs.gic.partial: another program has taken its place"
  grep -q "recorded in" theirs.log && failed "a file of another program's is told of"
  cmp own.txt theirs.gic.partial || failed "another program's file was touched"
}

# goes_on NAME TEXT: when its log says so, the only client on $control is sent a dozen updates more.
goes_on() {
  local sent
  wait_for "$@"
  sent=$(sent_updates)
  until_true has_more $((sent + 12)) || failed "$1 does not go on"
}
sent_updates() { "$bin/gi-server" --ask control list | awk 'NR == 2 {print $6}'; }
has_more() { [ "$(sent_updates)" -ge "$1" ]; }

# A limit ends the recording, which is whole, and not the client.
most() {
  local server client
  play limit --rate 20 --loop --control control
  server=$last
  client most most.gic --max-record-mb 1 --subscribe all --expect-proofs
  client=$last
  goes_on most "are full"
  kill -INT $client
  ends 0 $client most
  [ "$(grep -c "most.gic: the 1 MiB of --max-record-mb are full;.*the client goes on" most.log)" = 1 ] ||
    { failed "the end of a full recording was not said once"; cat most.log; }
  says most "[1-9][0-9]* updates in .* MB recorded in most.gic;"
  [ -e most.gic.partial ] && failed "most.gic.partial was left behind"
  [ "$(stat -c %s most.gic)" -lt 1500000 ] || failed "most.gic has $(stat -c %s most.gic) bytes"
  tool 0 most-verify verify most.gic
  kill $server
  ends 0 $server limit
}

# A full disk ends the recording, not the client, and what came before is there.
limited() {
  ulimit -f 100
  exec "$@"
}
full() {
  local server client frame
  play disk --rate 20 --loop --control control
  server=$last
  start full limited "$bin/gi-client" --connect "127.0.0.1:$port" --record full.gic --expect-proofs
  client=$last
  goes_on full "full.gic: cannot be written: File too large; the recording ends here"
  kill -INT $client
  ends 4 $client full
  says full "[1-9][0-9]* updates in"
  frame=$(numbers full.gic | tail -1)
  [ -n "$frame" ] || failed "nothing is left of what was recorded"
  ln -s /dev/full device
  client device device
  client=$last
  goes_on device "device: cannot be written: No space left on device"
  kill -INT $client
  ends 4 $client device
  says device "[1-9][0-9]* updates in"
  kill $server
  ends 0 $server disk
}

# Its probes light the scene where they stood.
lights() {
  local server frame
  server traced --rate 20 --updates 8 --wait 1
  server=$last
  client lit lit.gic --updates 6
  ends 0 $last lit
  ends 0 $server traced
  frame=$(numbers lit.gic | tail -1)
  start render "$render" --stream lit.gic --dumps out --frame "$((10#$frame))" --gltf $room --size 48x27 --compare
  ends 0 $last render
  says render ": 0 of [0-9]* pixels differ"
}

# Two volumes, one of which scrolls with the camera.
scrolls() {
  local delivery=$1 server volume
  server fine-$delivery --fine 5x4x5 --fine-spacing 2 --lockstep --rate $((6 / slower)) --updates 24 --wait 1 --proofs
  server=$last
  client scrolls-$delivery fine-$delivery.gic $scene --orbit --delivery $delivery --updates 24 --expect-proofs
  ends 0 $last scrolls-$delivery
  ends 0 $server fine-$delivery
  tool 0 info info fine-$delivery.gic --format json
  python3 -c 'import json; assert len(json.load(open("info.log"))["volumes"]) == 2' || failed "volumes are missing"
  for volume in $(python3 -c 'import json; print(*[v["name"] for v in json.load(open("info.log"))["volumes"]])'); do
    rm -rf out
    tool 0 decode decode fine-$delivery.gic --volume "$volume" -o out
    [ "$(ls out | wc -l)" -gt 8 ] || failed "$volume was hardly recorded"
  done
}
scrolls_unicast() { scrolls unicast; }
scrolls_shared() { scrolls shared; }

play busy --rate 20 --loop --max-unicast-per-address 0 --max-per-address 40
busy=$last
beside lossy restarted unicast shared most killed existing taken full
beside late lights scrolls_unicast scrolls_shared
together
kill $busy
ends 0 $busy busy
finish
