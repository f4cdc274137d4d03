#!/usr/bin/env bash
# Every kind of file that what gi-trace writes becomes: of each layout, and of the tracer's own
# textures; what they come to on their way through a container, and what a client draws from them.
set -uo pipefail
trace=$1 render=$2 gicodec=$3
. "$(dirname "$0")/support.sh"

scene=(--gltf plane.gltf)
of_plane=(-q "${scene[@]}" --grid 5x3x4 --rays 8)
small=(-q --size 32x24 --samples 1)

# Layouts: the same texels behind other heads, which the next container takes by the layout's name.
while read -r layout grid; do
  said=$("$trace" "${of_plane[@]:1}" --frames 1 --layout "$layout" -o "$layout.gic" 2>&1)
  [[ $said == *"--layout $layout --grid $grid"* ]] || fail "$layout: not told that its grid is $grid: $said"
  for kind in exr dds ktx2 raw; do
    if [ "$layout $kind" = "paper dds" ]; then
      expect 3 "texture color is of format A2R10G10B10_UNORM_PACK32, which dds files cannot have; --files takes exr, ktx2, raw" \
        "$gicodec" decode -q paper.gic --files dds -o paper-dds
      absent paper-dds/color.0000.dds
      continue
    fi
    expect 0 "" "$gicodec" decode -q "$layout.gic" --files $kind -o "$layout-$kind"
  done
  for texels in "$layout-raw"/*.raw; do
    for kind in dds ktx2; do
      [ "$layout $kind" != "paper dds" ] || continue
      file=$layout-$kind/$(basename "$texels" .raw).$kind
      tail -c "$(stat -c %s "$texels")" "$file" | cmp -s - "$texels" || fail "$file has other texels"
    done
  done
  expect 0 "" "$gicodec" encode -q --layout "$layout" --grid "$grid" -o "$layout-raw.gic" "$layout-raw"
  expect 0 "bit-exact" "$gicodec" verify "$layout-raw.gic" "$layout-raw"
  expect 0 "bit-exact" "$gicodec" verify "$layout.gic" "$layout-exr"
done <<'LAYOUTS'
paper 5x3x4
g3d 5x3x4
rtxgi 5x3x4
rtxgi-float16 5x3x4
rtxgi-float32 5x3x4
rtxgi-z-up 5x3x4
o3de 5x3x4
flax 5x3x4
unity-apv 2x1x1
unity-apv-l1 2x1x1
unreal-vlm 1x1x1
bevy 5x3x4
three 5x3x4
three-float32 5x3x4
godot 5x4x3
LAYOUTS
# What the files say of themselves is not read as something else.
expect 3 "gicodec:extent is 5 4 12, but by --layout godot of 5x3x4 texels and layers it is 5 3 16; check --layout and --grid" \
  "$gicodec" encode --layout godot --grid 5x3x4 -o a.gic godot-exr
expect 3 "but by --layout rtxgi of 5x4x3 probes" "$gicodec" encode --layout rtxgi --grid 5x4x3 -o a.gic rtxgi-ktx2
absent a.gic
for layout in rtxgi-z-up flax; do
  expect 0 "" "$render" "${scene[@]}" --stream $layout.gic "${small[@]}" --mode gi -o $layout.exr
  for kind in exr ktx2 raw; do
    expect 0 "" "$render" "${scene[@]}" --dumps $layout-$kind "${small[@]}" --mode gi -o $layout-$kind.exr
    cmp -s $layout.exr $layout-$kind.exr || fail "$layout as $kind draws another picture"
  done
done

# The tracer's own, with an encoding that is not usual, and later than frame 0.
expect 0 "" "$trace" "${of_plane[@]}" --frames 3 --start 2 --fps 5 --vk-format color=R16G16B16A16_SFLOAT \
  --encoding gamma5 --sh l1 -o own.gic
for kind in exr dds ktx2 raw; do
  expect 0 "" "$gicodec" decode -q own.gic --files $kind -o own-$kind
  expect 0 "bit-exact" "$gicodec" verify own.gic own-$kind
done
expect 0 "" "$render" "${scene[@]}" --stream own.gic "${small[@]}" --frame 2 -o own.exr
for kind in exr ktx2 raw; do
  expect 0 "" "$render" "${scene[@]}" --dumps own-$kind "${small[@]}" --frame 2 -o own-$kind.exr
  cmp -s own.exr own-$kind.exr || fail "$kind draws another picture"
  expect 0 "0 of 768 pixels differ" "$render" "${scene[@]}" --stream own.gic --dumps own-$kind --size 32x24 \
    --samples 1 --frame 2 --compare
done
# DDS files say nothing of probes.
expect 3 "its DDS files do not say what they hold" "$render" "${scene[@]}" --dumps own-dds "${small[@]}" -o a.png
absent a.png
end
