#!/usr/bin/env bash
# kernel_linkage.sh NM OBJECT...: objects of kernels have no function that other objects could take
# from them, since it may need instructions that the machine lacks. Each has one table.
set -uo pipefail
nm=$1
shift
failures=0 tables=0
for object in "$@"; do
  symbols=$("$nm" -gC --defined-only "$object") || exit 1
  functions=$(grep -E ' [TWi] ' <<< "$symbols")
  if [ -n "$functions" ]; then
    printf 'FAILED: %s has functions for all to call:\n%s\n' "$object" "$functions"
    failures=$((failures + 1))
  fi
  tables=$((tables + $(grep -c ' gicodec::TableOf<.*>::kernels$' <<< "$symbols")))
done
if [ "$tables" -ne $# ] || [ $# -eq 0 ]; then
  echo "FAILED: $# objects have $tables tables"
  failures=$((failures + 1))
fi
[ "$failures" -eq 0 ] && echo "$tables tables, and nothing else that can be called"
exit $((failures > 0))
