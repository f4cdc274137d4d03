#!/usr/bin/env bash
# Peers that misbehave over WebSockets lose their connection, and an honest client notices nothing.
here=$(cd "$(dirname "$0")" && pwd)
. "$here/common.sh"
. "$here/certificates.sh"
bad_peer=$2

server server --listen-web 127.0.0.1:0 --certificate server.pem --key server.key --proofs \
  --hello-timeout 8 --stall-timeout 15 --timeout 8 --max-in-flight 8
server=$last
web=wss://127.0.0.1:$port
start honest "$bin/gi-client" --connect $web --ca authority.pem $view --expect-proofs
honest=$last
wait_for server "joined as client 1"

# As after a restart of a server with many clients: the oldest handshakes make room for newer ones.
start crowd python3 "$here/web_peer.py" crowd $web 200
ends 0 $last crowd

# More of each than there is room for, from addresses of their own and from this one: they cannot
# keep anybody out.
held=()
for kind in silent:2 half_tls:3 half_http:4 silent:1; do
  start held-${kind/:/-} python3 "$here/web_peer.py" ${kind%:*} $web 80 127.0.0.${kind#*:}
  held+=($last)
  wait_for held-${kind/:/-} there
done
for i in 1 2 3; do
  start newcomer "$bin/gi-client" --connect $web --ca authority.pem $view --updates 3 --expect-proofs
  ends 0 $last newcomer
  grep -q "connections" newcomer.log && failed "the newcomer had to try again"
done
kill "${held[@]}"
for kind in text claims oversized crumbs empties pings opcode empty elsewhere; do
  start $kind python3 "$here/web_peer.py" $kind $web
  ends 0 $last $kind
done
kill -TERM $server
ends 0 $server server
ends 0 $honest honest
says honest " 0 failed"
says honest "; [0-9.]* s in all"
grep -q "connections" honest.log && failed "the honest client lost its connection"

# The protocol's own rules, as over ENet: bad_peer knows no certificates.
server plain --listen-web 127.0.0.1:0 --insecure-web --proofs --hello-timeout 8 --stall-timeout 15 \
  --max-in-flight 8
server=$last
plain=ws://127.0.0.1:$port
start honest-plain "$bin/gi-client" --connect $plain $view --expect-proofs
honest=$last
slow=()
for kind in never-acknowledges silent huge; do
  start plain-$kind "$bad_peer" $kind $plain
  slow+=($last)
done
for kind in garbage late-garbage empty cut version no-hello replay foreign-ticket-replay \
  server-message future-epoch future-update unknown-volume flood oversized; do
  start plain-$kind "$bad_peer" $kind $plain
  ends 0 $last plain-$kind
done
i=0
for kind in never-acknowledges silent huge; do
  ends 0 ${slow[i++]} plain-$kind
done
kill -TERM $server
ends 0 $server plain
ends 0 $honest honest-plain
says honest-plain " 0 failed"
[ "$(grep -c 'dropped: ' plain.log)" -ge 16 ] || { failed "too few were dropped"; cat plain.log; }

# Who reads nothing is not kept for: what waits for it is bounded, and it goes.
server slow --listen-web 127.0.0.1:0 --insecure-web --no-culling --backend raw --rate 50 \
  --max-in-flight 100000 --max-in-flight-mb 1 --stall-timeout 3 --hello-timeout 8
server=$last
start unread python3 "$here/web_peer.py" unread ws://127.0.0.1:$port 1000
unread=$last
wait_for slow "dropped: it does not take its updates"
kill -TERM $server
ends 0 $server slow
kill $unread
finish
