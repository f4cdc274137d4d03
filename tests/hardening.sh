#!/usr/bin/env bash
# hardening.sh READELF FILE...: programs and modules have what cmake/Harden.cmake asks
# for. Each proof is one that a build lacks whose compiler was not told.
set -uo pipefail
export LC_ALL=C  # bytes, not characters
readelf=$1
shift
failures=0

# has FILE WHAT TEXT PATTERN: the text has a line of the pattern.
has() {
  grep -qE -- "$4" <<< "$3" && return
  echo "FAILED: $1 has no $2"
  failures=$((failures + 1))
}

for file in "$@"; do
  # A module is a table of a few functions, none of which needs all of it.
  program=1
  [[ $file != *.so ]] || program=
  headers=$("$readelf" -W -h -l -d "$file") symbols=$("$readelf" -W --dyn-syms "$file")
  has "$file" "random address" "$headers" 'Type: +DYN'
  [ -z "$program" ] || has "$file" "mark of a position-independent program" "$headers" 'FLAGS_1.*PIE'
  has "$file" "read-only relocations" "$headers" 'GNU_RELRO'
  has "$file" "binding at the start" "$headers" 'FLAGS.*NOW'
  has "$file" "stack without code" "$headers" 'GNU_STACK.* RW +0x'
  has "$file" "canary" "$symbols" '__stack_chk_fail'
  [ -z "$program" ] || has "$file" "checked containers" "$symbols" '__glibcxx_assert_fail|__replacement_assert'
  if [ "$(uname -m)" = x86_64 ]; then
    # endbr64, of which some come with every program, and orq $0, (%rsp).
    marks=$(grep -aoP '\xf3\x0f\x1e\xfa' "$file" | wc -l)
    has "$file" "marks where branches land" "$([ "$marks" -lt 20 ] || echo many)" many
    probes=$(grep -aoP '\x48\x83(\x0c\x24|\x4c\x24.|\x8c\x24....)\x00' "$file" | wc -l)
    [ -z "$program" ] || has "$file" "probes of the stack" "$([ "$probes" -eq 0 ] || echo some)" some
  fi
  [ -z "$program" ] || has "$file" "checked functions" "$symbols" '__[a-z]+_chk(@|$)'
done
[ "$failures" -eq 0 ] && echo "all as expected"
exit $((failures > 0))
