#!/usr/bin/env bash
# The installed unit names the installed program, and systemd takes it.
. "$(dirname "$0")/common.sh"
build=$2

cmake --install "$build" --component service --prefix "$work/usr" >install.log || failed "install"
unit=usr/lib/systemd/system/gi-server.service
grep -q "^ExecStart=$work/usr/bin/gi-server " $unit || failed "ExecStart is no path of the program"
grep -q "@" <(grep -v "^#\|@system-service\|@privileged" $unit) && failed "something was not filled in"
# Every option that it gives is known.
sed -n 's/^ExecStart=[^ ]* //p' $unit | grep -o -e "--[a-z-]*" | while read -r option; do
  "$bin/gi-server" --help | grep -qe "$option" || echo "$option"
done >unknown
[ -s unknown ] && failed "unknown options: $(cat unknown)"
if type systemd-analyze >/dev/null 2>&1; then
  mkdir -p usr/bin
  ln -s "$bin/gi-server" usr/bin
  systemd-analyze --man=no verify $unit >verify 2>&1 || failed "systemd-analyze refuses the unit"
  [ -s verify ] && failed "$(cat verify)"
fi
finish
