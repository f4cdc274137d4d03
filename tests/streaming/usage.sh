#!/usr/bin/env bash
# Exit codes and messages of wrong usage.
. "$(dirname "$0")/common.sh"

# expect CODE TEXT COMMAND...
expect() {
  local code=$1 text=$2 got
  shift 2
  output=$("$@" 2>&1)
  got=$?
  if [ "$got" -ne "$code" ] || [[ "$output" != *"$text"* ]]; then
    failed "$* : exit code $got instead of $code, or no \"$text\" in: $output"
  fi
}

programs() {
  for program in gi-server gi-client gi-relay; do
    expect 0 "Exit codes" "$bin/$program" --help
    expect 0 "$program" "$bin/$program" --version
    expect 2 "not expected: --no-such-flag;" "$bin/$program" --no-such-flag
  done
}
nonsense() {
  expect 2 "--simulate takes no --record" "$bin/gi-client" --connect 127.0.0.1:1 --simulate 2 --record x.gic
  expect 2 "--discard" "$bin/gi-client" --connect 127.0.0.1:1 --simulate 2 --discard --expect-proofs
  expect 2 "--record: expected a file" "$bin/gi-client" --connect 127.0.0.1:1 --record -
  # Numbers that do not fit, and what could never be.
  for updates in -1 99999999999999999999; do
    expect 2 "\"$updates\" is no whole number from 0 to 2147483647" "$bin/gi-client" --connect 127.0.0.1:1 --updates $updates
    expect 2 "\"$updates\" is no whole number from 0 to 2147483647" "$bin/gi-client" --connect 127.0.0.1:1 --budget-bytes $updates
    expect 2 "\"$updates\" is no whole number from 0 to 2147483647" "$bin/gi-server" $small --updates $updates
  done
  expect 2 "\"-1\" is no whole number from 0 to" "$bin/gi-client" --connect 127.0.0.1:1 --max-record-mb -1
  expect 2 "--wait 9 is for more clients than --max-clients 8" "$bin/gi-server" $small --wait 9 --max-clients 8
  expect 2 "not expected: --grid 4x4x4;" "$bin/gi-client" --grid 4x4x4
  expect 2 "--play" "$bin/gi-server"
  expect 2 "--loop is for --play" "$bin/gi-server" $small --loop
  expect 4 "there is no folder nowhere; make it first" "$bin/gi-server" $small --port-file nowhere/port
  expect 2 "--scene or --gltf" "$bin/gi-server"
  expect 2 "unknown scene" "$bin/gi-server" --scene nowhere
  expect 2 "--listen" "$bin/gi-server" --scene villa --listen 127.0.0.1
  expect 2 "--fine" "$bin/gi-server" --scene villa --fine 0x1x1
  # What is played was traced already.
  for flag in "--fine 4x4x4" "--kind voxels" "--set size=1" "--grid 4x4x4" "--bounds 0,0,0,1,1,1" "--rays 16" \
      "--mode noisy"; do
    expect 2 "${flag%% *} is for scenes that are traced" "$bin/gi-server" --play x.gic $flag
  done
  expect 2 "--backend" "$bin/gi-server" --scene villa --backend hevc
  expect 2 "backend native" "$bin/gi-server" $small --preset huge
  expect 4 "missing.gic" "$bin/gi-server" --play missing.gic
  echo "not a container" >bad.gic
  expect 3 "bad.gic" "$bin/gi-server" --play bad.gic
  expect 4 "secret" "$bin/gi-server" $small --token-file secret
  touch empty
  expect 3 "empty" "$bin/gi-server" $small --token-file empty
  expect 4 "nowhere" "$bin/gi-server" $small --stats-file nowhere/file
}
# Reports take the place of nothing but reports.
reports() {
  echo "a user's own" > own
  for option in --stats-file --log-updates --port-file; do
    expect 2 "own: holds something else" "$bin/gi-server" $small --updates 1 $option own
  done
  expect 2 "own: holds something else" "$bin/gi-relay" --to 127.0.0.1:1 --seconds 1 --port-file own
  [ "$(cat own)" = "a user's own" ] || failed "a report replaced something else"
  echo 12345 > token
  chmod 600 token
  expect 2 "token: is one of the inputs" "$bin/gi-server" $small --updates 1 --token-file token --port-file token
  expect 2 "two reports" "$bin/gi-server" $small --updates 1 --stats-file s --log-updates s
  [ "$(cat token)" = 12345 ] || failed "a report replaced the token"
  # Too little time for a rate is no rate.
  expect 0 "1 update in 0.0 s, 0.0 per second" "$bin/gi-server" $small --updates 1
  for i in 1 2; do
    expect 0 "" "$bin/gi-server" -q $small --updates 1 --stats-file s --log-updates l --port-file p
  done
}
taken() {
  server taken --quiet
  expect 4 "in use" "$bin/gi-server" $small --listen 127.0.0.1:$port
  expect 4 "cannot be listened to" "$bin/gi-relay" --to 127.0.0.1:1 --listen 127.0.0.1:$port
  expect 2 "--connect" "$bin/gi-client"
  expect 2 "--connect" "$bin/gi-client" --connect localhost
  expect 2 "--subscribe" "$bin/gi-client" --connect 127.0.0.1:1 --subscribe 1-0,0-1,0-1
  expect 2 "-o DIR and --frames" "$bin/gi-client" --connect 127.0.0.1:1 --frames 3
  expect 2 "--orbit" "$bin/gi-client" --connect 127.0.0.1:1 --orbit
  expect 2 "--camera" "$bin/gi-client" --connect 127.0.0.1:1 --camera 1,2
  expect 2 "--discard" "$bin/gi-client" --connect 127.0.0.1:1 --discard
  expect 2 "--size" "$bin/gi-client" --connect 127.0.0.1:1 --frames 1 -o a --size 0x0
  expect 3 "--subscribe" "$bin/gi-client" --connect 127.0.0.1:$port --subscribe 0-99,0-1,0-1 --seconds 20
  expect 2 "--overwrite is for -o DIR and --record" "$bin/gi-client" --connect 127.0.0.1:1 --overwrite
}
# What would be less protected than it looks is refused, and files that do not fit are named.
web="$bin/gi-server $small --listen-web"
encrypted() {
  expect 2 "--listen-web needs --certificate and --key" $web 127.0.0.1:0
  expect 2 "name both" $web 127.0.0.1:0 --certificate missing.pem
  expect 2 "can be reached from other machines" $web "[::]:0" --insecure-web
  expect 2 "leave one of them out" $web 127.0.0.1:0 --insecure-web --certificate a --key b
  expect 2 "are for --listen-web" "$bin/gi-server" $small --certificate a --key b
  expect 2 "--listen-web: expected an address" $web ::1:0 --insecure-web
  echo "not a container" >bad.gic
  echo 12345 >token
  chmod 600 token
  expect 4 "missing.pem: No such file" $web 127.0.0.1:0 --certificate missing.pem --key missing.pem
  expect 4 "bad.gic: " $web 127.0.0.1:0 --certificate bad.gic --key bad.gic
  expect 4 "missing-users: cannot be read" "$bin/gi-server" $small --users missing-users
  expect 3 "bad.gic: line 1: is no line of a user" "$bin/gi-server" $small --users bad.gic
  expect 2 "exclude each other" "$bin/gi-server" $small --users bad.gic --token-file token
  expect 2 "use wss://192.0.2.1:1" "$bin/gi-client" --connect ws://192.0.2.1:1
  expect 2 "are for --connect wss" "$bin/gi-client" --connect 127.0.0.1:1 --pin sha256:00
  expect 2 "64 hexadecimal digits" "$bin/gi-client" --connect wss://127.0.0.1:1 --pin sha256:00
  expect 2 "a pin needs no authority" "$bin/gi-client" --connect wss://127.0.0.1:1 --ca bad.gic --pin sha256:00
  expect 4 "missing.pem: No such file" "$bin/gi-client" --connect wss://127.0.0.1:1 --ca missing.pem
  expect 4 "--ca takes a PEM file" "$bin/gi-client" --connect wss://127.0.0.1:1 --ca bad.gic
}
another() {
  server web --quiet --listen-web 127.0.0.1:0 --insecure-web
  expect 4 "in use" $web 127.0.0.1:$port --insecure-web
  # Another kind of server than the one that is asked for.
  expect 4 "wss://127.0.0.1:$port: no server answers" "$bin/gi-client" --connect wss://127.0.0.1:$port --patience 0.5
}
nobody_encrypted() {
  expect 4 "wss://127.0.0.1:1: no server answers" "$bin/gi-client" --connect wss://127.0.0.1:1 --patience 0.5
}
kinds() {
  expect 2 "--rays is for probes; photons have --set" "$bin/gi-server" --scene tomb --kind photons --rays 5
  expect 2 "every bit of what is streamed counts" \
    "$bin/gi-server" --scene tomb --kind photons --set photons=100 --set max-batches=2 --max-error 8
}
# A server that waits for others: nothing came, so that there is nothing to say of its proofs.
waits() {
  server waits --quiet --wait 2
  expect 1 "no update came, and with it no proof; --record had nothing to write" "$bin/gi-client" --connect 127.0.0.1:$port --seconds 1 --expect-proofs --record nothing.gic
  [[ "$output" == *"no proofs came"* ]] && failed "$output"
  expect 1 "nothing.gic: is not there, since no update came" "$bin/gi-client" --connect 127.0.0.1:$port --seconds 1 --record nothing.gic
  [ -z "$(ls | grep nothing)" ] || failed "a recording of nothing is there"
}
# Nobody there: the reason, and nothing about what nobody could send.
nobody() {
  expect 4 "127.0.0.1:1: no server answers" "$bin/gi-client" --connect 127.0.0.1:1 --expect-proofs "$@"
  [[ "$output" == *"no proofs came"* ]] && failed "$*: $output"
}
nobody_for_a_while() { nobody --seconds=0.5; }
nobody_for_two() { nobody --simulate=2 --seconds=0.5; }
impatient() { nobody --patience=0.5; }
two_impatient() { nobody --simulate=2 --patience=0.5; }
relays() {
  expect 2 "--to" "$bin/gi-relay"
  expect 2 "--to 127.0.0.1:0: a server has a port" "$bin/gi-relay" --to 127.0.0.1:0
  for at in 127.0.0.1 0.0.0.0; do
    expect 2 "--to 127.0.0.1:4700 is where it listens itself" "$bin/gi-relay" --listen $at:4700 --to 127.0.0.1:4700
  done
}
beside nobody_encrypted nobody_for_a_while nobody_for_two impatient two_impatient waits another
beside taken reports nonsense encrypted kinds relays programs
finish
