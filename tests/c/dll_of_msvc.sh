#!/usr/bin/env bash
# dll_of_msvc.sh CLANG LLD_LINK INCLUDE SYMBOLS DLL IMPORT_LIBRARY [EMULATOR...]: a program made for
# Microsoft's ABI calls the DLL, and finds every symbol in its import library. It has no runtime library.
set -euo pipefail
clang=$1 link=$2 include=$3 symbols=$4 dll=$5 library=$6
shift 6
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
{
  printf '#define GICODEC_SHARED\n#include <gicodec/c/gicodec.h>\n'
  printf 'int _fltused;\nconst void* volatile all[] = {\n'
  sed 's/\(.*\)/    (const void*)\&\1,/' "$symbols"
  printf '};\n'
  cat <<'SOURCE'
int start(void) {
  for (unsigned i = 0; i < sizeof all / sizeof *all; ++i) {
    if (!all[i]) return 10;
  }
  gicodec_encoder* encoder = 0;
  if (gicodec_encoder_create(0, 0, &encoder) != GICODEC_INVALID_ARGUMENT) return 11;
  const char* text = gicodec_status_text(GICODEC_INVALID_ARGUMENT);
  return text && text[0] ? 0 : 12;
}
SOURCE
} >"$work/program.c"
"$clang" --target=x86_64-pc-windows-msvc -ffreestanding -std=c99 -Wall -Wextra -Werror -Wno-pedantic \
  -I"$include" -c "$work/program.c" -o "$work/program.obj"
"$link" -nologo -entry:start -subsystem:console -nodefaultlib -out:"$work/program.exe" \
  "$work/program.obj" "$library"
cp "$dll" "$work"
cd "$work"
"$@" ./program.exe
