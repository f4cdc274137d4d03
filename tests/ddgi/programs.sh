#!/usr/bin/env bash
# Exit codes and messages of gi-trace and gi-render, from one built-in scene and a glTF file of
# one triangle.
set -uo pipefail
trace=$1 render=$2 gicodec=$3
. "$(dirname "$0")/support.sh"

# A scene that no light reaches, and one with a lamp in front of the triangle.
black='"sky":{"zenith":[0,0,0],"horizon":[0,0,0],"ground":[0,0,0],"sun_direction":[0,1,0],"glow":[0,0,0]}'
sed "s/\"scenes\":\[{/&\"extras\":{\"gicodec\":{$black}},/" plane.gltf > night.gltf
lamp='"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":9}]}},'
sed "s/^{/&$lamp/; s/\"nodes\":\[{\"mesh\":0}\]/\"nodes\":[{\"mesh\":0},{\"translation\":[0.3,0.3,1],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}]/; s/\"nodes\":\[0\]/\"nodes\":[0,1]/" \
  night.gltf > lamp.gltf

expect 0 "villa" "$trace" --list-scenes
expect 0 "Exit codes" "$trace" --help
expect 2 "unknown scene atrium" "$trace" --scene atrium -o a
expect 2 "--scene or --gltf" "$trace" -o a
expect 2 "-o FILE.gic" "$trace" --gltf plane.gltf
expect 2 "--frames" "$trace" --gltf plane.gltf --frames 0 -o a
expect 2 "--grid" "$trace" --gltf plane.gltf --grid 0x4x4 -o a
expect 2 "--mode" "$trace" --gltf plane.gltf --mode some -o a
expect 2 "one of the inputs" "$trace" --gltf plane.gltf --export-gltf plane.gltf
# The scene's buffer bears the name of an export and of a container in turn.
mkdir parts
printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0' > parts/triangle
for name in scene.glb light.gic; do
  cp parts/triangle "parts/$name"
  sed "s|data:[^\"]*|$name|" plane.gltf > parts/parts.gltf
  if [ $name = scene.glb ]; then
    expect 2 "one of the inputs" "$trace" --gltf parts/parts.gltf --overwrite --export-gltf parts/$name
  else
    expect 2 "one of the inputs" "$trace" --gltf parts/parts.gltf --overwrite -o parts/$name
  fi
  cmp parts/triangle "parts/$name" || fail "a buffer of the scene was overwritten"
done
expect 4 "nowhere" "$trace" --gltf plane.gltf --frames 1 --export-gltf nowhere/a.glb
expect 3 "needs the extension" "$trace" --gltf needs.gltf -o a
expect 4 "file" "$trace" "${tiny[@]}" --frames 1 -o file/a
absent a

expect 0 "2 frames" "$trace" --scene tomb --grid 3x3x3 --rays 16 --frames 2 -o tomb.gic
expect 4 "--overwrite replaces" "$trace" "${tiny[@]}" --frames 1 -o tomb.gic
echo "a user's own" > own.gic
expect 4 "own.gic" "$trace" "${tiny[@]}" --frames 1 --overwrite -o own.gic
[ "$(cat own.gic)" = "a user's own" ] || fail "--overwrite replaced what is no container"
cp tomb.gic over.gic
expect 0 "" "$trace" -q "${tiny[@]}" --frames 1 --overwrite -o over.gic
expect 0 "1 frame " "$gicodec" info over.gic
expect 0 "stand inside of solids" "$trace" "${tiny[@]}" --frames 1 \
  --bounds 0.2,0.2,-0.002,0.3,0.3,-0.001 -o behind.gic
expect 0 "no light reaches a probe" "$trace" --gltf night.gltf --rays 8 --frames 1 -o night.gic
expect 0 "" "$trace" -q "${tiny[@]}" --frames 2 -o plane.gic
expect 0 "" "$gicodec" decode -q plane.gic -o plane
expect 0 "" "$gicodec" encode -q -o color.gic plane/color.0000.exr

# A name that is no UTF-8 stands in attributes as escapes.
cp plane.gltf $'caf\xe9.gltf'
expect 0 "" "$trace" -q --gltf $'caf\xe9.gltf' --grid 3x3x3 --rays 16 --frames 1 -o cafe.gic
expect 0 'scene caf\xe9.gltf' "$gicodec" info cafe.gic
expect 0 "" "$gicodec" decode -q cafe.gic -o cafe
expect 0 "" "$render" --gltf $'caf\xe9.gltf' --dumps cafe --size 32x24 --samples 1 -o cafe.png

of_plane=(--gltf plane.gltf --stream plane.gic)
small=(--size 32x24 --samples 1)
expect 2 "--stream or --dumps" "$render" --gltf plane.gltf -o a.png
expect 2 "-o FILE" "$render" "${of_plane[@]}"
expect 2 "--compare needs" "$render" "${of_plane[@]}" --compare
expect 2 ".png or .exr" "$render" "${of_plane[@]}" -o a.jpg
expect 2 "--size" "$render" "${of_plane[@]}" --size 0x10 -o a.png
expect 2 "--camera" "$render" "${of_plane[@]}" --camera 1,2,3 -o a.png
expect 2 "plane.gltf, which is no built-in scene; name that file by --gltf FILE" \
  "$render" --stream plane.gic -o a.png
expect 3 "in plane.gltf, not in villa; name that file by --gltf FILE" \
  "$render" --scene villa --stream plane.gic -o a.png
expect 3 "not in plane.gltf; leave out" "$render" --gltf plane.gltf --stream tomb.gic -o a.png
expect 2 '--frame does not take "-1"' "$render" "${of_plane[@]}" --frame -1 -o a.png
expect 3 "has no frame 7" "$render" "${of_plane[@]}" --frame 7 -o a.png
expect 3 "has no frame 7" "$render" --gltf plane.gltf --dumps plane --frame 7 -o a.png
expect 3 "visibility" "$render" --gltf plane.gltf --stream color.gic -o a.png
expect 3 "leave out --grid" "$render" "${of_plane[@]}" --grid 4x4x4 -o a.png
expect 3 "leave out --bounds" "$render" "${of_plane[@]}" --bounds 900,900,900,901,901,901 -o a.png
expect 3 "" "$render" --gltf plane.gltf --stream needs.gltf -o a.png
expect 4 "missing" "$render" --gltf plane.gltf --stream missing.gic -o a.png
head -c 300 plane.gic > cut.gic
expect 3 "" "$render" --gltf plane.gltf --stream cut.gic -o a.png
# Without its last byte every frame is there, and yet the end is missing.
head -c -1 plane.gic > cut.gic
expect 3 "cut.gic: its end is missing (cut off, or still being written): it holds frames 0-1;" \
  "$render" --gltf plane.gltf --stream cut.gic "${small[@]}" -o a.png
absent a.png
expect 0 "its end is missing" "$render" --gltf plane.gltf --stream cut.gic "${small[@]}" \
  --allow-incomplete -o cut.png
# Colour of a frame whose visibility is damaged or cut off is not drawn with that of the frame before.
whole=$(stat -c %s plane.gic)
for ((at = whole - 8; at > 0; at -= 3)); do
  cp plane.gic dam.gic
  printf XXXX | dd of=dam.gic bs=1 seek=$at conv=notrunc status=none
  rm -rf half && "$gicodec" decode -q dam.gic -o half 2> words
  [ -e half/color.0001.exr ] && [ ! -e half/vis.0001.exr ] && break
done
head -c $at plane.gic > cut.gic
for stream in "dam.gic" "dam.gic --allow-incomplete" "cut.gic --allow-incomplete"; do
  # shellcheck disable=SC2086
  expect 3 "${stream%% *}: frame 1 is not whole: " "$render" --gltf plane.gltf --stream $stream --frame 1 "${small[@]}" -o a.png
  # shellcheck disable=SC2086
  expect 0 "" "$render" --gltf plane.gltf --stream $stream --frame 0 "${small[@]}" --overwrite -o cut.png
done
absent a.png
expect 2 "one of the inputs" "$render" --gltf plane.gltf --dumps plane "${small[@]}" --overwrite \
  -o plane/vis.0000.exr
expect 4 "nowhere" "$render" "${of_plane[@]}" "${small[@]}" -o nowhere/a.png
for mode in full direct gi; do
  expect 0 "" "$render" "${of_plane[@]}" --mode $mode "${small[@]}" -o "$mode.png"
done
expect 4 "--overwrite" "$render" "${of_plane[@]}" "${small[@]}" -o full.png
expect 0 "" "$render" "${of_plane[@]}" "${small[@]}" --overwrite -o full.png
if cmp -s full.png gi.png; then fail "modes draw the same"; fi
expect 0 "" "$render" --stream tomb.gic "${small[@]}" -o tomb.exr
expect 0 "sees lit surfaces" "$render" --gltf lamp.gltf --mode direct "${small[@]}" \
  --camera 0,0,-3,0,0,0 -o dark.png
expect 0 "give the scene lights" "$render" --gltf night.gltf --mode direct "${small[@]}" -o night.png
end
