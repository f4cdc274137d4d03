#!/usr/bin/env bash
# What is left when gi-trace and gi-render are stopped, killed, or cannot write: former files, whole
# frames, no half files under final names, no temporary files of a process that ended itself.
set -uo pipefail
trace=$1 render=$2 gicodec=$3
. "$(dirname "$0")/support.sh"
run=("$trace" -q --gltf plane.gltf --grid 4x4x4 --rays 64)

# hidden DIR: temporary files in it.
hidden() { find "$1" -name '.*' ! -path "$1"; }
# no_hidden DIR
no_hidden() { [ -z "$(hidden "$1")" ] || fail "temporary files in $1: $(hidden "$1")"; }
# hears PROCESS: it takes signals in its own way by now.
hears() {
  local caught
  caught=$(sed -n 's/^SigCgt:[[:space:]]*//p' "/proc/$1/status")
  ((0x${caught:-0} & 0x4000)) # SIGTERM
}
# stop SIGNAL CODE FILE COMMAND...: sends the signal once the command runs and FILE is there; its words
# go to `words`.
stop() {
  local signal=$1 code=$2 file=$3 got
  shift 3
  "$@" 2> words &
  local process=$!
  until grep -q '^gi-' /proc/$process/comm 2> /dev/null; do kill -0 $process || break; done
  [ "$signal" = KILL ] || until hears $process 2> /dev/null; do kill -0 $process || break; done
  until begun "$file" || ! kill -0 $process 2> /dev/null; do sleep 0.02; done
  kill "-$signal" $process
  wait $process 2> /dev/null
  got=$?
  [ $got -eq "$code" ] || fail "$* : exit code $got instead of $code after SIG$signal: $(cat words)"
}
# begun FILE: it has more than a head; a folder is there.
begun() { [ -d "$1" ] || [ "$(stat -c %s "$1" 2> /dev/null || echo 0)" -gt 3000 ]; }
# said TEXT: in the words of the command that was stopped.
said() { grep -qF -- "$1" words || fail "no \"$1\" in: $(cat words)"; }
"${run[@]}" --frames 2 -o reference.gic || fail "the reference"
"$gicodec" decode -q reference.gic -o reference || fail "its dumps"

# Stopped, it holds its frames; killed, they are in what it wrote so far.
stop TERM 143 part.gic.partial "${run[@]}" --frames 100000 -o part.gic
said "of 100000 frames"
expect 0 "sound" "$gicodec" verify part.gic
stop KILL 137 dead.gic.partial "${run[@]}" --frames 100000 -o dead.gic
absent dead.gic
expect 4 "left over" "${run[@]}" --frames 1 -o dead.gic
expect 0 "" "$gicodec" info dead.gic.partial --allow-incomplete

# Without --overwrite a container that appears meanwhile stays, and what was traced is beside it.
"${run[@]}" --frames 2000 -o late.gic 2> words &
process=$!
until begun late.gic.partial || ! kill -0 $process 2> /dev/null; do sleep 0.02; done
cp reference.gic late.gic
kill -TERM $process
wait $process
code=$?
[ $code -eq 4 ] || fail "exit code $code instead of 4 where a container appeared: $(cat words)"
said "late.gic: has appeared meanwhile; the result is late.gic.partial"
cmp -s reference.gic late.gic || fail "a container that appeared meanwhile was replaced"
expect 0 "sound" "$gicodec" verify late.gic.partial

# --overwrite leaves what was there until all is traced.
cp reference.gic former.gic
stop KILL 137 former.gic.partial "${run[@]}" --seed 2 --frames 100000 --overwrite -o former.gic
cmp -s reference.gic former.gic || fail "a killed --overwrite changed what was there"
rm former.gic.partial
stop TERM 143 former.gic.partial "${run[@]}" --seed 2 --frames 100000 --overwrite -o former.gic
cmp -s reference.gic former.gic || fail "an interrupted --overwrite changed what was there"
said "it stays as it was, and former.gic.partial holds "
expect 0 "" "$gicodec" info former.gic.partial --allow-incomplete
rm former.gic.partial

# Files must not grow: what was there stays, and frames before that in what was written so far.
limited() { (ulimit -f 4 && exec "$@"); }
expect 4 "File too large" limited "${run[@]}" --frames 60 --overwrite -o former.gic
cmp -s reference.gic former.gic || fail "--overwrite without space changed what was there"
rm -f former.gic.partial
photons=("$trace" --scene tomb --kind photons --set photons=64 --set max-batches=4 --frames 60 -o photons.gic)
expect 4 "of 60 frames, for --allow-incomplete" limited "${photons[@]}"
absent photons.gic
expect 0 "" "$render" --stream photons.gic.partial --allow-incomplete --size 16x9 -o part.png
expect 4 "left over" "${photons[@]}"
draw=("$render" --gltf plane.gltf --dumps reference --size 200x100 --samples 1)
echo former > kept.exr
expect 4 "File too large" limited "${draw[@]}" --overwrite -o kept.exr
ln -s /dev/full full.png
expect 4 "No space left" "${draw[@]}" -o full.png
stop TERM 143 . "$render" --gltf plane.gltf --dumps reference --size 9000x9000 --samples 16 --overwrite -o kept.exr
stop KILL 137 . "$render" --gltf plane.gltf --dumps reference --size 9000x9000 --samples 16 --overwrite -o kept.exr
[ "$(cat kept.exr)" = former ] || fail "a picture that failed replaced another"
no_hidden .

# A disk that fills up while tracing: the frames before that.
small_disk() {
  unshare -rm sh -c 'mkdir disk && mount -t tmpfs -o size=160k tmpfs disk && "$@" -o disk/out.gic
    code=$?; cp disk/* .; exit $code' sh "$@"
}
if unshare -rm true 2> /dev/null; then
  expect 4 "for --allow-incomplete" small_disk "${run[@]}" --mode noisy --frames 1000
  absent out.gic
  expect 0 "" "$gicodec" decode -q out.gic.partial --allow-incomplete -o full
  [ -s full/vis.0000.exr ] || fail "a full disk holds no frame"
else
  echo "skipped: a full disk needs mount namespaces"
fi

# A folder that cannot be written.
as=()
[ "$(id -u)" -ne 0 ] || as=(setpriv --reuid=65534 --regid=65534 --clear-groups)
chmod 755 . && chmod -R a+rX,a-w reference
if "${as[@]}" test -x "$trace" && ! "${as[@]}" test -w reference; then
  expect 4 "Permission denied" "${as[@]}" "${run[@]}" --frames 1 -o reference/new.gic
  expect 4 "Permission denied" "${as[@]}" "${draw[@]}" -o reference/a.png
else
  echo "skipped: a folder that cannot be written needs another user"
fi
chmod -R u+w reference
end
