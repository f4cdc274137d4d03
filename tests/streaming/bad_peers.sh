#!/usr/bin/env bash
# Peers that misbehave are dropped with the reason, while an honest client notices nothing.
. "$(dirname "$0")/common.sh"
bad_peer=$2

misbehaving() {
  local server honest honest_shared address kind i seconds kinds peers=()
  # So long that those who are only slow, on a loaded machine, are not taken for bad ones.
  seconds=$(enough)
  server server --proofs --hello-timeout $seconds --stall-timeout $seconds --timeout $seconds \
    --max-in-flight 8 --max-per-address 60 --max-unicast-per-address 0 --stats-file stats.jsonl
  server=$last
  address=127.0.0.1:$port
  start honest "$bin/gi-client" --connect $address $view --expect-proofs
  honest=$last
  start honest-shared "$bin/gi-client" --connect $address $view --delivery shared --expect-proofs
  honest_shared=$last
  wait_for server "joined as client" 2

  # Those that need time first, and all beside each other.
  kinds=(never-acknowledges silent huge vanish garbage late-garbage empty cut version no-hello replay
    foreign-ticket-replay server-message future-sync future-update unknown-volume viewpoints flood
    oversized datagrams garbage-again)
  for kind in "${kinds[@]}"; do
    start $kind "$bad_peer" ${kind%-again} $address
    peers+=($last)
  done
  for i in "${!kinds[@]}"; do ends 0 ${peers[i]} ${kinds[i]}; done
  start afterwards "$bin/gi-client" --connect $address $view --updates 12 --expect-proofs
  ends 0 $last afterwards
  kill -TERM $server
  ends 0 $server server
  ends 0 $honest honest
  ends 0 $honest_shared honest-shared
  says honest " 0 failed"
  says honest-shared " 0 failed"
  says server "does not take its updates, "
  for reason in "another protocol version" "too many messages" "does not take"; do
    grep -q "dropped: .*$reason" server.log || failed "nobody was dropped with \"$reason\""
  done
  [ "$(grep -c 'dropped: ' server.log)" -ge 16 ] || { failed "too few were dropped"; cat server.log; }
}

# Strangers, and more clients than there is room for.
guarded() {
  local server knows first second address
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
  wait_for guarded joined 3
  start third "$bin/gi-client" --connect $address $view --token-file token --updates 5
  ends 4 $last third
  # Both have to have got something before there is something to judge.
  until_true both_got || failed "nothing came"
  kill -TERM $server
  ends 0 $server guarded
  ends 0 $first first
  ends 0 $second second
  grep -qe "sesame" *.log && failed "the token was shown"
}
# Acknowledged updates, with blocks in some: the first are empty until a view is known.
both_got() { "$bin/gi-server" --ask control list | awk '$5 > 0 && $6 - $7 > 4 {++n} END {exit n < 2}'; }

beside misbehaving guarded
finish
