#!/usr/bin/env bash
# The picture from a decoded stream equals the picture from the original textures, for each lossless
# backend of this build and each scene; other pictures are noticed, and lossy colour is measured.
#   tests/ddgi/pictures.sh BUILD_FOLDER
set -uo pipefail
build=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit
small="--size 80x45 --samples 1"
stream=$(mktemp --suffix=.gic)
trap 'rm -f "$stream"' EXIT
failures=0
fail() { echo "FAILED: $*" && failures=$((failures + 1)); }

# shellcheck disable=SC2086
table=$(script/compare-renders "$build" testdata/{tomb-converged,villa-noisy,street-converged} \
  -- $small) || fail "a lossless stream changed the picture"
echo "$table"
if grep -q hevc <<<"$table" && ! grep -q 'lossy.*PSNR [0-9]' <<<"$table"; then
  fail "lossy colour was not measured"
fi

# The comparison can fail: two sequences of the same volume.
"$build/tools/gicodec/gicodec" encode -q -o "$stream" testdata/villa-noisy || fail "encode"
# shellcheck disable=SC2086
"$build/tools/ddgi/ddgi-render" --stream "$stream" --dumps testdata/villa-converged --frame 2 \
  --compare $small
[ $? -eq 1 ] || fail "different pictures were not noticed"
exit $((failures > 0))
