#!/usr/bin/env bash
# Through a relay that loses, delays and shuffles packets every state stays exact; when it breaks
# down the session goes on over the next one.
. "$(dirname "$0")/common.sh"

shuffled() {
  local server relay unicast shared
  server server --rate 20 --updates 40 --wait 2 --proofs
  server=$last
  relay relay "$port" --loss 5 --delay 30 --jitter 20 --seed 3
  relay=$last
  start unicast "$bin/gi-client" --connect 127.0.0.1:$port $view --updates 25 --expect-proofs
  unicast=$last
  start shared "$bin/gi-client" --connect 127.0.0.1:$port $view --delivery shared --updates 25 --expect-proofs
  shared=$last
  ends 0 $unicast unicast
  ends 0 $shared shared
  ends 0 $server server
  kill $relay
  ends 0 $relay relay
  says relay "to the server: .* [1-9][0-9]* dropped"
}

# went_on MORE: both clients were sent so many updates over their connections.
went_on() { "$bin/gi-server" --ask control list | awk -v more=$1 '$6 >= more {++n} END {exit n < 2}'; }
broken_down() {
  local server relay at to delivery unicast shared
  server long --proofs --timeout 2 --rate 20 --control control
  server=$last
  to=$port
  relay first "$to"
  at=$port
  relay=$last
  for delivery in unicast shared; do
    start "back-$delivery" "$bin/gi-client" --connect "127.0.0.1:$at" $view --delivery $delivery --timeout 2 --patience 60 --expect-proofs
    eval "$delivery=$last"
  done
  wait_for long joined 2
  until_true went_on 10 || failed "nothing came through the first relay"
  kill $relay
  ends 0 $relay first
  # With nothing there both find out that it is gone.
  wait_for back-unicast "connection lost"
  wait_for back-shared "connection lost"
  relay second "$to" --listen "127.0.0.1:$at"
  wait_for long "came back" 2
  until_true went_on 20 || failed "nothing came through the second relay"
  for delivery in unicast shared; do
    kill -INT "${!delivery}"
    ends 0 "${!delivery}" "back-$delivery"
    says "back-$delivery" "2 connections, resumed"
  done
  kill $server
  ends 0 $server long
}

# A link that carries a fraction of what is seen is enough for a client whose rate is bounded by that.
thin() {
  local delivery=$1 server relay
  server slow --proofs --max-kbps-per-client 90 --no-culling
  server=$last
  relay thin "$port" --rate-limit 0.15
  relay=$last
  start "thin-$delivery" "$bin/gi-client" --connect 127.0.0.1:$port $view --delivery $delivery --updates 10 --expect-proofs
  ends 0 $last "thin-$delivery"
  kill $server $relay
  ends 0 $server slow
  ends 0 $relay thin
}
thin_unicast() { thin unicast; }
thin_shared() { thin shared; }

# A connection that does not come back may be one that carries too little.
gone() {
  local server client
  server gone --no-culling
  server=$last
  start gone-client "$bin/gi-client" --connect 127.0.0.1:$port $view --timeout 0.5 --patience 1
  client=$last
  wait_for gone joined
  kill -9 $server
  ends 137 $server gone 2>/dev/null
  ends 4 $client gone-client
  says gone-client "no server answers.*if the link is slow, --budget-bytes"
}
beside broken_down thin_unicast thin_shared gone shuffled
finish
