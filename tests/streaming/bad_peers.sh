#!/usr/bin/env bash
# Peers that misbehave are dropped with the reason, while an honest client notices nothing.
. "$(dirname "$0")/common.sh"
bad_peer=$2

# So long that those who are only slow, on a loaded machine, are not taken for bad ones.
server server --proofs --hello-timeout 8 --stall-timeout 15 --timeout 8 --max-in-flight 8 \
  --stats-file stats.jsonl
server=$last
address=127.0.0.1:$port
start honest "$bin/gi-client" --connect $address $view --expect-proofs
honest=$last
start honest-shared "$bin/gi-client" --connect $address $view --delivery shared --expect-proofs
honest_shared=$last

# Those that need time run beside the others.
slow=()
for kind in never-acknowledges silent huge vanish; do
  start $kind "$bad_peer" $kind $address
  slow+=($last)
done
for kind in garbage late-garbage empty cut version no-hello replay foreign-ticket-replay \
  server-message future-epoch future-update unknown-volume viewpoints flood oversized datagrams garbage; do
  start $kind "$bad_peer" $kind $address
  ends 0 $last $kind
done
i=0
for kind in never-acknowledges silent huge vanish; do
  ends 0 ${slow[i++]} $kind
done
sleep 1
kill -TERM $server
ends 0 $server server
ends 0 $honest honest
ends 0 $honest_shared honest-shared
says honest " 0 failed"
says honest-shared " 0 failed"
says server "does not take its updates, "
for reason in "another protocol version" "more messages than" "does not take"; do
  grep -q "dropped: " server.log || failed "nobody was dropped"
done
[ "$(grep -c 'dropped: ' server.log)" -ge 16 ] || { failed "too few were dropped"; cat server.log; }

# Strangers, and more clients than there is room for.
echo "open sesame" >token
server guarded --token-file token --max-clients 2 --proofs --control control
server=$last
address=127.0.0.1:$port
start knows "$bin/gi-client" --connect $address $view --token-file token --expect-proofs --updates 20
knows=$last
start guesses "$bin/gi-client" --connect $address $view --token "open barley" --updates 5
ends 4 $last guesses
says guesses "token"
start token "$bad_peer" token $address
ends 0 $last token
ends 0 $knows knows
start first "$bin/gi-client" --connect $address $view --token-file token --expect-proofs
first=$last
start second "$bin/gi-client" --connect $address $view --token-file token --expect-proofs
second=$last
for ((i = 0; i < 1200; ++i)); do [ "$(grep -c joined guarded.log)" -ge 3 ] && break; sleep 0.1; done
start third "$bin/gi-client" --connect $address $view --token-file token --updates 5
ends 4 $last third
# Both have to have got something before there is something to judge.
for ((i = 0; i < 1200; ++i)); do
  "$bin/gi-server" --ask control list | awk '$6 - $7 > 1 {++n} END {exit n < 2}' && break
  sleep 0.1
done
kill -TERM $server
ends 0 $server guarded
ends 0 $first first
ends 0 $second second
grep -qe "sesame" *.log && failed "the token was shown"
finish
