#!/usr/bin/env bash
# Textures of gi-trace in the formats of engines: flags, dumps that keep every bit on their way
# through a container, and what a client draws from them.
set -uo pipefail
trace=$1 render=$2 gicodec=$3
. "$(dirname "$0")/support.sh"

expect 2 "does not begin with color= or vis=" "$trace" "${tiny[@]}" --vk-format R16_UNORM -o a
expect 2 "vis cannot be R16_UNORM; there are R16G16_SFLOAT" \
  "$trace" "${tiny[@]}" --vk-format vis=R16_UNORM -o a
expect 2 "color cannot be none" "$trace" "${tiny[@]}" --vk-format color=none -o a
expect 2 "2 to 64" "$trace" "${tiny[@]}" --core color=1 -o a
expect 2 "2 to 64" "$trace" "${tiny[@]}" --core vis=16x -o a
expect 2 "--sh" "$trace" "${tiny[@]}" --sh l3 -o a
expect 2 "--rotation" "$trace" "${tiny[@]}" --rotation some -o a
expect 2 "--clamp" "$trace" "${tiny[@]}" --clamp 0 -o a
expect 2 '--clamp: expected a number' "$trace" "${tiny[@]}" --clamp nan -o a
expect 2 '--fps: "NAN" is no number' "$trace" "${tiny[@]}" --fps NAN -o a
expect 2 "--set is for other kinds than probes" "$trace" "${tiny[@]}" --set rays=5 -o a
absent a

of_villa=(--scene villa --grid 4x3x3 --rays 32 --frames 2)
small=(--size 32x24 --samples 1)
# traced NAME OPTIONS...: NAME.gic, and its dumps in the folder NAME, which make a container of the
# same files.
traced() {
  local name=$1 file
  shift
  expect 0 "" "$trace" -q "${of_villa[@]}" "$@" -o "$name.gic"
  expect 0 "" "$gicodec" decode -q "$name.gic" -o "$name"
  expect 0 "files in 2 frames are bit-exact" "$gicodec" verify "$name.gic" "$name"
  expect 0 "" "$gicodec" encode -q --backend zstd -o "$name-again.gic" "$name"
  expect 0 "" "$gicodec" decode -q "$name-again.gic" -o "$name-back"
  for file in "$name"/*.exr; do
    cmp -s "$file" "$name-back/$(basename "$file")" || fail "$name-back/$(basename "$file") is another"
  done
}
formats=(A2B10G10R10_UNORM_PACK32 R16G16B16A16_SFLOAT E5B9G9R9_UFLOAT_PACK32)
[ -z "${GICODEC_TEST_EVERYTHING:-}" ] ||
  formats+=(R8G8B8A8_UNORM R32G32B32A32_SFLOAT B10G11R11_UFLOAT_PACK32)
for format in "${formats[@]}"; do
  traced $format --vk-format color=$format --vk-format vis=R32G32_SFLOAT --core color=6 --core vis=14
  expect 0 "" "$render" --dumps $format "${small[@]}" --mode gi -o $format.exr
  expect 0 "0 of 768 pixels differ" "$render" --stream $format.gic --dumps $format "${small[@]}" --compare
done
for form in l1 l2 l1-over-l0; do traced $form --sh $form; done
[ -s l2/shc.0001.exr ] || fail "l2/shc.0001.exr is missing"
[ -s l1-over-l0/l1g_l1ry.0000.exr ] || fail "l1-over-l0/l1g_l1ry.0000.exr is missing"

# Engines' layouts.
expect 2 "unknown is not known; there are paper, g3d" "$trace" "${tiny[@]}" --layout unknown -o a
for flag in "--vk-format color=R8G8B8A8_UNORM" "--core vis=14" "--sh l1"; do
  # shellcheck disable=SC2086
  expect 2 "--layout says what textures there are" "$trace" "${tiny[@]}" --layout flax $flag -o a
done
expect 2 "more than 262144" "$trace" --gltf plane.gltf --grid 63x64x65 --layout unity-apv -o a
absent a
for layout in rtxgi rtxgi-z-up; do
  traced $layout --layout $layout
  expect 0 "" "$render" --dumps $layout "${small[@]}" --mode gi -o $layout.exr
done
cmp -s rtxgi.exr rtxgi-z-up.exr || fail "the same probes elsewhere draw another picture"
[ "$(cd rtxgi && echo *.0001.exr)" = "ProbeData.0001.exr ProbeDistance.0001.exr ProbeIrradiance.0001.exr" ] ||
  fail "rtxgi has other textures: $(ls rtxgi)"

# Encodings other than the usual one: the attribute says so, and the picture is nearly the same.
traced root --vk-format color=R32G32B32A32_SFLOAT --encoding gamma5
expect 0 "gamma5" "$gicodec" info root.gic --format json
traced linear --vk-format color=R32G32B32A32_SFLOAT
"$render" --stream root.gic "${small[@]}" --mode gi -o root.png && "$render" --dumps linear "${small[@]}" \
  --mode gi -o linear.png
python3 - <<'EOF' || fail "linear light and its root draw different pictures"
import struct, sys, zlib
def pixels(name):
    data, at, packed = open(name, "rb").read(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += size + 12
    return zlib.decompress(packed)
a, b = pixels("root.png"), pixels("linear.png")
# Rows may be filtered: only nearly equal rows are nearly equal bytes, modulo 256.
apart = [min((x - y) % 256, (y - x) % 256) for x, y in zip(a, b)]
sys.exit(len(a) != len(b) or max(a) == 0 or sum(apart) > 3 * len(apart))
EOF
end
