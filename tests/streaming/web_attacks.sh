#!/usr/bin/env bash
# Peers that misbehave over WebSockets lose their connection, and an honest client notices nothing.
here=$(cd "$(dirname "$0")" && pwd)
. "$here/common.sh"
. "$here/certificates.sh"
bad_peer=$2

# How long who is honest may be slow.
seconds=$(enough)

# serve OPTIONS...: a server that waits for long, and an honest client of it, which is to notice nothing.
serve() {
  server server --listen-web 127.0.0.1:0 --certificate ../server.pem --key ../server.key --proofs \
    --hello-timeout 100 --stall-timeout 60 --timeout 30 --max-in-flight 8 --rate 20 --no-culling "$@"
  server=$last
  web=wss://127.0.0.1:$port
  start honest "$bin/gi-client" --connect $web --ca ../authority.pem $view --expect-proofs
  honest=$last
  wait_for server "joined as client 1"
}
noticed_nothing() {
  kill -TERM $server
  ends 0 $server server
  ends 0 $honest honest
  says honest " 0 failed"
  says honest "; [0-9.]* s in all"
  grep -q "connections" honest.log && failed "the honest client lost its connection"
}

# As after a restart of a server with many clients: the oldest handshakes make room for newer ones.
crowd() {
  local server honest web
  serve
  start crowd python3 "$here/web_peer.py" crowd $web 200
  ends 0 $last crowd
  noticed_nothing
}

handshakes() {
  local server honest web kind i held=()
  serve
  # More of each than there is room for, from addresses of their own and from this one: they cannot
  # keep anybody out.
  for kind in silent:2 half_tls:3 half_http:4 silent:1; do
    start held-${kind/:/-} python3 "$here/web_peer.py" ${kind%:*} $web 80 127.0.0.${kind#*:}
    held+=($last)
    wait_for held-${kind/:/-} there
  done
  for i in 1 2 3; do
    start newcomer "$bin/gi-client" --connect $web --ca ../authority.pem $view --updates 6 --expect-proofs
    ends 0 $last newcomer
    grep -q "connections" newcomer.log && failed "the newcomer had to try again"
  done
  kill "${held[@]}"
  noticed_nothing
}

frames() {
  local server honest web kind i peers=() kinds
  serve --max-unicast-per-address 0
  kinds=(text claims oversized crumbs empties pings opcode empty elsewhere)
  for kind in "${kinds[@]}"; do
    start $kind python3 "$here/web_peer.py" $kind $web
    peers+=($last)
  done
  for i in "${!kinds[@]}"; do ends 0 ${peers[i]} ${kinds[i]}; done
  noticed_nothing
}

# The protocol's own rules, as over ENet: bad_peer knows no certificates.
rules() {
  local server honest plain kind i peers=() kinds
  server plain --listen-web 127.0.0.1:0 --insecure-web --proofs --hello-timeout $seconds \
    --stall-timeout $seconds --max-in-flight 8 --max-per-address 60 --max-unicast-per-address 0
  server=$last
  plain=ws://127.0.0.1:$port
  start honest-plain "$bin/gi-client" --connect $plain $view --expect-proofs
  honest=$last
  wait_for plain "joined as client 1"
  # Those that need time first, and all beside each other.
  kinds=(never-acknowledges silent huge garbage late-garbage empty cut version no-hello replay
    foreign-ticket-replay server-message future-sync future-update unknown-volume flood oversized)
  for kind in "${kinds[@]}"; do
    start plain-$kind "$bad_peer" $kind $plain
    peers+=($last)
  done
  for i in "${!kinds[@]}"; do ends 0 ${peers[i]} plain-${kinds[i]}; done
  kill -TERM $server
  ends 0 $server plain
  ends 0 $honest honest-plain
  says honest-plain " 0 failed"
  [ "$(grep -c 'dropped: ' plain.log)" -ge 16 ] || { failed "too few were dropped"; cat plain.log; }
}

# Who reads nothing is not kept for: what waits for it is bounded, and it goes.
slow() {
  local server unread
  server slow --listen-web 127.0.0.1:0 --insecure-web --no-culling --backend raw --rate 50 \
    --max-in-flight 100000 --max-in-flight-mb 1 --stall-timeout 3 --hello-timeout $seconds
  server=$last
  start unread python3 "$here/web_peer.py" unread ws://127.0.0.1:$port 1000
  unread=$last
  wait_for slow "dropped: it does not take its updates"
  kill -TERM $server
  ends 0 $server slow
  kill $unread
}

# A proxy says for whom it comes; what a client says itself stands before that.
proxy() {
  local server
  server proxy --listen-web 127.0.0.1:0 --insecure-web --behind-proxy --max-per-address 2
  server=$last
  curl -sI http://127.0.0.1:$port/health | tr -d '\r' >head
  grep -q "^HTTP/1.1 200 OK$" head && grep -q "^Content-Length: 3$" head || failed "HEAD: $(cat head)"
  [ "$(tail -n 1 head)" = "" ] || failed "HEAD brings a body"
  start forwarded python3 "$here/web_peer.py" forwarded ws://127.0.0.1:$port
  ends 0 $last forwarded
  wait_for proxy "turned away, the last one 203.0.113.7:[0-9]"
  kill -TERM $server
  ends 0 $server proxy
}

beside rules handshakes frames crowd slow proxy
finish
