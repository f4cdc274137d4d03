#!/usr/bin/env bash
# Through a relay that loses, delays and shuffles packets every state stays exact; when it breaks
# down the session goes on over the next one.
. "$(dirname "$0")/common.sh"

server server --updates 40 --wait 2 --proofs
server=$last
relay relay "$port" --loss 5 --delay 30 --jitter 20 --seed 3
relay=$last
start own "$bin/gi-client" --connect 127.0.0.1:$port $view --updates 25 --expect-proofs
own=$last
start shared "$bin/gi-client" --connect 127.0.0.1:$port $view --delivery shared --updates 25 --expect-proofs
shared=$last
ends 0 $own own
ends 0 $shared shared
ends 0 $server server
kill $relay
ends 0 $relay relay
says relay "to the server: .* [1-9][0-9]* dropped"

server long --proofs --timeout 2
server=$last
to=$port
relay first "$to"
at=$port
relay=$last
for delivery in own shared; do
  start "back-$delivery" "$bin/gi-client" --connect "127.0.0.1:$at" $view --delivery $delivery --timeout 1 --updates 40 --patience 30 --expect-proofs
  eval "$delivery=$last"
done
for ((i = 0; i < 300; ++i)); do [ "$(grep -c joined long.log)" -eq 2 ] && break; sleep 0.1; done
sleep 1
kill $relay
ends 0 $relay first
sleep 1
relay second "$to" --listen "127.0.0.1:$at"
for delivery in own shared; do
  ends 0 "${!delivery}" "back-$delivery"
  says "back-$delivery" "2 connections, resumed"
done
says long "came back"
kill $server
ends 0 $server long
# A link that carries a fraction of what is seen is enough for a client whose rate is bounded by that.
server slow --proofs --max-kbps-per-client 30 --no-culling
server=$last
relay thin "$port" --rate-limit 0.05
relay=$last
for delivery in own shared; do
  start "thin-$delivery" "$bin/gi-client" --connect 127.0.0.1:$port $view --delivery $delivery --updates 10 --expect-proofs
  ends 0 $last "thin-$delivery"
done
kill $server $relay
ends 0 $server slow
ends 0 $relay thin
# A connection that does not come back may be one that carries too little.
server gone --no-culling
server=$last
start gone-client "$bin/gi-client" --connect 127.0.0.1:$port $view --timeout 0.5 --patience 1
client=$last
wait_for gone joined
kill -9 $server
ends 137 $server gone 2>/dev/null
ends 4 $client gone-client
says gone-client "no server answers.*if the link is slow, --budget-bytes"
finish
