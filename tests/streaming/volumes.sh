#!/usr/bin/env bash
# A second, finer volume that scrolls with the camera; rates, thresholds and backends of their own.
. "$(dirname "$0")/common.sh"

scrolls() {
  local backend=$1 server unicast shared
  server $backend --fine 5x4x5 --fine-spacing 1 --lockstep --rate 16 --updates 32 --wait 2 \
    --proofs --visibility-interval 2 --backend $backend --log-updates $backend.csv
  server=$last
  start unicast-$backend "$bin/gi-client" --connect 127.0.0.1:$port $scene --orbit --updates 32 --frames 1 -o pictures-$backend --expect-proofs
  unicast=$last
  # The first one's eye is what it follows.
  wait_for $backend joined
  start shared-$backend "$bin/gi-client" --connect 127.0.0.1:$port $view --delivery shared --updates 32 --expect-proofs
  shared=$last
  ends 0 $unicast unicast-$backend
  ends 0 $shared shared-$backend
  ends 0 $server $backend
  says unicast-$backend " 0 failed"
  says shared-$backend " 0 failed"
  # Column 11 is the fine volume's colour.
  awk -F, 'NR > 1 && $11 > 0 {n++} END {exit !(n > 4)}' $backend.csv ||
    { failed "$backend: the fine volume was hardly sent"; cat $backend.csv; }
}
native() { scrolls native; }
lz4() { scrolls lz4; }
beside native lz4
finish
