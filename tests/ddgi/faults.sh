#!/usr/bin/env bash
# What is left when gi-trace and gi-render are stopped, killed, or cannot write: former results,
# whole frames, no half files under final names, no temporary files of a process that ended itself.
set -uo pipefail
trace=$1 render=$2
. "$(dirname "$0")/support.sh"
run=("$trace" -q --gltf plane.gltf --grid 4x4x4 --rays 64)
frames=8

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
words=words
# stop SIGNAL CODE FILE COMMAND...: sends the signal once the command runs and FILE is there; its words
# go to the file $words.
stop() {
  local signal=$1 code=$2 file=$3 got
  shift 3
  "$@" 2> "$words" &
  local process=$!
  until grep -q '^gi-' /proc/$process/comm 2> /dev/null; do kill -0 $process || break; done
  [ "$signal" = KILL ] || until hears $process 2> /dev/null; do kill -0 $process || break; done
  until compgen -G "$file" > /dev/null || ! kill -0 $process 2> /dev/null; do sleep 0.02; done
  kill "-$signal" $process
  wait $process 2> /dev/null
  got=$?
  [ $got -eq "$code" ] || fail "$* : exit code $got instead of $code after SIG$signal: $(cat "$words")"
}
# said TEXT: in the words of the command that was stopped.
said() { grep -qF -- "$1" "$words" || fail "no \"$1\" in: $(cat "$words")"; }
# trim DIR: drops frames beyond those of the reference.
trim() {
  local file number
  for file in "$1"/*.exr; do
    number=${file%.exr}
    [ $((10#${number##*.})) -lt $frames ] || rm "$file"
  done
}

"${run[@]}" --frames $frames -o reference || fail "the reference"

limited() { (ulimit -f 4 && exec "$@"); }
draw=("$render" --gltf plane.gltf --dumps reference --size 200x100 --samples 1)

# Killed, stopped, and gone on with: the same files in the end.
gone_on() {
  local words=words-gone-on
  stop KILL 137 out/vis.0001.exr "${run[@]}" --frames 1000 -o out
  trim out
  stop TERM 143 out/vis.0003.exr "${run[@]}" --frames 1000 --resume -o out
  said "of 1000 frames, whole; the same command with --resume"
  trim out
  find out -name '.*.exr.*' -delete # of the killed process
  expect 3 "trace.json" "${run[@]}" --seed 2 --frames $frames --resume -o out
  expect 0 "" "${run[@]}" --frames $frames --resume -o out
  diff -r reference out || fail "a trace that was gone on with is not what one trace gives"
}

# --overwrite leaves the former results until all is traced.
overwritten() {
  local words=words-overwritten
  cp -r reference former
  stop INT 130 'former/.gi-trace.*/vis.0001.exr' "${run[@]}" --seed 2 --frames 1000 --overwrite -o former
  said "former is as it was"
  diff -r reference former || fail "an interrupted --overwrite changed former results"
  stop KILL 137 'former/.gi-trace.*/vis.0001.exr' "${run[@]}" --seed 2 --frames 1000 --overwrite -o former
  rm -r former/.gi-trace.*
  diff -r reference former || fail "a killed --overwrite changed former results"

  # Files must not grow: nothing is left, or what was there.
  expect 4 "File too large" limited "${run[@]}" --frames 2 -o limited
  absent limited
  expect 4 "File too large" limited "${run[@]}" --frames 2 --overwrite -o former
  diff -r reference former || fail "--overwrite without space changed former results"
}

photons() {
  local photons
  photons=("$trace" --scene tomb --kind photons --set photons=64 --set max-batches=4 --frames 60 -o photons.gic)
  expect 4 "of 60 frames, for --allow-incomplete" limited "${photons[@]}"
  absent photons.gic
  expect 0 "" "$render" --stream photons.gic.partial --allow-incomplete --size 16x9 -o part.png
  expect 4 "left over" "${photons[@]}"
}

drawn() {
  local words=words-drawn
  echo former > kept.exr
  expect 4 "File too large" limited "${draw[@]}" --overwrite -o kept.exr
  ln -s /dev/full full.png
  expect 4 "No space left" "${draw[@]}" -o full.png
  stop TERM 143 . "$render" --gltf plane.gltf --dumps reference --size 9000x9000 --samples 16 --overwrite -o kept.exr
  stop KILL 137 . "$render" --gltf plane.gltf --dumps reference --size 9000x9000 --samples 16 --overwrite -o kept.exr
  [ "$(cat kept.exr)" = former ] || fail "a picture that failed replaced another"
}

# A disk that fills up while tracing: whole frames, and a trace that goes on elsewhere.
small_disk() {
  unshare -rm sh -c 'mkdir disk && mount -t tmpfs -o size=160k tmpfs disk && "$@" -o disk/out
    code=$?; cp -r disk/out full; ls -A disk/out > listing; exit $code' sh "$@"
}
full_disk() {
  if unshare -rm true 2> /dev/null; then
    expect 4 "No space left" small_disk "${run[@]}" --frames $frames
    ! grep '^\.' listing || fail "temporary files on a full disk"
    ls full/vis.0000.exr > /dev/null || fail "a full disk holds no frame"
    [ "$(find full -name 'color.*' | wc -l)" -eq "$(find full -name 'vis.*' | wc -l)" ] ||
      fail "half a frame on a full disk"
    expect 0 "" "${run[@]}" --frames $frames --resume -o full
    diff -r reference full || fail "a trace that went on after a full disk differs"
  else
    echo "skipped: a full disk needs mount namespaces"
  fi
}

for part in gone_on drawn overwritten photons full_disk; do beside $part $part; done
together
no_hidden .

# A folder that cannot be written.
as=()
[ "$(id -u)" -ne 0 ] || as=(setpriv --reuid=65534 --regid=65534 --clear-groups)
chmod 755 . && chmod -R a+rX,a-w reference
if "${as[@]}" test -x "$trace" && ! "${as[@]}" test -w reference; then
  expect 4 "Permission denied" "${as[@]}" "${run[@]}" --overwrite -o reference
  expect 4 "Permission denied" "${as[@]}" "${run[@]}" -o reference/new
  expect 4 "Permission denied" "${as[@]}" "${draw[@]}" -o reference/a.png
else
  echo "skipped: a folder that cannot be written needs another user"
fi
chmod -R u+w reference
diff -r reference out || fail "what cannot be written changed"
end
