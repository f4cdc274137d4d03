#!/usr/bin/env bash
# Recordings and servers of others: kinds that are not known, as many volumes as there may be.
. "$(dirname "$0")/common.sh"
odd_containers=$2 odd_server=$3 render=$4
"$odd_containers" || failed "odd_containers"

# play NAME OPTIONS...: a server of a recording; its process in $server, its address in $address.
play() {
  local name=$1
  shift
  rm -f "$name.port"
  start "$name" "$bin/gi-server" "$@" --port-file "$name.port"
  server=$last
  address=127.0.0.1:$(port_of "$name")
}

# Volumes of unknown kinds are left out, which is said once, and not only they are there.
unknown_kind() {
  local server address
  play unknown --play ../unknown.gic --loop --proofs --rate 20
  start known "$bin/gi-client" --connect $address --updates 9 --expect-proofs
  ends 0 $last known
  says known " \(9\|1[0-9]\) proofs, 0 failed" # more where some came at once
  kill $server
  ends 0 $server unknown
  [ "$(grep -c "1 of 2 volumes are left out: volume skin is of kind 77, which" unknown.log)" = 1 ] ||
    { failed "it was not said once what is left out"; cat unknown.log; }
  start alone "$bin/gi-server" --play ../alone.gic
  ends 3 $last alone
  says alone "no volume of it can be played: volume skin is of kind 77.*; a newer gi-server may"

  # What would take more memory than it may is refused.
  start great "$bin/gi-server" --play ../great.gic --max-memory 1
  ends 3 $last great
  says great "great.gic: streaming it takes up to 4 MiB, and 1 are allowed; --max-memory 4 allows it"
  start great "$bin/gi-server" --play ../great.gic --max-memory 4 --updates 1
  ends 0 $last great
}

# A client says so too.
unusable() {
  local address load
  start server "$odd_server" odd.port
  address=127.0.0.1:$(port_of odd)
  for load in "--updates 1" "--simulate 2 --updates 1"; do
    start unusable "$bin/gi-client" --connect $address $load
    ends 3 $last unusable
    says unusable "cannot be used: no kind of that number or name is built in or was given; .* a newer one may"
  done
}

# Whatever volumes and textures are called, they are played, recorded, drawn, and in tables.
any_name() {
  local server address
  play names --play ../names.gic --loop --proofs --rate 20 --log-updates log.csv --stats-file stats.jsonl
  start client "$bin/gi-client" --connect $address --updates 5 --expect-proofs --record record.gic \
    -o textures --frames 1
  ends 0 $last client
  "$bin/gi-client" --connect $address --updates 2 --stats json >client.json 2>/dev/null || failed "no summary"
  kill $server
  ends 0 $server names
  start again "$bin/gi-server" --play record.gic --updates 1
  ends 0 $last again
  start render "$render" --gltf $room --stream ../names.gic --size 16x9 --samples 1 -o drawn.png
  ends 0 $last render
  python3 - log.csv stats.jsonl client.json <<'END' || failed "tables cannot be read"
import csv, json, sys
head, *rows = csv.reader(open(sys.argv[1], newline=""))
assert head[8:] == ['=a,\\x1b[2J.sky/light,"\\x0a', "=a,\\x1b[2J..."], head
assert rows and all(len(row) == len(head) for row in rows), rows
for name in sys.argv[2:]:
    for line in open(name):
        json.loads(line)
END
  [ "$(ls textures | sed 's/\.[0-9]*\.png$//' | sort -u | tr '\n' ' ')" = '%3Da%2C%1B%5B2J.%2E%2E %3Da%2C%1B%5B2J.sky%2Flight%2C%22%0A ' ] ||
    failed "textures became $(ls textures)"
}

# Subscribing to all volumes at once is not too much, whatever the delivery.
many_volumes() {
  local server address delivery load
  play many --play ../many.gic --backend zstd --loop --proofs --wait 1 --rate 20
  for delivery in unicast shared; do
    for load in "--subscribe all" "--simulate 2"; do
      start all "$bin/gi-client" --connect $address --delivery $delivery $load --updates 5 --expect-proofs
      ends 0 $last all
      says all " 0 failed"
    done
  done
  kill $server
  ends 0 $server many
}

# Nor are updates that come faster than that many messages a second, each of which is answered.
fast() {
  local server address
  play fast --play ../unknown.gic --loop --rate 1000 --proofs
  start fast-client "$bin/gi-client" --connect $address --updates 1500 --expect-proofs
  ends 0 $last fast-client
  kill $server
  ends 0 $server fast
}

# What the operator says holds.
too_many() {
  local server address
  play few --play ../unknown.gic --loop --rate 1000 --max-messages 100
  start too-many "$bin/gi-client" --connect $address --updates 1500
  ends 4 $last too-many
  says too-many "too many messages"
}

# A file that becomes another one while it is played: of other volumes, or cut short.
replaced() {
  local server address other
  for other in ../many.gic ../alone.gic; do
    cp ../unknown.gic played.gic
    play replaced --play played.gic --loop --rate 20
    cp $other next.gic && mv next.gic played.gic
    ends 3 $server replaced
    says replaced "played.gic: .*\(was replaced by a recording of other volumes\|no volume of it can be played\)"
  done
}

# Of the same volumes it is played on, which is said.
same() {
  local server address
  cp ../probes.gic played.gic
  play same --play played.gic --loop --rate 20 --backend zstd
  cp ../probes.gic next.gic && mv next.gic played.gic
  wait_for same "played.gic: is another file than before; of it [0-9]* frames are played from here on"
  kill $server
  ends 0 $server same

  cp ../probes.gic played.gic
  play cut --play played.gic --loop --rate 20 --backend zstd
  truncate -s $(($(stat -c %s played.gic) * 3 / 4)) played.gic
  ends 3 $server cut
  says cut "played.gic: .*get the recording again"
}

# A server that stood still while its clients knocked lets them in when it goes on.
still() {
  local server address name clients=()
  play still --play ../unknown.gic --loop --proofs --rate 20 --control control
  for name in first second third; do
    start $name "$bin/gi-client" --connect $address --timeout 1 --patience 60 --expect-proofs
    clients+=("$last")
  done
  until_true all_are_sent || failed "nothing came"
  kill -STOP $server
  # So long that each has given up an attempt to come back, which takes two seconds.
  for name in first second third; do wait_for $name "connection lost"; done
  sleep 2.5
  kill -CONT $server
  wait_for still "joined as\|came back" 6
  until_true all_are_sent || failed "nothing came afterwards"
  for name in first second third; do
    kill -INT ${clients[0]}
    ends 0 ${clients[0]} $name
    clients=("${clients[@]:1}")
  done
  kill $server
  ends 0 $server still
}
# all_are_sent: there are three clients, and each was sent some updates over its connection.
all_are_sent() { "$bin/gi-server" --ask control list | awk 'NR > 1 {++all; n += $6 >= 10} END {exit !(all == 3 && n == 3)}'; }

beside still any_name many_volumes fast unknown_kind unusable too_many replaced same
finish
