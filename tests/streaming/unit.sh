#!/usr/bin/env bash
# The installed unit names the installed program, and systemd takes it.
. "$(dirname "$0")/common.sh"
build=$2

cmake --install "$build" --component service --prefix "$work/usr" >install.log || failed "install"
unit=usr/lib/systemd/system/gi-server.service
drop_in=$(find usr -name gi-server-web.conf)
for file in $unit "$drop_in"; do
  grep -q "^ExecStart=$work/usr/bin/gi-server " "$file" || failed "$file: ExecStart is no path of the program"
  grep -q "@" <(grep -v "^#\|@system-service\|@privileged" "$file") && failed "$file: something was not filled in"
  # Every option that it gives is known.
  sed -n 's/^ExecStart=[^ ]* //p' "$file" | grep -o -e "--[a-z-]*" | while read -r option; do
    "$bin/gi-server" --help | grep -qe "$option" || echo "$option"
  done >unknown
  [ -s unknown ] && failed "$file: unknown options: $(cat unknown)"
done
if type systemd-analyze >/dev/null 2>&1; then
  mkdir -p usr/bin
  ln -s "$bin/gi-server" usr/bin
  systemd-analyze --man=no verify $unit >verify 2>&1 || failed "systemd-analyze refuses the unit"
  [ -s verify ] && failed "$(cat verify)"
  mkdir $unit.d
  cp "$drop_in" $unit.d/web.conf
  systemd-analyze --man=no verify $unit >verify 2>&1 || failed "systemd-analyze refuses the drop-in"
  [ -s verify ] && failed "$(cat verify)"
fi
finish
