#!/usr/bin/env bash
# Every kind of file that gi-trace writes: what each layout comes to on its way through a container,
# what a client draws from it, what --resume and --overwrite do with it, and what is refused.
set -uo pipefail
trace=$1 render=$2 gicodec=$3
. "$(dirname "$0")/support.sh"

scene=(--gltf plane.gltf)
of_plane=(-q "${scene[@]}" --grid 5x3x4 --rays 8)
small=(-q --size 32x24 --samples 1)

# What a kind of file cannot hold is said before anything is traced.
expect 2 "--files dds: texture color is of format A2R10G10B10_UNORM_PACK32, which such files cannot have; exr, ktx2, raw and gic hold it; --vk-format" \
  "$trace" "${of_plane[@]}" --files dds -o a
expect 2 "--files dds: texture color" "$trace" "${of_plane[@]}" --layout paper --files dds -o a
expect 2 "--files" "$trace" "${of_plane[@]}" --files png -o a
expect 2 "--resume is not for --files gic" "$trace" "${of_plane[@]}" --layout rtxgi --files gic --resume -o a
expect 2 "--frames asks for fewer" "$trace" "${of_plane[@]}" --files gic --frames 100000 -o a
absent a

# Layouts: the same texels behind other heads; a container gives the EXR files, but for times of
# textures that are none of probes, which it does not keep.
of_layout() {
  local layout=$1 grid=$2 kind texels file
  for kind in exr dds ktx2 raw; do
    [ "$layout $kind" != "paper dds" ] || continue
    expect 0 "" "$trace" "${of_plane[@]}" --frames 1 --layout "$layout" --files $kind -o "$layout-$kind"
  done
  for texels in "$layout-raw"/*.raw; do
    for kind in dds ktx2; do
      [ "$layout $kind" != "paper dds" ] || continue
      file=$layout-$kind/$(basename "$texels" .raw).$kind
      tail -c "$(stat -c %s "$texels")" "$file" | cmp -s - "$texels" || fail "$file has other texels"
    done
  done
  expect 0 "" "$gicodec" encode -q --layout "$layout" --grid "$grid" -o "$layout.gic" "$layout-raw"
  expect 0 "bit-exact" "$gicodec" verify "$layout.gic" "$layout-raw"
  expect 0 "" "$trace" "${of_plane[@]}" --frames 1 --layout "$layout" --files gic -o "$layout-gic"
  expect 0 "" "$gicodec" decode -q "$layout-gic/$layout.gic" -o "$layout-back"
  expect 0 "bit-exact" "$gicodec" verify "$layout-gic/$layout.gic" "$layout-back"
  case $layout in # whose grids count something else than probes
    unity* | unreal* | bevy | godot) absent "$layout-raw/inactive.txt" ;;
    *) [ -e "$layout-raw/inactive.txt" ] || fail "$layout-raw/inactive.txt is missing" ;;
  esac
  grep -q "\"layout grid\": \"$grid\"" "$layout-raw/trace.json" || fail "$layout-raw/trace.json does not say $grid"
  [ "$(cd "$layout-back" && ls)" = "$(cd "$layout-exr" && ls -- *.exr)" ] || fail "$layout.gic lacks textures"
  case $grid in
    5x3x4)
      [ "$layout" = bevy ] || for file in "$layout-back"/*; do
        cmp -s "$file" "$layout-exr/$(basename "$file")" || fail "$file is another"
      done ;;
  esac
}
while read -r layout grid; do beside $layout of_layout $layout $grid; done <<'LAYOUTS'
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
godot 5x4x3
LAYOUTS
# The tracer's own, with an encoding that is not usual, and later than frame 0.
own=("${of_plane[@]}" --frames 3 --start 2 --fps 5 --vk-format color=R16G16B16A16_SFLOAT
  --encoding gamma5 --sh l1)
for kind in exr dds ktx2 raw gic; do
  beside own-$kind expect 0 "" "$trace" "${own[@]}" --files $kind -o own-$kind
done
together
expect 0 "takes these files by --layout unity-apv --grid 2x1x1" \
  "$trace" "${scene[@]}" --grid 5x3x4 --rays 8 --frames 1 --layout unity-apv --files ktx2 -o said
# What the files say of themselves is not read as something else.
expect 3 "gicodec:extent is 5 4 12, but by --layout godot of 5x3x4 texels and layers it is 5 3 16; check --layout and --grid" \
  "$gicodec" encode --layout godot --grid 5x3x4 -o a.gic godot-exr
expect 3 "but by --layout rtxgi of 5x4x3 probes" "$gicodec" encode --layout rtxgi --grid 5x4x3 -o a.gic rtxgi-ktx2
absent a.gic
draws_alike() {
  local layout=$1 kind
  for kind in exr dds ktx2 raw; do
    expect 0 "" "$render" "${scene[@]}" --dumps $layout-$kind "${small[@]}" --mode gi -o $layout-$kind.exr
    cmp -s $layout-exr.exr $layout-$kind.exr || fail "$layout as $kind draws another picture"
  done
  expect 0 "" "$render" "${scene[@]}" --stream $layout-gic/$layout.gic "${small[@]}" --mode gi -o $layout-gic.exr
  cmp -s $layout-exr.exr $layout-gic.exr || fail "$layout as gic draws another picture"
}
for layout in rtxgi-z-up flax; do beside draws-$layout draws_alike $layout; done
own_files() {
  local file kind
  expect 0 "" "$gicodec" decode -q own-gic/probes.gic -o own-back
  expect 0 "bit-exact" "$gicodec" verify own-gic/probes.gic own-back
  expect 0 "bit-exact" "$gicodec" verify own-gic/probes.gic own-exr
  for file in own-exr/*.exr; do
    cmp -s "$file" "own-back/$(basename "$file")" || fail "own-back/$(basename "$file") is another"
  done
  expect 0 "" "$render" "${scene[@]}" --dumps own-exr "${small[@]}" --frame 2 -o own-exr.exr
  for kind in dds ktx2 raw; do
    expect 0 "" "$render" "${scene[@]}" --dumps own-$kind "${small[@]}" --frame 2 -o own-$kind.exr
    cmp -s own-exr.exr own-$kind.exr || fail "$kind draws another picture"
    expect 0 "0 of 768 pixels differ" "$render" "${scene[@]}" --stream own-gic/probes.gic --dumps own-$kind --size 32x24 \
      --samples 1 --frame 2 --compare
  done
}
beside own own_files

# Frames that are there already are kept; half ones are traced again.
resumed() {
  local kind=$1
  cp -r own-$kind part-$kind
  rm part-$kind/vis.0001.$kind part-$kind/camera.json
  [ $kind != raw ] || rm part-raw/sha_g.0000.json part-raw/color.0002.raw
  expect 3 "with other options" "$trace" "${own[@]}" --resume -o part-$kind
  expect 0 "" "$trace" "${own[@]}" --files $kind --resume -o part-$kind
  diff -r own-$kind part-$kind || fail "a trace as $kind that was gone on with is not what one trace gives"
}
for kind in dds ktx2 raw; do beside part-$kind resumed $kind; done
together

# One kind takes the place of another, whole.
expect 4 "already holds" "$trace" "${tiny[@]}" --files ktx2 --frames 1 -o part-raw
before=raw
for kind in ktx2 gic exr raw; do
  expect 0 "" "$trace" -q "${tiny[@]}" --files $kind --frames 1 --overwrite -o part-raw
  for file in part-raw/*."$before"; do absent "$file"; done
  before=$kind
done
absent part-raw/sha_r.0000.json part-raw/probes.gic
[ -s part-raw/vis.0000.json ] || fail "a raw file has no sidecar"

# A sidecar that is there already is another's.
mkdir foreign
echo '{}' > foreign/color.0000.json
expect 4 "already holds color.0000.json" "$trace" -q "${tiny[@]}" --files raw --frames 1 -o foreign
[ "$(cat foreign/color.0000.json)" = '{}' ] || fail "another's sidecar was replaced"

# DDS files say nothing of probes; trace.json beside them does, which others need not have whole.
cp own-ktx2/trace.json kept
echo '{}' > own-ktx2/trace.json
expect 0 "" "$render" "${scene[@]}" --dumps own-ktx2 "${small[@]}" --overwrite -o own-ktx2.exr
cp kept own-ktx2/trace.json
cp own-dds/trace.json kept
rm own-dds/trace.json
expect 3 "there is no trace.json" "$render" "${scene[@]}" --dumps own-dds "${small[@]}" -o a.png
for damage in 's/"grid": "5/"grid": "6/' 's/"fps": 5.0/"fps": 0/' 's/"scene"/"name"/' 's/^{/[/' 's/"grid": "5x3x4"/"grid": 5/' \
  's/"spacing"/"spaces"/'; do
  sed "$damage" kept > own-dds/trace.json
  cmp -s kept own-dds/trace.json && fail "no damage by $damage"
  expect 3 "own-dds" "$render" "${scene[@]}" --dumps own-dds "${small[@]}" -o a.png
done
absent a.png
end
