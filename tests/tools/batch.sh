#!/usr/bin/env bash
# batch.sh GICODEC TESTDATA: plans of many jobs, run, ended in between, and run again.
set -uo pipefail
gicodec=$(realpath "$1")
testdata=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit
failures=0
check() { # WHAT COMMAND...
  local what=$1
  shift
  "$@" || { echo "FAILED: $what" >&2; failures=$((failures + 1)); }
}
gicodec() { "$gicodec" "$@"; }
export -f gicodec
export gicodec

mkdir -p rooms out
for i in 1 2 3; do cp -r "$testdata/tomb-converged" "rooms/room $i's"; done
cp -r "$testdata/villa-noisy" noisy
cat >manifest.json <<EOF
{"flags": ["--preset", "turbo"],
 "jobs": [{"each": "rooms", "output": "out/{}.gic"},
          {"inputs": ["noisy/"], "output": "out/noisy.gic", "flags": ["--max-error", "color=1", "--region", "4x4x4"]}]}
EOF
check "a plan" gicodec encode -q --jobs manifest.json >plan.txt
check "four lines" [ "$(wc -l <plan.txt)" = 4 ]
run() { bash plan.txt 2>said.txt; }
stamps() { stat -c '%n %y %s' out/*.gic; }

check "the plan runs" run
for i in 1 2 3; do check "room $i" gicodec verify -q "out/room $i's.gic" "rooms/room $i's" >/dev/null; done
check "the noisy one" gicodec verify -q --max-error color=1 out/noisy.gic noisy >/dev/null
before=$(stamps)
check "again" run
check "finished outputs are kept" [ "$before" = "$(stamps)" ]

# Whatever is wrong with an output, it is made anew, and nothing else is.
cp out/noisy.gic whole.gic
for fault in damaged cut other flags none; do
  case $fault in
    damaged) printf '\377' | dd of=out/noisy.gic bs=1 seek=3000 conv=notrunc status=none ;;
    cut) truncate -s -200 out/noisy.gic ;;
    other) cp "out/room 1's.gic" out/noisy.gic ;;
    flags) gicodec encode -q --resume --preset fast -o out/noisy.gic noisy/ ;;
    none) rm out/noisy.gic ;;
  esac
  touch -d yesterday out/room*
  before=$(stat -c '%n %y' out/room*)
  check "run after: $fault" run
  check "made anew: $fault" cmp -s out/noisy.gic whole.gic
  check "the others are kept: $fault" [ "$before" = "$(stat -c '%n %y' out/room*)" ]
done

# Killed: what is left over is written again; but not what another one writes.
rm out/noisy.gic
head -c 1000 whole.gic >out/noisy.gic.partial
check "after a killed one" run
check "the same bytes" cmp -s out/noisy.gic whole.gic
check "nothing is left over" [ ! -e out/noisy.gic.partial ]
rm out/noisy.gic
head -c 1000 whole.gic >out/noisy.gic.partial
(
  exec 9<>out/noisy.gic.partial
  flock 9
  bash plan.txt 2>said.txt
)
check "another one writes it" grep -q "another program is writing it" said.txt
check "it was left alone" [ "$(stat -c %s out/noisy.gic.partial)" = 1000 ]
rm out/noisy.gic.partial
echo "mine" >out/noisy.gic
bash plan.txt 2>said.txt
check "a file of somebody's is kept" [ "$(cat out/noisy.gic)" = mine ]
rm out/noisy.gic

# Names that a shell would read otherwise.
mkdir -p 'room{1,2}'
cp rooms/room*1*/* 'room{1,2}/'
printf '{"jobs": [{"output": "out/{a.gic,--max-error=color=9}", "inputs": ["room{1,2}/"]}]}' >odd.json
gicodec encode -q --jobs odd.json >odd.txt
check "a plan with braces" bash odd.txt
check "its output" [ -s 'out/{a.gic,--max-error=color=9}' ]

# Faults of manifests are found before anything runs.
refused() { # CODE WORDS JSON
  printf '%s' "$3" >bad.json
  gicodec encode --jobs bad.json >bad.txt 2>said.txt
  check "exit code of $3" [ $? = "$1" ]
  check "$3: $(cat said.txt)" grep -qF -- "$2" said.txt
  check "no plan of $3" [ ! -s bad.txt ]
}
refused 3 "is no JSON" '{'
refused 3 'has no list "jobs"' '{}'
refused 3 'job 1 has a key "ouput"; it takes output' '{"jobs": [{"ouput": "a.gic"}]}'
refused 3 'needs "output", and either' '{"jobs": [{"output": "a.gic"}]}'
refused 3 "another job writes a.gic too" \
  '{"jobs": [{"output": "a.gic", "inputs": ["noisy"]}, {"output": "a.gic", "inputs": ["noisy"]}]}'
refused 3 "needs {} for the name" '{"jobs": [{"output": "a.gic", "each": "rooms"}]}'
refused 4 "nowhere" '{"jobs": [{"output": "a.gic", "inputs": ["nowhere"]}]}'
refused 2 "the job of a.gic: " '{"jobs": [{"output": "a.gic", "inputs": ["noisy"], "flags": ["--prest", "fast"]}]}'
for flags in '"--preset"' '"--preset", "storng"' '"--region", "0x0x0"' '"--layout", "zz"' '"--jobs", "m.json"' \
  '"--output=x"' '"--help"' '"noisy"' '"--", "noisy"'; do
  refused 2 "the job of a.gic: " '{"jobs": [{"output": "a.gic", "inputs": ["noisy"], "flags": ['"$flags"']}]}'
done
refused 2 "a job writes a file" '{"jobs": [{"output": "-", "inputs": ["noisy"]}]}'
refused 2 "nowhere" '{"jobs": [{"output": "nowhere/a.gic", "inputs": ["noisy"]}]}'
refused 3 "another job writes ./a.gic too" \
  '{"jobs": [{"output": "a.gic", "inputs": ["noisy"]}, {"output": "./a.gic", "inputs": ["noisy"]}]}'
refused 3 'is not a list of texts' '{"flags": "--preset", "jobs": [{"output": "a.gic", "inputs": ["noisy"]}]}'
gicodec encode --jobs manifest.json -o x.gic 2>said.txt
check "no -o beside --jobs" [ $? = 2 ]
gicodec encode noisy/ 2>said.txt
check "-o is asked for" grep -q -- "-o, --output is missing" said.txt
exit $((failures > 0))
