#!/usr/bin/env bash
# A shared library exports what public headers declare, in C++ and in C, and nothing else.
#   library_exports.sh NM INCLUDE_FOLDER LIBRARY
set -euo pipefail
nm=$1 include=$2 library=$3

symbols=$("$nm" -D --defined-only -C "$library" | cut -d' ' -f3- |
  sed -E 's/^(vtable|typeinfo|typeinfo name) for //' | sort -u)
strangers=$(grep -vE '^((non-virtual thunk to )?gicodec::|gicodec_[a-z0-9_]+$)' <<<"$symbols" || true)
hidden=$(grep -E '::State(::|$)' <<<"$symbols" || true)
names=$(sed -nE 's/^(non-virtual thunk to )?gicodec::([A-Za-z0-9_]+).*/\2/p' <<<"$symbols" | sort -u)
for name in $names; do
  grep -qrw "$name" "$include" || strangers+=$'\n'"gicodec::$name"
done
for name in $(grep -E '^gicodec_' <<<"$symbols"); do
  grep -qrw "$name" "$include/c" || strangers+=$'\n'"$name"
done
if [ -n "${strangers//$'\n'/}" ] || [ -n "$hidden" ]; then
  printf 'library_exports: %s exports what no public header declares:\n%s\n%s\n' "$library" \
    "$strangers" "$hidden" >&2
  exit 1
fi
[ "$(wc -l <<<"$symbols")" -gt 100 ]
echo "$(wc -l <<<"$symbols") symbols, all of the API"
