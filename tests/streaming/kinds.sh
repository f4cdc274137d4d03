#!/usr/bin/env bash
# A kind other than probes through everything: traced live to clients of both deliveries,
# under loss and a small budget; recorded, played again, traced into a container, listed, verified,
# previewed and drawn.
#   kinds.sh BIN GICODEC GI-TRACE GI-RENDER BAD-PEER KIND SETTINGS...
. "$(dirname "$0")/common.sh"
gicodec=$2 trace=$3 render=$4 bad_peer=$5 kind=$6
shift 6
scene=(--gltf "$room")
traced=("${scene[@]}" --kind "$kind")
settings=("$@")
# With a loss all clients hold what one stream decodes to.
deliveries=(unicast shared) delivered=()
for setting in "$@"; do
  traced+=(--set "$setting")
  [[ "$setting" == qp=* ]] && deliveries=(shared) delivered=(--delivery shared)
done
# How clients draw it.
drawing=()
[ "$kind" = irradiance_vectors ] && drawing=(--set interpolation=tricubic --set fill=push-pull)

# tool CODE NAME COMMAND...: output in NAME.log.
tool() {
  local code=$1 name=$2
  shift 2
  start "$name" "$@"
  ends "$code" $last "$name"
}
# serve NAME OPTIONS...: its process in $last, its port in $port.
serve() {
  local name=$1
  shift
  rm -f "$name.port"
  start "$name" "$bin/gi-server" --proofs --threads 1 --trace-threads 1 --port-file "$name.port" "$@"
  while [ ! -s "$name.port" ] && kill -0 "$last" 2>/dev/null; do nap; done
  port=$(cat "$name.port" 2>/dev/null) && return
  failed "$name did not begin:"
  cat "$name.log"
  finish
}

# Live, both deliveries, a picture each, drawn as set; what came is recorded. Who wants all says so
# when the first of few updates are gone; without culling all is sent from the first on.
live() {
  local server culling clients delivery
  culling=()
  [ "$kind" = voxels ] && culling=(--no-culling)
  serve live "${traced[@]}" "${culling[@]}" --wait ${#deliveries[@]} --rate 20 --updates 24 --lockstep
  server=$last
  if [ ${#deliveries[@]} -eq 1 ]; then
    tool 4 refused-live "$bin/gi-client" --connect "127.0.0.1:$port" "${scene[@]}" --delivery unicast
    says refused-live "--delivery shared"
  fi
  clients=()
  for delivery in "${deliveries[@]}"; do
    start "live-$delivery" "$bin/gi-client" --connect "127.0.0.1:$port" "${scene[@]}" --size 48x27 \
      --samples 1 --subscribe all --delivery $delivery --updates 16 --frames 1 -o "pictures-$delivery" \
      --record "$delivery.gic" --expect-proofs "${drawing[@]}"
    clients+=("$last")
  done
  for delivery in "${deliveries[@]}"; do
    ends 0 "${clients[0]}" "live-$delivery"
    clients=("${clients[@]:1}")
  done
  ends 0 $server live
  for delivery in "${deliveries[@]}"; do
    [ -s "pictures-$delivery/frame.0000.png" ] || failed "$kind: no picture of $delivery"
    says "live-$delivery" "([1-9][0-9]* of [0-9]* held)"
    tool 0 "verify-$delivery" "$gicodec" verify "$delivery.gic"
  done
}

# Packets are lost and late, and the budget is small: every state is exact all the same.
lossy() {
  local server relay delivery
  serve lossy "${traced[@]}" --rate 20 --max-kbps-per-client 4000
  server=$last
  relay relay "$port" --loss 5 --delay 20 --jitter 10 --seed 7
  relay=$last
  for delivery in "${deliveries[@]}"; do
    start "lossy-$delivery" "$bin/gi-client" --connect "127.0.0.1:$port" "${scene[@]}" \
      --subscribe all --delivery $delivery --updates 10 --expect-proofs
    ends 0 $last "lossy-$delivery"
  done
  kill $server $relay
  ends 0 $server lossy
  ends 0 $relay relay
}

# No more blocks in an update than a budget has room for, and no fewer as long as some have not come.
budget() {
  local server
  [ ${#deliveries[@]} -gt 1 ] || return 0  # a picture is sent whole
  serve budget "${traced[@]}" --wait 1
  server=$last
  start bundles "$bin/gi-client" --connect "127.0.0.1:$port" "${scene[@]}" --subscribe all \
    --budget-blocks 8 --updates 10 --record bundles.gic --expect-proofs
  ends 0 $last bundles
  kill $server
  ends 0 $server budget
  tool 0 bundles-info "$gicodec" info --packets bundles.gic --format json
  python3 - "$kind" >sizes.log 2>&1 <<'EOF' || failed "$kind: $(cat sizes.log)"
import json, sys
frames = {}
for texture in json.load(open("bundles-info.log"))["textures"]:
    for packet in texture["packets"]:
        frames[packet["frame"]] = frames.get(packet["frame"], 0) + packet["blocks"]
sizes = [frames[frame] for frame in sorted(frames)]
assert sizes and max(sizes) <= 8, sizes
assert sys.argv[1] != "irradiance_vectors" or sizes[:5] == [8] * 5, sizes
EOF
}

# Another scene is refused, and so is drawing as nobody can; a viewer whose numbers are extreme ends
# nobody's view.
other() {
  local server extreme
  serve other "${traced[@]}"
  server=$last
  extreme=
  if [ ${#deliveries[@]} -gt 1 ]; then
    start extreme "$bad_peer" viewpoints "127.0.0.1:$port"
    extreme=$last
  fi
  start wrong "$bin/gi-client" --connect "127.0.0.1:$port" --scene tomb --updates 1 "${delivered[@]}"
  ends 3 $last wrong
  says wrong "streams room.gltf"
  start unset "$bin/gi-client" --connect "127.0.0.1:$port" "${scene[@]}" --subscribe all --size 48x27 \
    --frames 1 -o pictures-unset --set nothing=1 "${delivered[@]}"
  ends 2 $last unset
  says unset "have no setting \"nothing\"; there are: "
  [ -z "$extreme" ] || ends 0 "$extreme" extreme
  start honest "$bin/gi-client" --connect "127.0.0.1:$port" "${scene[@]}" --subscribe all --updates 3 \
    --expect-proofs "${delivered[@]}"
  ends 0 $last honest
  kill $server
  ends 0 $server other
}

played() {
  local server
  serve played --play ../traced.gic --wait 1 --rate 20 --updates 8
  server=$last
  start watching "$bin/gi-client" --connect "127.0.0.1:$port" "${scene[@]}" --size 48x27 --samples 1 \
    --subscribe all --updates 6 --frames 1 -o pictures-played --expect-proofs "${drawing[@]}"
  ends 0 $last watching
  ends 0 $server played
}

# Without a scene clients show the textures, of whatever records.
shown() {
  local server textures
  serve shown --play ../traced.gic --wait 1 --rate 20 --updates 8
  server=$last
  start textures "$bin/gi-client" --connect "127.0.0.1:$port" --subscribe all --updates 6 --frames 1 \
    -o pictures-textures
  ends 0 $last textures
  ends 0 $server shown
  textures=$(python3 -c 'import json; print(len(json.load(open("../json.log"))["textures"]))')
  [ "$(ls pictures-textures | wc -l)" -eq "$textures" ] || failed "$kind: no pictures of textures"
}

# Into a container, twice the same; it can be listed, checked, looked at, drawn and played.
container() {
  tool 0 trace "$trace" "${traced[@]}" --frames 4 --fps 5 --threads 1 -o traced.gic
  tool 0 again "$trace" "${traced[@]}" --frames 4 --fps 5 --threads 2 -o again.gic
  cmp -s traced.gic again.gic || failed "$kind: two threads trace something else than one"
  tool 4 refused "$trace" "${traced[@]}" --frames 1 -o traced.gic
  says refused "overwrite"
  tool 0 info "$gicodec" info traced.gic
  says info "${kind//-/_}"
  case "$kind ${settings[*]}" in
    photons*) says info "room for [0-9]* records a block, of which the first so many exist" ;;
    *qp=*)
      says info "hevc.*, LOSSY ("
      tool 2 served "$bin/gi-server" "${traced[@]}" --updates 1 --max-error irradiance=2
      says served "exclude each other"
      ;;
  esac
  tool 0 json "$gicodec" info traced.gic --format json
  beside played shown
  tool 0 verify "$gicodec" verify traced.gic
  says verify "4 frames are sound"
  tool 0 preview "$gicodec" preview traced.gic --frame 1 -o texture.png
  tool 0 render "$render" "${scene[@]}" --stream traced.gic --frame 3 --size 48x27 --samples 1 -o drawn.png
  tool 0 as-set "$render" "${scene[@]}" --stream traced.gic --frame 3 --size 48x27 --samples 1 -o set.png \
    "${drawing[@]}"
  cmp -s drawn.png set.png
  [ $? -eq $((${#drawing[@]} > 0)) ] || failed "$kind: drawn as if nothing were set, or other than set"
  tool 2 not-drawn "$render" "${scene[@]}" --stream traced.gic --size 48x27 -o none.png --set nothing=1
  says not-drawn "have no setting \"nothing\"; there are: "
  tool 3 frame "$render" "${scene[@]}" --stream traced.gic --frame 4 --size 48x27 -o none.png
  says frame "has no frame 4"
  tool 0 direct "$render" "${scene[@]}" --stream traced.gic --frame 3 --mode direct --size 48x27 \
    --samples 1 -o direct.png
  together
}

# An interrupted trace keeps its frames.
interrupted() {
  start interrupted "$trace" "${traced[@]}" --frames 100000 --fps 100 -o part.gic
  # Until it has grown once more.
  until_true grown 4000 || failed "nothing was traced"
  until_true grown $(($(size_of part.gic.partial) + 1)) || failed "hardly anything was traced"
  kill -INT "$last"
  ends 130 "$last" interrupted
  says interrupted "interrupted; it holds"
  tool 0 part "$gicodec" verify part.gic
}

size_of() { stat -c %s "$1" 2>/dev/null || echo 0; }
grown() { [ "$(size_of part.gic.partial)" -ge "$1" ] || ! kill -0 "$last" 2>/dev/null; }

# What makes no sense.
senseless() {
  tool 2 unknown "$trace" "${scene[@]}" --kind "$kind" --set nothing=1 -o x.gic
  says unknown "have no setting"
  tool 2 flags "$trace" "${scene[@]}" --kind "$kind" --rays 5 -o x.gic
  says flags "is for probes"
  if [ "$kind" = irradiance_maps ]; then
    tool 0 export "$trace" "${traced[@]}" --frames 1 --export-gltf map.glb
    grep -aq TEXCOORD_1 map.glb || failed "the scene has no coordinates of its map"
  else
    tool 2 export "$trace" "${traced[@]}" --frames 1 --export-gltf map.glb
    says export "is for probes and irradiance_maps"
  fi
}

beside other live lossy budget container interrupted senseless
finish
