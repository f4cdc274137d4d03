#!/usr/bin/env bash
# Every program and every command of gicodec with several threads, for ThreadSanitizer: the other
# tests keep to one where that is faster.
#   threads.sh BIN GICODEC GI-TRACE GI-RENDER [hevc]
here=$(cd "$(dirname "$0")" && pwd)
. "$here/common.sh"
. "$here/certificates.sh"
gicodec=$2 trace=$3 render=$4 hevc=${5:-}
ran=()

# run COMMAND ARGUMENTS...: a command of gicodec succeeds.
run() {
  ran+=("$1")
  "$gicodec" "$@" >run.log 2>&1 || { failed "gicodec $*"; cat run.log; }
}
# run_program PROGRAM ARGUMENTS...
run_program() {
  "$@" >run.log 2>&1 || { failed "$*"; cat run.log; }
}

# 3,328 probes: what threads share is so much that two of them take part, and several regions of the
# native codec with work for a thread each.
coding() {
  local coding command
  run_program "$trace" --gltf $room --grid 16x13x16 --rays 8 --frames 2 --threads 4 -o traced.gic
  run decode traced.gic -o traced --threads 4
  for coding in "native --preset fast" "native --preset strong" "zstd" "lz4" "raw"; do
    run encode -o a.gic --threads 4 --backend $coding traced
    run verify a.gic traced --threads 4
  done
  run decode a.gic -o out --threads 4
  run encode -o n.gic --threads 4 traced
  run info n.gic --format json
  run preview n.gic --frame 1 -o a.png
  run compare traced/color.0001.exr out/color.0001.exr
  run crop --origin 1,1,1 --size 6x3x6 -o small traced
  echo '<!-- files -->' >page.html
  run view n.gic --page page.html --export n.html
  run backends
  if [ -n "$hevc" ]; then
    run encode -o h.gic --threads 4 --backend hevc --preset ultrafast small
    run verify h.gic small --threads 4
  fi
  run_program "$render" --gltf $room --stream n.gic --frame 1 --size 64x36 --samples 1 --threads 4 -o lit.png
  while read -r command _; do
    [[ " ${ran[*]} " == *" $command "* ]] || failed "gicodec $command was not run"
  done < <("$gicodec" --help | sed -n '/^Subcommands:/,/^$/p' | sed '1d;/^$/d')

  # A container played by several threads.
  local server
  start play "$bin/gi-server" --play n.gic --no-culling --threads 3 --updates 3 --wait 1 --proofs \
    --port-file play.port
  server=$last
  start player "$bin/gi-client" --connect "127.0.0.1:$(port_of play)" --updates 3 --expect-proofs
  ends 0 $last player
  ends 0 $server play
}

# A server that traces, encodes and carries both transports at once; clients of each kind, one behind
# a relay, one that draws with several threads.
serving() {
  local server ports clients
  start server "$bin/gi-server" --gltf $room --grid 9x5x9 --rays 16 --trace-threads 3 --threads 3 \
    --listen 127.0.0.1:0 --listen-web 127.0.0.1:0 --certificate ../server.pem --key ../server.key \
    --port-file server.port --fine 4x4x4 --proofs --rate 20 --updates $((40 * slower)) --wait 4 --stats-file stats.jsonl
  server=$last
  ports=($(port_of server))
  relay relay ${ports[0]} --loss 2 --delay 5
  clients=()
  client() {
    local name=client-${#clients[@]}
    start $name "$bin/gi-client" --updates $((8 * slower)) --expect-proofs "$@"
    clients+=($last)
  }
  client --connect 127.0.0.1:${ports[0]} $scene --frames 3 --threads 3 -o pictures
  client --connect 127.0.0.1:$port $view --delivery shared
  client --connect wss://127.0.0.1:${ports[1]} --ca ../authority.pem $view
  client --connect 127.0.0.1:${ports[0]} --gltf $room --simulate 3
  for i in "${!clients[@]}"; do ends 0 ${clients[i]} client-$i; done
  ends 0 $server server
}

beside serving coding
finish
