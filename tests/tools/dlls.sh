#!/usr/bin/env bash
# dlls.sh OBJDUMP FILE...: each needs the system's own DLLs and no others.
set -euo pipefail
objdump=$1
shift
for file in "$@"; do
  needed=$("$objdump" -p "$file" | awk '/DLL Name:/ {print tolower($3)}')
  [ -n "$needed" ]
  if others=$(grep -vxE '(kernel32|advapi32|bcrypt|msvcrt|user32|shell32|ws2_32)\.dll' <<<"$needed"); then
    echo "$file needs $others" >&2
    exit 1
  fi
done
