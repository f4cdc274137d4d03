#!/usr/bin/env bash
# Exit codes and messages of ddgi-trace and ddgi-render, and that failures leave no files behind.
set -uo pipefail
trace=$1 render=$2 gicodec=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit
failures=0

# expect CODE TEXT COMMAND...: the command ends with CODE and its message contains TEXT.
expect() {
  local code=$1 text=$2
  shift 2
  local output
  output=$("$@" 2>&1)
  local got=$?
  if [ "$got" -ne "$code" ] || [[ "$output" != *"$text"* ]]; then
    echo "FAILED: $* : exit code $got instead of $code, or no \"$text\" in: $output"
    failures=$((failures + 1))
  fi
}
# absent PATH: nothing was left there.
absent() {
  if [ -e "$1" ]; then
    echo "FAILED: $1 was left behind"
    failures=$((failures + 1))
  fi
}

expect 0 "villa" "$trace" --list-scenes
expect 0 "Exit codes" "$trace" --help
expect 2 "unknown scene atrium" "$trace" --scene atrium -o a
absent a
expect 2 "--scene or --gltf" "$trace" -o a
expect 4 "nowhere" "$trace" --scene tomb --frames 2 --export-gltf nowhere/a.glb
expect 2 "-o DIR" "$trace" --scene tomb
expect 2 "--grid" "$trace" --scene tomb --grid 0x4x4 -o a
expect 2 "--grid" "$trace" --scene tomb --grid 4000x400x400 -o a
expect 2 "--bounds" "$trace" --scene tomb --bounds 0,0,0,1,1,nan -o a
expect 2 "--bounds" "$trace" --scene tomb --bounds 0,0,0,1,-1,1 -o a
expect 2 "--frames" "$trace" --scene tomb --frames 0 -o a
expect 4 "missing.glb" "$trace" --gltf missing.glb -o a
echo "no glTF" > bad.glb
expect 3 "bad.glb" "$trace" --gltf bad.glb -o a
truncate -s 2G huge.glb
expect 3 "larger than" "$trace" --gltf huge.glb -o a
absent a
touch file
expect 4 "file" "$trace" --scene tomb --grid 2x2x2 --rays 8 --frames 1 -o file/a

expect 0 "2 frames" "$trace" --scene tomb --grid 3x3x3 --rays 16 --frames 2 --view-samples 50 -o tomb
for name in color.0000.exr vis.0001.exr positions.csv inactive.txt camera.json views.jsonl; do
  [ -s "tomb/$name" ] || { echo "FAILED: tomb/$name is missing"; failures=$((failures + 1)); }
done
expect 4 "already holds dumps" "$trace" --scene tomb --grid 3x3x3 --rays 16 --frames 1 -o tomb
expect 0 "" "$trace" -q --scene tomb --grid 3x3x3 --rays 16 --frames 1 --overwrite -o tomb
absent tomb/color.0001.exr
absent tomb/.new

# Killed at work, it leaves the former files as they are.
cp -r tomb before
"$trace" -q --scene tomb --grid 3x3x3 --rays 16 --frames 100000 --overwrite -o tomb &
process=$!
for _ in $(seq 3000); do
  [ -s tomb/.new/vis.0002.exr ] && break
  sleep 0.01
done
kill -9 "$process"
wait "$process" 2>/dev/null
[ -s tomb/.new/vis.0002.exr ] || { echo "FAILED: no frames while tracing"; failures=$((failures + 1)); }
expect 0 "" diff -r --exclude=.new before tomb
expect 0 "" "$trace" -q --scene tomb --grid 3x3x3 --rays 16 --frames 1 --overwrite -o tomb
absent tomb/.new
# A full disk: former files stay, nothing is left over.
limited() { (ulimit -f 1; exec "$@"); }
cp -r tomb before2
expect 4 "too large" limited "$trace" -q --scene tomb --grid 3x3x3 --rays 32 --frames 2 --overwrite -o tomb
expect 0 "" diff -r before2 tomb
# What belongs to dumps is not replaced either unless it is said so.
mkdir other && echo "a user's own" > other/camera.json
expect 4 "camera.json" "$trace" --scene tomb --grid 3x3x3 --rays 16 --frames 1 -o other
expect 0 "own" cat other/camera.json
expect 0 "" "$trace" -q --scene villa --grid 3x3x3 --rays 16 --frames 1 -o villa
expect 0 "" "$trace" -q --scene tomb --frames 3 --export-gltf tomb.glb
expect 4 "--overwrite" "$trace" -q --scene tomb --frames 3 --export-gltf tomb.glb
expect 2 "one of the inputs" "$trace" -q --gltf tomb.glb --frames 3 --overwrite --export-gltf tomb.glb
expect 0 "" "$trace" -q --gltf tomb.glb --grid 3x3x3 --rays 16 --frames 2 -o gltf
expect 0 "" "$gicodec" encode -q -o tomb.gic tomb
expect 0 "" "$gicodec" encode -q -o color.gic tomb/color.0000.exr

small="--size 32x24 --samples 1"
expect 2 "--stream or --dumps" "$render" --scene tomb -o a.png
expect 2 "-o FILE" "$render" --scene tomb --stream tomb.gic
expect 2 "--compare needs" "$render" --scene tomb --stream tomb.gic --compare
expect 2 ".png or .exr" "$render" --scene tomb --stream tomb.gic -o a.jpg
expect 2 "--size" "$render" --scene tomb --stream tomb.gic --size 0x10 -o a.png
expect 2 "--camera" "$render" --scene tomb --stream tomb.gic --camera 1,2,3 -o a.png
expect 3 "not in villa" "$render" --scene villa --stream tomb.gic -o a.png
expect 3 "has no frame 7" "$render" --scene tomb --stream tomb.gic --frame 7 -o a.png
expect 3 "has no frame 7" "$render" --scene tomb --dumps tomb --frame 7 -o a.png
expect 3 "visibility" "$render" --scene tomb --stream color.gic -o a.png
expect 3 "grid" "$render" --scene tomb --grid 4x4x4 --stream tomb.gic -o a.png
expect 3 "lies outside" "$render" --scene tomb --bounds 900,900,900,901,901,901 --stream tomb.gic -o a.png
expect 3 "" "$render" --scene tomb --stream bad.glb -o a.png
expect 4 "missing" "$render" --scene tomb --stream missing.gic -o a.png
head -c 300 tomb.gic > cut.gic
expect 3 "" "$render" --scene tomb --stream cut.gic -o a.png
# Without its last byte every frame is there, and yet the end is missing.
head -c -1 tomb.gic > cut.gic
expect 3 "cut.gic: its end is missing: it holds frames 0-0 of frames 0-0" \
  "$render" --scene tomb --stream cut.gic $small -o a.png
absent a.png
expect 0 "its end is missing" "$render" --scene tomb --stream cut.gic $small --allow-incomplete -o cut.png
expect 2 "one of the inputs" "$render" --dumps tomb $small --overwrite -o tomb/vis.0000.exr
expect 4 "nowhere" "$render" --scene tomb --stream tomb.gic $small -o nowhere/a.png
for mode in full direct gi; do
  expect 0 "" "$render" --stream tomb.gic --mode $mode $small -o "$mode.png"
done
expect 4 "--overwrite" "$render" --stream tomb.gic $small -o full.png
expect 0 "" "$render" --stream tomb.gic $small --overwrite -o full.png
expect 0 "" "$render" --stream tomb.gic $small --camera 0,5,10,0,4,0,70 --exposure 2 -o a.exr
expect 0 "" "$render" --gltf tomb.glb --dumps gltf --frame 1 $small -o gltf.png
if cmp -s full.png gi.png; then echo "FAILED: modes draw the same"; failures=$((failures + 1)); fi
[ "$failures" -eq 0 ] && echo "all as expected"
exit $((failures > 0))
