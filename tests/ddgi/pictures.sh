#!/usr/bin/env bash
# The picture from a decoded stream equals the picture from the original textures, for each lossless
# backend of this build and each scene; lossy colour is noticed and measured.
set -uo pipefail
trace=$1 render=$2 gicodec=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
failures=0
small="--size 80x45 --samples 1"

backends="raw lz4 zstd"
for other in native hevc; do
  "$gicodec" backends 2>/dev/null | grep -q "^$other" && backends="$backends $other"
done
for scene in tomb villa street; do
  "$trace" -q --scene "$scene" --grid 6x3x6 --rays 64 --start 1 --frames 3 -o "$scene" || exit 1
  for backend in $backends; do
    "$gicodec" encode -q --backend "$backend" -o "$scene.gic" "$scene" &&
      "$render" --scene "$scene" --stream "$scene.gic" --dumps "$scene" --frame 2 --compare $small
    if [ $? -ne 0 ]; then
      echo "FAILED: $scene with $backend"
      failures=$((failures + 1))
    fi
  done
done
# Frame 0 of one sequence against frame 0 of another: the comparison can fail.
"$trace" -q --scene tomb --grid 6x3x6 --rays 64 --start 5 --frames 3 -o later || exit 1
"$render" --scene tomb --stream tomb.gic --dumps later --compare $small
if [ $? -ne 1 ]; then
  echo "FAILED: different pictures were not noticed"
  failures=$((failures + 1))
fi
if [[ "$backends" == *hevc* ]]; then
  "$gicodec" encode -q --backend hevc --lossy qp=20 -o lossy.gic tomb &&
    text=$("$render" --scene tomb --stream lossy.gic --dumps tomb --frame 2 --compare $small)
  if [ $? -ne 1 ] || [[ "$text" != *PSNR* ]]; then
    echo "FAILED: lossy colour: $text"
    failures=$((failures + 1))
  fi
  echo "$text"
fi
exit $((failures > 0))
