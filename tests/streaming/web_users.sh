#!/usr/bin/env bash
# Users with tokens of their own, guesses, reloading; what the port answers to plain HTTP.
here=$(cd "$(dirname "$0")" && pwd)
. "$here/common.sh"
. "$here/certificates.sh"

for name in ada bob; do
  start add "$bin/gi-server" --add-user $name users
  ends 0 $last add
  mv add.log $name.token
  chmod 600 $name.token
  secret=$(cut -d: -f2 $name.token)
  [[ "$secret" =~ ^[0-9a-f]{64}$ ]] || failed "$name: no token was printed"
  grep -q "$secret" users && failed "the file of users holds a token"
done
[ "$(stat -c %a users)" = 600 ] || failed "others may read the users"
for wrong in "ada users:3:has a user ada" "a/b users:2:a name has" "ada .:4:cannot be written"; do
  IFS=: read -r arguments code text <<<"$wrong"
  start wrong "$bin/gi-server" --add-user $arguments
  ends $code $last wrong
  says wrong "$text"
done
"$bin/gi-server" --add-user eve users >/dev/full 2>unseen.log && failed "a token that nobody saw was given out"
says unseen "remove the line of eve from users, and add the user again"
sed -i /^eve:/d users
echo "ada:pbkdf2-sha256:0:00:00" >damaged
start damaged "$bin/gi-server" $small --users damaged
ends 3 $last damaged
says damaged "damaged: line 1: is no line of a user"

certificate new DNS:localhost,IP:127.0.0.1
cp server.pem live.pem
cp server.key live.key
echo "count me" >metrics-token
server server --listen 127.0.0.1:0 --listen-web 127.0.0.1:0 --certificate live.pem --key live.key \
  --users users --control control --rate 20 --stats-file stats.jsonl --proofs --metrics-token-file metrics-token
server=$last
ports=($port)
web=wss://127.0.0.1:${ports[1]} enet=127.0.0.1:${ports[0]}
for name in ada bob; do
  start $name "$bin/gi-client" --connect $web --ca authority.pem $view --token-file $name.token --expect-proofs
  eval "$name=$last"
done
start over-enet "$bin/gi-client" --connect $enet $view --token-file bob.token --updates 5 --expect-proofs
ends 0 $last over-enet
wait_for server "joined as client [0-9]* (unicast, user ada)"
until_true grep -q '"user":"bob"' stats.jsonl || failed "the statistics do not name users"
start list "$bin/gi-server" --ask control list
ends 0 $last list
says list " ada$"
says list " bob$"

# fetch PATH CURL-OPTIONS...: the answer's code and, in page, its body.
fetch() {
  local path=$1
  shift
  curl -s -o page -w '%{http_code}' --cacert authority.pem "$@" "https://127.0.0.1:${ports[1]}$path"
}
[ "$(fetch /health)" = 200 ] && grep -qx ok page || failed "/health"
[ "$(fetch /metrics)" = 404 ] || failed "metrics are shown to whom they are not for"
[ "$(fetch /metrics -H 'Authorization: Bearer guess')" = 404 ] || failed "a guess shows metrics"
# measured TEXT: once a second the metrics are new; waits until they have this, at most 120 s.
measured() {
  until_true in_metrics "$1" || failed "no $1 in the metrics: $(cat page)"
}
in_metrics() {
  [ "$(fetch /metrics -H 'Authorization: Bearer count me')" = 200 ] || failed "/metrics"
  grep -q "$1" page
}
measured 'gicodec_dropped_total{reason="left"} 1'
for line in "gicodec_clients 2" "gicodec_updates_total [1-9]" "gicodec_sent_bytes_total [1-9]" \
  'gicodec_latency_seconds{quantile="0.5"} 0\.' "gicodec_memory_bytes [1-9]"; do
  measured "^$line"
done
for path in / /x /metrics/ /healthy; do
  [ "$(fetch $path)" = 404 ] || failed "$path is answered"
done
[ "$(fetch /health -X POST)" = 404 ] || failed "POST is answered"
[ "$(fetch /health -H "X: $(printf '%08000d' 0)")" = 200 ] && failed "endless heads are read"
[ "$(fetch /health --tls-max 1.2)" = 000 ] || failed "an older TLS is spoken"
# A client that is told the wrong port, of a server that speaks TLS and HTTP.
start foreign python3 "$here/web_foreign.py" server.pem server.key foreign.port
foreign=$last
start stray "$bin/gi-client" --connect wss://127.0.0.1:$(port_of foreign) --ca authority.pem $view --updates 1
ends 4 $last stray
says stray "what answers there is no gi-server"
kill $foreign

# Without bob, who is sent away; and with another certificate from then on.
sed -i /^bob:/d users
cp new.pem live.pem
start half "$bin/gi-server" --ask control reload
ends 3 $last half
says half "is not the key to live.pem"
start unchanged "$bin/gi-client" --connect $enet $view --token-file bob.token --updates 2
ends 0 $last unchanged
cp new.key live.key
start reload "$bin/gi-server" --ask control reload
ends 0 $last reload
says reload "1 user, [01] connections\\? ended"
ends 4 $bob bob
says bob "operator"
echo nonsense >>users
start damaged "$bin/gi-server" --ask control reload
ends 3 $last damaged
says damaged "users: line 2: is no line of a user"
start still "$bin/gi-client" --connect $web --pin "$(pin_of new.pem)" $view --token-file ada.token --updates 5
ends 0 $last still

# Six guesses from one address: the last is not heard, and neither is who knows, for a while.
for i in 1 2 3 4; do
  [ $((i % 2)) = 0 ] && to="$enet" || to="$web --ca authority.pem"
  start guess "$bin/gi-client" --connect $to $view --token "ada:guess" --updates 1
  ends 4 $last guess
  says guess "token"
done
start late "$bin/gi-client" --connect $enet $view --token-file bob.token --updates 1
ends 4 $last late
start unheard "$bin/gi-client" --connect $web --ca authority.pem $view --token-file ada.token --updates 1
ends 4 $last unheard
measured "^gicodec_unheard_guesses_total 1"
kill -TERM $server
ends 0 $server server
ends 0 $ada ada
secret=$(cut -d: -f2 ada.token)
grep -q "$secret" server.log stats.jsonl && failed "a token was shown"
finish
