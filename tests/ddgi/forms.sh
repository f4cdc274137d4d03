#!/usr/bin/env bash
# Textures of gi-trace in the formats of engines: flags, dumps that keep every bit on their way
# through a container, and what a client draws from them.
set -uo pipefail
trace=$1 render=$2 gicodec=$3
here=$(cd "$(dirname "$0")" && pwd)
. "$here/support.sh"
python3 "$here/../../tools/train/make_room.py" 2 room.gltf || exit

expect 2 "does not begin with color= or vis=" "$trace" "${tiny[@]}" --vk-format R16_UNORM -o a
expect 2 "vis cannot be R16_UNORM; there are R16G16_SFLOAT" \
  "$trace" "${tiny[@]}" --vk-format vis=R16_UNORM -o a
expect 2 "color cannot be none" "$trace" "${tiny[@]}" --vk-format color=none -o a
expect 2 "2 to 64" "$trace" "${tiny[@]}" --core color=1 -o a
expect 2 "2 to 64" "$trace" "${tiny[@]}" --core vis=16x -o a
expect 2 "--sh" "$trace" "${tiny[@]}" --sh l3 -o a
expect 2 "--rotation" "$trace" "${tiny[@]}" --rotation some -o a
expect 2 "--clamp" "$trace" "${tiny[@]}" --clamp 0 -o a
expect 2 '--clamp: "nan" is no number' "$trace" "${tiny[@]}" --clamp nan -o a
expect 2 '--fps: "NAN" is no number' "$trace" "${tiny[@]}" --fps NAN -o a
absent a

# A room with lamps that move.
of_room=(--gltf room.gltf --grid 4x3x3 --rays 32 --frames 2)
small=(--gltf room.gltf --size 32x24 --samples 1)
# round_trip NAME: a folder goes into a container and comes out as it was.
round_trip() {
  expect 0 "" "$gicodec" encode -q --backend zstd -o "$1.gic" "$1"
  expect 0 "files in 2 frames are bit-exact" "$gicodec" verify "$1.gic" "$1"
  expect 0 "" "$gicodec" decode -q "$1.gic" -o "$1-back"
  local file
  for file in "$1"/*.exr; do
    expect 0 "" "$gicodec" compare "$file" "$1-back/$(basename "$file")"
  done
}
drawn() {
  local format=$1
  expect 0 "" "$trace" -q "${of_room[@]}" --vk-format color=$format --vk-format vis=R32G32_SFLOAT \
    --core color=6 --core vis=14 -o $format
  round_trip $format
  expect 0 "" "$render" --dumps $format "${small[@]}" --mode gi -o $format.exr
  expect 0 "0 of 768 pixels differ" "$render" --stream $format.gic --dumps $format "${small[@]}" --compare
}
for format in A2B10G10R10_UNORM_PACK32 R8G8B8A8_UNORM R16G16B16A16_SFLOAT R32G32B32A32_SFLOAT \
  B10G11R11_UFLOAT_PACK32 E5B9G9R9_UFLOAT_PACK32; do
  beside $format drawn $format
done
# traced NAME OPTIONS...
traced() {
  local name=$1
  shift
  expect 0 "" "$trace" -q "${of_room[@]}" "$@" -o "$name"
  round_trip "$name"
}
for form in l1 l2 l1-over-l0; do beside $form traced $form --sh $form; done

# Engines' layouts: dumps where each texture is one, else a container.
expect 2 "unknown is not known; there are paper, g3d" "$trace" "${tiny[@]}" --layout unknown -o a
for flag in "--vk-format color=R8G8B8A8_UNORM" "--core vis=14" "--sh l1"; do
  # shellcheck disable=SC2086
  expect 2 "--layout says what textures there are" "$trace" "${tiny[@]}" --layout flax $flag -o a
done
expect 2 "more than 262144" "$trace" --gltf plane.gltf --grid 63x64x65 --layout unity-apv -o a
for layout in paper g3d rtxgi rtxgi-float16 rtxgi-float32 rtxgi-z-up o3de flax; do
  beside $layout traced $layout --layout $layout
done
# contained LAYOUT: what is no layout of probes becomes a container.
contained() {
  expect 0 "" "$trace" -q "${of_room[@]}" --layout $1 -o $1
  expect 0 "volume $1: textures" "$gicodec" info $1/$1.gic
  expect 0 "2 frames are sound" "$gicodec" verify $1/$1.gic
}
for layout in unity-apv unity-apv-l1 unreal-vlm bevy godot; do beside $layout contained $layout; done
together
absent a
[ -s l2/shc.0001.exr ] || fail "l2/shc.0001.exr is missing"
[ -s l1-over-l0/l1g_l1ry.0000.exr ] || fail "l1-over-l0/l1g_l1ry.0000.exr is missing"
for layout in rtxgi rtxgi-z-up; do
  expect 0 "" "$render" --dumps $layout "${small[@]}" --mode gi -o $layout.exr
done
cmp -s rtxgi.exr rtxgi-z-up.exr || fail "the same probes elsewhere draw another picture"
[ -s rtxgi/ProbeIrradiance.0001.exr ] || fail "rtxgi/ProbeIrradiance.0001.exr is missing"
absent rtxgi/color.0000.exr rtxgi/rtxgi.gic
expect 2 "--resume is not for --layout bevy" "$trace" "${of_room[@]}" --layout bevy --resume -o bevy
expect 0 "" "$trace" -q "${of_room[@]}" --layout rtxgi --resume -o rtxgi
expect 3 "with other options" "$trace" -q "${of_room[@]}" --layout rtxgi-z-up --resume -o rtxgi
expect 0 "" "$trace" -q "${tiny[@]}" --frames 1 --overwrite -o bevy
expect 0 "" "$trace" -q "${tiny[@]}" --frames 1 --overwrite -o rtxgi
absent bevy/bevy.gic rtxgi/ProbeData.0000.exr

# Encodings other than the usual one: the attribute says so, and the picture is nearly the same.
expect 0 "" "$trace" -q "${of_room[@]}" --vk-format color=R32G32B32A32_SFLOAT --encoding gamma5 -o root
round_trip root
expect 0 "gamma5" "$gicodec" info root.gic --format json
expect 0 "" "$trace" -q "${of_room[@]}" --vk-format color=R32G32B32A32_SFLOAT -o linear
"$render" --dumps root "${small[@]}" --mode gi -o root.png && "$render" --dumps linear "${small[@]}" \
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

# Frames that are there already are kept, with all of their textures, whatever the rays do.
turning=(--gltf room.gltf --grid 4x3x3 --rays 32 --rotation turning --frames 3)
expect 0 "" "$trace" -q "${turning[@]}" --sh l1 -o whole
expect 0 "" "$trace" -q "${turning[@]}" --sh l1 -o part
rm part/vis.0001.exr part/sha_g.0002.exr
expect 0 "" "$trace" -q "${turning[@]}" --sh l1 --resume -o part
for file in whole/*.exr; do
  cmp -s "$file" "part/$(basename "$file")" || fail "part/$(basename "$file") is another"
done
expect 3 "with other options" "$trace" -q "${turning[@]}" --sh l1 --clamp 2 --resume -o part
expect 3 "with other options" "$trace" -q "${turning[@]}" --sh l2 --resume -o part
expect 0 "" "$trace" -q "${tiny[@]}" --frames 1 --overwrite -o part
absent part/sha_r.0000.exr part/vis.0001.exr
end
