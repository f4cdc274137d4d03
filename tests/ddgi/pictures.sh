#!/usr/bin/env bash
# The picture from a decoded stream equals the picture from the original textures, for each lossless
# backend of this build; other pictures are noticed, and lossy colour is measured. Backends take
# turns at the scenes; with `all`, each backend draws each scene.
#   tests/ddgi/pictures.sh BUILD_FOLDER [all]
set -uo pipefail
build=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit
gicodec=$build/tools/gicodec/gicodec render=$build/tools/programs/gi-render
small=(--size 48x27 --samples 1)
work=$(mktemp -d)
trap 'wait; rm -rf "$work"' EXIT
rows=0
# Of rows too, which are beside each other.
fail() { echo "FAILED: $*" && echo "$*" >> "$work/failures"; }

if [ "${2:-}" = all ]; then
  script/compare-renders "$build" testdata/{tomb-converged,villa-noisy,street-converged} \
    -- "${small[@]}" || fail "a lossless stream changed the picture"
  [ ! -e "$work/failures" ]
  exit
fi

# row CODE TEXT STREAM-OF DUMPS ENCODE-OPTIONS...: a comparison ends with CODE and says TEXT.
row() {
  while [ "$(jobs -pr | wc -l)" -ge "$(nproc)" ]; do wait -n; done
  rows=$((rows + 1))
  compare_row $rows "$@" &
}
compare_row() {
  local stream=$work/$1.gic
  shift
  local code=$1 text=$2 of=testdata/$3 dumps=testdata/$4 output got
  shift 4
  "$gicodec" encode -q -o "$stream" "$@" "$of" || fail "encode $* $of"
  output=$("$render" --stream "$stream" --dumps "$dumps" --frame 7 --compare "${small[@]}" 2>&1)
  got=$?
  echo "$of $*: $output"
  if [ $got -ne "$code" ] || [[ "$output" != *$text* ]]; then fail "exit code $got"; fi
}
# lossless ENCODE-OPTIONS...: at the next scene.
scenes=(tomb-converged villa-noisy street-converged)
turn=0
lossless() {
  local scene=${scenes[turn++ % 3]}
  row 0 "0 of 1296 pixels differ" "$scene" "$scene" "$@"
}

list=$("$gicodec" backends)
for backend in raw lz4 zstd native; do
  grep -q "^$backend" <<< "$list" && lossless --backend $backend
done
if grep -q '^hevc' <<< "$list"; then
  lossless --backend hevc
  lossless --backend hevc --hevc-packing planes
  row 1 "PSNR " tomb-converged tomb-converged --backend hevc --lossy qp=20
  row 1 "coded LOSSY (qp=20)" tomb-converged tomb-converged --backend hevc --lossy qp=20
fi
# Two sequences of the same volume.
row 1 "PSNR " villa-noisy villa-converged
wait
[ ! -e "$work/failures" ]
