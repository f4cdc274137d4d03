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

# Every texel as it was served, of both deliveries. And it can be served again.
for delivery in own shared; do
  play $delivery --wait 1 --updates 30 --rate 10
  server=$last
  client client-$delivery $delivery.gic --delivery $delivery --updates 30 --expect-proofs
  ends 0 $last client-$delivery
  ends 0 $server $delivery
  says client-$delivery "MB recorded in $delivery.gic"
  [ -e $delivery.gic.partial ] && failed "$delivery.gic.partial was left behind"
  tool 0 info-$delivery info $delivery.gic --format json
  says info-$delivery '"creator":.*gi-client'
  tool 0 verify-$delivery verify $delivery.gic
  ends_as_served $delivery.gic
  [ "$(ls out | wc -l)" -ge 10 ] || failed "$delivery.gic has few frames: $(ls out)"
  frame=$(numbers $delivery.gic | tail -1)
  tool 0 preview preview $delivery.gic --frame "$((10#$frame))" -o $delivery.png
  start again-$delivery "$bin/gi-server" --play $delivery.gic --no-culling --wait 1 --updates 30 --rate 10 --port-file again-$delivery.port
  server=$last
  port=$(port_of again-$delivery)
  client second-$delivery again-$delivery.gic --delivery $delivery --updates 30
  ends 0 $last second-$delivery
  ends 0 $server again-$delivery
  ends_as_served again-$delivery.gic
done

# Who joins late records from there on, all that there is.
play late --rate 4
server=$last
start early "$bin/gi-client" --connect 127.0.0.1:$port --updates 3
ends 0 $last early
client joined late.gic --delivery shared --updates 30 --stats json
ends 0 $last joined
says joined '"recorded":\["late.gic"\]'
first=$(numbers late.gic | head -1)
[ "$((10#${first:-0}))" -ge 3 ] || failed "the recording begins with frame $first"
ends_as_served late.gic
kill $server
ends 0 $server late

# A network that loses packets and a relay that breaks down: one file, as it was served.
play lossy --rate 2 --timeout 2
server=$last
to=$port
relay first "$to" --loss 5 --delay 20 --jitter 20 --seed 7
relay=$last at=$port
client lost lossy.gic --timeout 1 --updates 24 --patience 30
client=$last
wait_for lossy joined
sleep 1.5
kill $relay
ends 0 $relay first
relay second "$to" --listen "127.0.0.1:$at"
relay=$last
ends 0 $client lost
says lost "2 connections, resumed"
[ -e lossy.2.gic ] && failed "a session that went on has two files"
kill $relay
ends 0 $relay second
tool 0 verify-lossy verify lossy.gic
ends_as_served lossy.gic

# wait_for_file FILE: until there is something in it, at most 30 s.
wait_for_file() {
  local i
  for ((i = 0; i < 300; ++i)); do [ -s "$1" ] && return; sleep 0.1; done
  failed "$1 has not come"
}

# Another server in its place: another file, whole from its first frame on.
port=$to
client restarted restarted.gic --timeout 1 --patience 30 --seconds 60
client=$last
wait_for_file restarted.gic.partial
sleep 2
kill -9 $server
ends 137 $server lossy 2>/dev/null
sleep 0.5
play another --listen "127.0.0.1:$to" --rate 10
server=$last
wait_for_file restarted.2.gic.partial
sleep 4
kill -INT $client
ends 0 $client restarted
says restarted "restarted.2.gic: the recording goes on here"
ends_as_served restarted.gic
ends_as_served restarted.2.gic
kill $server
ends 0 $server another
play busy --rate 10 --loop
server=$last

# A client that is killed leaves what it had.
client killed killed.gic --seconds 60
client=$last
wait_for_file killed.gic.partial
sleep 1
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

# Files that exist stay; --overwrite takes their place. What is read is never written.
echo "a user's own" >own.txt
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
client replaced own.gic --updates 2 --overwrite
ends 0 $last replaced
cmp -s own.gic before.gic && failed "it was not replaced"
# A name that is taken meanwhile stays with whom it is.
client meanwhile meanwhile.gic --seconds 60
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
client gone gone.gic --seconds 60 --stats json
client=$last
wait_for_file gone.gic.partial
rm gone.gic.partial
kill -INT $client
ends 4 $client gone
says gone "gone.gic.partial: was removed or renamed while it was written, so that there is no gone.gic;"
says gone '"recorded":\[\],"recorded_without_name":\[\]'
grep -q "the client goes on" gone.log && failed "a client that ends is said to go on"
client theirs theirs.gic --seconds 60
client=$last
wait_for_file theirs.gic.partial
mv theirs.gic.partial moved && cp own.txt theirs.gic.partial
kill -INT $client
ends 4 $client theirs
says theirs "theirs.gic.partial: another program has taken its place"
grep -q "recorded in" theirs.log && failed "a file of another program's is told of"
cmp own.txt theirs.gic.partial || failed "another program's file was touched"

# A limit ends the recording, which is whole, and not the client.
client most most.gic --max-record-mb 1 --updates 250 --subscribe all --expect-proofs
ends 0 $last most
[ "$(grep -c "most.gic: the 1 MiB of --max-record-mb are full;.*the client goes on" most.log)" = 1 ] ||
  { failed "the end of a full recording was not said once"; cat most.log; }
says most "250 updates in .* MB recorded in most.gic;"
[ -e most.gic.partial ] && failed "most.gic.partial was left behind"
[ "$(stat -c %s most.gic)" -lt 1500000 ] || failed "most.gic has $(stat -c %s most.gic) bytes"
tool 0 most-verify verify most.gic
echo sesame >token
chmod 600 token
client reads token --updates 1 --overwrite --token-file token
ends 2 $last reads
says reads "token: is one of the inputs"
client nowhere nowhere/x.gic --updates 1
ends 4 $last nowhere
says nowhere "make it first"

# A full disk ends the recording, not the client, and what came before is there.
limited() {
  ulimit -f 100
  exec "$@"
}
start full limited "$bin/gi-client" --connect "127.0.0.1:$port" --record full.gic --updates 12 --expect-proofs
ends 4 $last full
says full "full.gic: cannot be written: File too large; the recording ends here"
says full "1[2-9] updates in" # more where two came at once
frame=$(numbers full.gic | tail -1)
[ -n "$frame" ] || failed "nothing is left of what was recorded"
ln -s /dev/full device
client device device --updates 3
ends 4 $last device
says device "device: cannot be written: No space left on device"
says device "3 updates in"
kill $server
ends 0 $server busy

# Its probes light the scene where they stood.
server traced --rate 10 --updates 8 --wait 1
server=$last
client lit lit.gic --updates 6
ends 0 $last lit
ends 0 $server traced
frame=$(numbers lit.gic | tail -1)
start render "$render" --stream lit.gic --dumps out --frame "$((10#$frame))" --scene villa --size 48x27 --compare
ends 0 $last render
says render ": 0 of [0-9]* pixels differ"

# Two volumes, one of which scrolls with the camera.
for delivery in own shared; do
  server fine-$delivery --fine 5x4x5 --fine-spacing 2 --lockstep --rate 6 --updates 24 --wait 1 --proofs
  server=$last
  client scrolls-$delivery fine-$delivery.gic $scene --delivery $delivery --updates 24 --expect-proofs
  ends 0 $last scrolls-$delivery
  ends 0 $server fine-$delivery
  tool 0 info info fine-$delivery.gic --format json
  python3 -c 'import json; assert len(json.load(open("info.log"))["volumes"]) == 2' || failed "volumes are missing"
  for volume in $(python3 -c 'import json; print(*[v["name"] for v in json.load(open("info.log"))["volumes"]])'); do
    rm -rf out
    tool 0 decode decode fine-$delivery.gic --volume "$volume" -o out
    [ "$(ls out | wc -l)" -gt 8 ] || failed "$volume was hardly recorded"
  done
done
finish
