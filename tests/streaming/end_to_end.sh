#!/usr/bin/env bash
# A server and clients of both deliveries: pictures, proofs, budgets, subscriptions, containers.
. "$(dirname "$0")/common.sh"
gicodec=$2 testdata=$3

"$gicodec" encode -q -o tomb.gic "$testdata/tomb-converged" || failed "encode"

# Clients leave before it ends.
deliveries() {
  local server unicast shared box picture
  server server --updates 30 --wait 3 --rate 20 --proofs --stats-file stats.jsonl --log-updates log.csv
  server=$last
  start unicast "$bin/gi-client" --connect 127.0.0.1:$port $scene --updates 10 --frames 2 -o unicast --expect-proofs
  unicast=$last
  start shared "$bin/gi-client" --connect 127.0.0.1:$port $scene --delivery shared --updates 10 --frames 2 -o shared --expect-proofs --stats json
  shared=$last
  start box "$bin/gi-client" --connect 127.0.0.1:$port --subscribe 0-2,0-2,1-4 --updates 10 --budget-blocks 7 --expect-proofs --isa scalar
  box=$last
  ends 0 $unicast unicast
  ends 0 $shared shared
  ends 0 $box box
  ends 0 $server server
  says unicast "0 failed"
  says unicast "2 pictures"
  says unicast "; [0-9.]* s in all"
  says shared '"failed_proofs":0'
  says shared '"all_seconds":[0-9]'
  says box "0 failed"
  says server "joined as client"
  says server "left"
  says server "30 updates"
  for picture in unicast/frame.0001.png shared/frame.0001.png; do
    [ -s "$picture" ] || failed "$picture is missing"
  done
  grep -q '"latency_ms"' stats.jsonl || failed "no statistics"
  # The one with a budget is never sent more than that.
  awk -F, 'NR > 1 && $6 == 3 {most = ($9 + $10 > most) ? $9 + $10 : most} END {exit !(most > 0)}' log.csv ||
    failed "log.csv has nothing of the third client"
}

# Many clients in one process.
crowd() {
  local server
  server crowd --updates $((6 * slower)) --rate 20 --wait 4 --proofs
  server=$last
  start simulated "$bin/gi-client" --connect 127.0.0.1:$port $scene --simulate 4 --expect-proofs \
    --updates $((6 * slower))
  ends 0 $last simulated
  ends 0 $server crowd
  says simulated "4 of 4 clients"
  says simulated " 0 failed"
}

# Who leaves makes room at once.
makes_room() {
  local server i
  server room --rate 50 --max-per-address 4 --max-unicast 4 --max-unicast-per-address 4
  server=$last
  for i in 1 2 3; do
    start crowd-$i "$bin/gi-client" --connect 127.0.0.1:$port $scene --simulate 4 --updates 5
    ends 0 $last crowd-$i
    says crowd-$i "4 of 4 clients"
  done
  for i in 1 2 3 4 5 6; do
    start single-$i "$bin/gi-client" --connect 127.0.0.1:$port $view --updates 2
    ends 0 $last single-$i
  done
  kill $server
  ends 0 $server room
}

# A container is played as it is; without a scene its textures are drawn.
container() {
  local server how code folder flags
  start play "$bin/gi-server" --play ../tomb.gic --isa scalar --no-culling --rate 20 --updates 4 --wait 1 --proofs --port-file play.port
  server=$last
  start atlas "$bin/gi-client" --connect "127.0.0.1:$(port_of play)" --updates 4 --frames 1 -o atlas --expect-proofs
  ends 0 $last atlas
  ends 0 $server play
  [ -s atlas/5x4x5.color.0000.png ] && [ -s atlas/5x4x5.vis.0000.png ] || failed "atlases are missing"
  # A picture that is there stays unless it may go.
  mkdir unicast
  echo "an earlier picture" >unicast/frame.0000.png
  start again "$bin/gi-server" --play ../tomb.gic --loop --port-file again.port
  server=$last
  for how in "4 atlas" "4 unicast --scene tomb" "0 atlas --overwrite" "0 unicast --scene tomb --overwrite"; do
    read -r code folder flags <<<"$how"
    start kept "$bin/gi-client" --connect "127.0.0.1:$(port_of again)" $flags --size 48x27 --frames 1 -o $folder
    ends $code $last kept
    [ $code = 0 ] || says kept "0000.png: exists; --overwrite replaces it"
    [ "$folder$code" = unicast4 ] && { grep -qx "an earlier picture" unicast/frame.0000.png || failed "it was replaced"; }
  done
  grep -aqx "an earlier picture" unicast/frame.0000.png && failed "it was not replaced"
  kill $server
  ends 0 $server again
}

# What is culled is not missed: the same picture as from everything. In the villa something is. One
# frame, and time enough for all of it.
picture_of() {
  local sent=$1 server
  mkdir one
  ln -s "$testdata"/villa-converged/*.0000.exr one
  start server-$sent "$bin/gi-server" --play one --rate 20 --proofs --port-file $sent.port \
    --log-updates updates.csv "${@:2}"
  server=$last
  start $sent "$bin/gi-client" --connect "127.0.0.1:$(port_of $sent)" --scene villa --size 96x54 \
    --updates 40 --frames 2 --fps 0.33 -o pictures --expect-proofs
  ends 0 $last $sent
  kill $server
  ends 0 $server server-$sent
}
culled() { picture_of culled; }
all() { picture_of all --no-culling; }

# So many updates that a slow client says meanwhile what it sees.
dumps() {
  local server
  start dumps "$bin/gi-server" --play "$testdata/tomb-converged" --loop --updates 25 --wait 1 --proofs --port-file dumps.port
  server=$last
  start viewer "$bin/gi-client" --connect "127.0.0.1:$(port_of dumps)" --scene tomb --size 48x27 --updates 25 --expect-proofs
  ends 0 $last viewer
  ends 0 $server dumps
}

# Frames that are missing: the container that is advised is played.
gaps() {
  local server frame
  mkdir files
  for frame in 0000 0002; do ln -s "$testdata"/tomb-converged/*.$frame.exr files; done
  start refused "$bin/gi-server" --play files
  ends 3 $last refused
  says refused "\"gicodec encode --allow-gaps\" makes a container that can be played"
  "$gicodec" encode -q --allow-gaps -o files.gic files || failed "no container of frames with gaps"
  start gaps "$bin/gi-server" --play files.gic --loop --updates 3 --wait 1 --proofs --port-file gaps.port
  server=$last
  start viewer "$bin/gi-client" --connect "127.0.0.1:$(port_of gaps)" --updates 3 --expect-proofs
  ends 0 $last viewer
  ends 0 $server gaps
}

# Without proofs there is nothing to expect; with nobody there is no server.
unproved() {
  local server
  start plain "$bin/gi-server" --play ../tomb.gic --no-culling --updates 3 --wait 1 --port-file plain.port
  server=$last
  port=$(port_of plain)
  start unproved "$bin/gi-client" --connect 127.0.0.1:$port --expect-proofs --updates 3
  ends 1 $last unproved
  ends 0 $server plain
}

nobody() {
  start nobody "$bin/gi-client" --connect 127.0.0.1:1 --updates 1 --patience 0.5
  ends 4 $last nobody
  says nobody "no server answers"
}

# SIGTERM: everybody is told, and both ends end well.
stopped() {
  local server client
  server stopped
  server=$last
  start watching "$bin/gi-client" --connect 127.0.0.1:$port $view
  client=$last
  wait_for stopped joined
  kill -TERM $server
  ends 0 $server stopped
  ends 0 $client watching
}

beside culled all deliveries container nobody makes_room crowd dumps gaps unproved stopped
together
cmp culled/pictures/frame.0001.png all/pictures/frame.0001.png || failed "culling shows"
# Probes in all updates of each.
awk -F, 'FNR > 1 {all[FILENAME] += $9}
  END {exit !(all["culled/updates.csv"] > 0 && all["culled/updates.csv"] < all["all/updates.csv"])}' \
  culled/updates.csv all/updates.csv || failed "nothing was culled"
finish
