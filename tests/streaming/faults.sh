#!/usr/bin/env bash
# What goes wrong around the programs: standard error and reports that cannot be written, files that
# change beneath them, nonsense on sockets.
. "$(dirname "$0")/common.sh"
raw_peer=$2 raw_asker=$3

# served NAME PORT: a client gets what it asks for, and can check it. Where a machine is busy, the first
# updates come before the client has said what it sees, and are empty.
served() {
  start "$1" "$bin/gi-client" --connect "127.0.0.1:$2" $view --updates 12 --expect-proofs
  ends 0 $last "$1"
}

# A log that is closed, full, or a pipe that nobody reads ends nobody.
unwritable() {
  local way=$1
  shift
  case $way in
    closed) exec "$@" 2>&- ;;
    full) exec "$@" 2>/dev/full ;;
    broken) exec "$@" 2> >(:) ;;
  esac
}
unwritable_log() {
  local way=$1 server relay to
  start log-$way unwritable $way "$bin/gi-server" $small --proofs --rate 20 --port-file log-$way.port \
    --stats-file log-$way.jsonl
  server=$last
  to=$(port_of log-$way)
  start relay-$way unwritable $way "$bin/gi-relay" --to "127.0.0.1:$to" --port-file relay-$way.port
  relay=$last
  start client-$way unwritable $way "$bin/gi-client" --connect "127.0.0.1:$(port_of relay-$way)" \
    $view --updates 4 --expect-proofs
  ends 0 $last client-$way
  # Says something, and goes on.
  start short-$way unwritable $way "$bin/gi-client" --connect 127.0.0.1:$to $view --updates 1000000 --seconds 1
  ends 1 $last short-$way
  served after-$way "$to"
  kill -TERM $relay $server
  ends 0 $relay relay-$way
  ends 0 $server log-$way
  grep -v '^{"\(time\|summary\)":.*}$' log-$way.jsonl && failed "the statistics hold what is not theirs"
}
closed_log() { unwritable_log closed; }
full_log() { unwritable_log full; }
broken_log() { unwritable_log broken; }

# Reports on a full disk: clients get everything, then the exit code tells.
reports() {
  local report server
  ln -s /dev/full full
  for report in --stats-file --log-updates; do
    server report$report --proofs --rate 30 --updates 24 --wait 1 $report full
    server=$last
    served beside$report "$port"
    ends 4 $server report$report
    says report$report "full: could not be written"
  done
  start table "$bin/gi-server" $small --updates 1 >/dev/full
  ends 0 $last table
  start unprinted unprinted "$bin/gi-server" $small --updates 1 --stats json
  ends 4 $last unprinted
}
unprinted() { exec "$@" >/dev/full; }
# While it serves, with the time, for whoever watches.
watched() {
  local server
  ln -s /dev/full full
  server watched --proofs --rate 20 --updates 30 --wait 1 --stats-file full
  server=$last
  served beside-watched "$port"
  ends 4 $server watched
  says watched '^2.*Z gi-server: full: could not be written'
}

# The operator's socket: the server removes only its own.
foreign_socket() {
  server control --control socket --proofs
  local server=$last
  rm socket
  echo "a user's own" >socket
  kill -TERM $server
  ends 0 $server control
  [ "$(cat socket)" = "a user's own" ] || failed "the server removed what is not its own"
  rm socket
}

# Nonsense there leaves the server as it was.
# said FORMAT...: what the socket answers.
said() { printf "$@" | "$raw_asker" socket; }
asked() {
  local server held
  server asked --control socket --proofs --rate 20
  server=$last
  [[ $(said 'list\nmore') == *client* ]] || failed "list is not answered"
  [[ $(said '\033[2J\377\001\n') == *'unknown command "\x1b[2J\xff\x01"'* ]] || failed "binary is not refused"
  [[ $(said '%0300d' 0) == *"at most 256 bytes"* ]] || failed "a long line is not refused"
  [[ $(said '%01000000d\n' 0) == *"at most 256 bytes"* ]] || failed "a very long line is not refused"
  [ -z "$(said 'list')" ] || failed "half a command is answered"
  # Those who stay are sent away; the operator waits for that at most.
  start held "$raw_asker" socket 9
  held=$last
  wait_for held connected
  start patient "$bin/gi-server" --ask socket list
  ends 0 $last patient
  kill $held
  ends 143 $held held
  start wordy "$bin/gi-server" --ask socket "$(printf '%0300d' 0)"
  ends 2 $last wordy
  served after-asked "$port"
  kill -TERM $server
  ends 0 $server asked
}

# Neither does nonsense on the network, and the log stays short.
nonsense() {
  local server to kind begin=$SECONDS
  server nonsense --proofs --rate 20
  server=$last
  to=$port
  for kind in "$@"; do
    start $kind "$raw_peer" $kind 127.0.0.1:$to
    ends 0 $last $kind
    served after-$kind "$to"
  done
  kill -TERM $server
  ends 0 $server nonsense
  # 500 lines, then 10 a second, each with one that counts what is left out.
  local most=$((550 + 20 * (SECONDS - begin + 1))) lines
  lines=$(wc -l <nonsense.log)
  [ "$lines" -lt $most ] || failed "strangers fill the log: $lines lines, $most at most"
}
mutants() { nonsense transports mutants; }
crowds() {
  nonsense crowds
  says nonsense "lines are left out: clients come and go too fast"
}

# Tokens in files.
tokens() {
  local server file name code text
  echo "open sesame" >open
  printf 'open sesame\r\n' >kept
  chmod 644 open
  chmod 600 kept
  server tokens --token-file open --updates 4 --wait 1
  server=$last
  start same "$bin/gi-client" --connect 127.0.0.1:$port $view --token-file kept --updates 2
  ends 0 $last same
  ends 0 $server tokens
  says tokens "open: others may read the token; chmod 600 open"
  grep -q chmod same.log && failed "a token that others may not read is complained of"
  head -c 1000 /dev/zero >long
  for file in nowhere:4:"cannot be read" .:4:"cannot be read" /dev/null:3:"write the token there" \
    long:2:"use a shorter one"; do
    IFS=: read -r name code text <<<"$file"
    start token "$bin/gi-server" $small --token-file "$name"
    ends "$code" $last token
    says token "$text"
  done
}

beside crowds mutants asked closed_log full_log broken_log reports watched foreign_socket tokens
finish
