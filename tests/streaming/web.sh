#!/usr/bin/env bash
# WebSockets over TLS 1.3: what arrives, who is trusted, what is seen and what may be harmed on the way.
here=$(cd "$(dirname "$0")" && pwd)
. "$here/common.sh"
. "$here/certificates.sh"
grep -q "^0*1 " /proc/net/if_inet6 || {
  echo "skipped: there is no ::1 here"
  exit 77
}

# web NAME OPTIONS...: a server over TLS on IPv4 and IPv6; its process in $server, its port in $port.
web() {
  local name=$1
  shift
  server $name --listen-web "[::]:0" --certificate ../server.pem --key ../server.key --proofs "$@"
  server=$last
}
# tap NAME PORT HARM...: what is on the way to PORT goes to NAME.capture; its port in $port.
tap() {
  local name=$1 to=$2
  shift 2
  start $name python3 "$here/web_tap.py" $name.port "$to" $name.capture "$@"
  tap=$last
  port=$(port_of $name)
}

# Without the name the address is tried twice.
name_of_this=localhost
timeout 20 python3 -c 'import socket; socket.getaddrinfo("localhost", 1)' 2>/dev/null || {
  name_of_this=127.0.0.1
  skip "the name localhost is not known here"
}

# refused NAME TEXT OPTIONS...: a client does not want to talk to whom it finds.
refused() {
  local name=$1 text=$2
  shift 2
  start $name "$bin/gi-client" $view --updates 2 "$@"
  ends 4 $last $name
  says $name "$text"
}
# Both deliveries, IPv4, IPv6 and a name; with ENet beside it.
both() {
  local server ports clients name where enet i
  web both --listen 127.0.0.1:0 --rate 20 --max-unicast-per-address 9
  ports=($port)
  [ ${#ports[@]} -eq 2 ] || failed "the ports of both transports are not told: $port"
  says both "listening on 127.0.0.1:${ports[0]} and wss://\[::\]:${ports[1]}"
  clients=()
  for where in 127.0.0.1:unicast $name_of_this:shared "[::1]:unicast"; do
    name=client-${#clients[@]}
    start $name "$bin/gi-client" --connect "wss://${where%:*}:${ports[1]}" --ca ../authority.pem $view \
      --delivery ${where##*:} --updates $((12 * slower)) --expect-proofs
    clients+=($last)
  done
  start enet "$bin/gi-client" --connect 127.0.0.1:${ports[0]} $view --updates $((12 * slower)) \
    --expect-proofs
  enet=$last
  start crowd "$bin/gi-client" --connect wss://127.0.0.1:${ports[1]} --pin "$(pin_of ../server.pem)" \
    --simulate 5 --gltf $room --updates $((12 * slower)) --expect-proofs
  ends 0 $last crowd
  for i in 0 1 2; do
    ends 0 ${clients[i]} client-$i
    says client-$i " 0 failed"
  done
  ends 0 $enet enet
  says both "\[::1\]:[0-9]* joined as client"

  # Who is not who the client wants to talk to. Nothing was said to them.
  local to joined
  to=wss://127.0.0.1:${ports[1]}
  refused unknown "not issued by an authority that is trusted here" --connect $to
  refused strange "not issued by an authority that is trusted here" --connect $to --ca ../stranger.pem
  refused crowd-strange "not issued by an authority" --connect $to --ca ../stranger.pem --simulate 2
  refused wrong-pin "not the one that --pin names, but sha256:[0-9a-f]*" --connect $to --pin "$(pin_of ../other.pem)"
  refused not-enet "no server answers" --connect 127.0.0.1:${ports[1]} --patience 0.5
  joined=$(grep -c joined both.log)
  kill -TERM $server
  ends 0 $server both
  [ "$joined" -eq 9 ] || failed "$joined clients joined instead of 9"
}

other_certificate() {
  local kind=$1 text=$2 server pinned
  server $kind --listen-web 127.0.0.1:0 --certificate ../$kind.pem --key ../$kind.key
  server=$last
  refused client-$kind "$text" --connect wss://127.0.0.1:$port --ca ../authority.pem
  # A pin stands for authority and name, not for the time.
  pinned="$bin/gi-client --connect wss://127.0.0.1:$port --pin $(pin_of ../$kind.pem) $view --updates 2"
  start pinned-$kind $pinned
  ends $([ $kind = expired ] && echo 4 || echo 0) $last pinned-$kind
  kill -TERM $server
  ends 0 $server $kind
}

other_name() { other_certificate other "for another name than 127.0.0.1"; }
expired() { other_certificate expired "has expired"; }

# Lost, and harmed: a bit, or bytes that come twice, end the connection and nothing else.
harmed() {
  local harm=$1 server tap
  web harmed --rate 40
  tap $harm "$port" $harm 20000
  start through-$harm "$bin/gi-client" --connect wss://127.0.0.1:$port --ca ../authority.pem $view \
    --updates $((60 * slower)) --expect-proofs
  ends 0 $last through-$harm
  says through-$harm "2 connections, resumed"
  kill $tap
  kill -TERM $server
  ends 0 $server harmed
}
harm_by_cut() { harmed cut; }
harm_by_flip() { harmed flip; }
harm_by_replay() { harmed replay; }

# What is seen on the way. In clear, and under the masks of WebSockets, it can be found.
seen() {
  local kind=$1 count=$2 server tap
  echo "open sesame, says nobody" >token
  chmod 600 token
  server seen-$kind --listen-web 127.0.0.1:0 "${@:3}" --token-file token --no-culling --backend raw
  server=$last
  tap tap-$kind "$port"
  start secrets-$kind python3 "$here/web_peer.py" secrets $kind://127.0.0.1:$port "$(cat token)"
  ends 0 $last secrets-$kind
  kill $tap $server
  ends 0 $server seen-$kind
  python3 "$here/find_secrets.py" tap-$kind.capture secrets-$kind.log >found
  grep -qx "$count of 3" found || failed "$kind: $(cat found) secrets were found instead of $count"
}
seen_in_clear() { seen ws 3 --insecure-web; }
seen_encrypted() { seen wss 0 --certificate ../server.pem --key ../server.key; }

# Who answers with a redirect is not followed, not even where another server is ready: its user did not choose
# that one, and in clear it may be another machine. The same holds for a proxy of the environment.
redirected() {
  local kind=$1 server from code where trusted=()
  [ $kind = ws ] || trusted=(--ca ../authority.pem)
  echo "open sesame, says nobody" >token
  chmod 600 token
  if [ $kind = ws ]; then
    server there --listen-web 127.0.0.1:0 --insecure-web --token-file token
  else
    server there --listen-web 127.0.0.1:0 --certificate ../server.pem --key ../server.key --token-file token
  fi
  server=$last
  start from python3 "$here/web_redirect.py" from.port "127.0.0.1:$port" \
    $([ $kind = ws ] || echo ../server.pem ../server.key)
  from=$last
  for code in 301 302 303 307 308; do
    for where in "\"[a-z]*://127.0.0.1:$port/\"" "\"//127.0.0.1:$port/\"" '"/elsewhere"' '/\\x1b\[2J"'; do
      start client "$bin/gi-client" --connect $kind://127.0.0.1:$(port_of from) "${trusted[@]}" $view \
        --token-file token --updates 2 --patience 1
      ends 4 $last "client ($code)"
      says client "a redirect (HTTP $code) to .*$where, which is not followed"
    done
  done
  start crowd "$bin/gi-client" --connect $kind://127.0.0.1:$port "${trusted[@]}" --simulate 2 --gltf $room \
    --token-file token --updates 2
  ends 0 $last crowd
  grep -q "more:" from.log && failed "who redirects was sent more than a request"
  kill $from $server
  ends 0 $server there
  [ "$(grep -c joined there.log)" -eq 2 ] || failed "a redirect was followed"
}
redirected_in_clear() { redirected ws; }
redirected_encrypted() { redirected wss; }
proxied() {
  local server
  server plain --listen-web 127.0.0.1:0 --insecure-web
  server=$last
  start proxy python3 "$here/web_redirect.py" proxy.port "127.0.0.1:$port"
  start client env http_proxy=http://127.0.0.1:$(port_of proxy) "$bin/gi-client" \
    --connect ws://127.0.0.1:$port $view --updates 2
  ends 0 $last client
  [ -s proxy.log ] && failed "a proxy was asked"
  kill -TERM $server
  ends 0 $server plain
}

beside harm_by_cut harm_by_flip harm_by_replay both other_name expired seen_in_clear seen_encrypted \
  redirected_in_clear redirected_encrypted proxied
finish
