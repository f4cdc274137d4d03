# For the tests of the programs: a folder to work in, a scene of one triangle, and checks.
work=$(mktemp -d)
besides=()
stop_all() {
  local processes
  mapfile -t processes < <(jobs -p)
  [ ${#processes[@]} -eq 0 ] || kill "${processes[@]}" 2> /dev/null
  wait
}
trap 'stop_all; rm -rf "$work"' EXIT
cd "$work" || exit
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}
# expect CODE TEXT COMMAND...: the command ends with CODE and its message contains TEXT.
expect() {
  local code=$1 text=$2
  shift 2
  local output
  output=$("$@" 2>&1)
  local got=$?
  if [ "$got" -ne "$code" ] || [[ "$output" != *"$text"* ]]; then
    fail "$* : exit code $got instead of $code, or no \"$text\" in: $output"
  fi
}
# absent PATH...: nothing was left there.
absent() {
  local path
  for path in "$@"; do
    [ ! -e "$path" ] || fail "$path was left behind"
  done
}
# beside NAME COMMAND...: a command of this test, or a function, beside all else, until `together`; not
# more at a time than there are processors.
beside() {
  local name=$1
  shift
  while [ "$(jobs -pr | wc -l)" -ge "$processors" ]; do wait -n; done
  (
    trap - EXIT
    failures=0
    "$@"
    echo $failures > "$name.failures"
  ) > "$name.said" 2>&1 < /dev/null &
  besides+=("$name")
}
processors=$(nproc)
# together: waits for those beside.
together() {
  local name
  wait
  for name in ${besides[@]+"${besides[@]}"}; do
    cat "$name.said"
    [ "$(cat "$name.failures")" = 0 ] || fail "$name"
  done
  besides=()
}
# end: the test's result.
end() {
  together
  [ "$failures" -eq 0 ] && echo "all as expected"
  exit $((failures > 0))
}

# A triangle without thickness, lights and camera.
cat > plane.gltf <<'EOF'
{"asset":{"version":"2.0"},
 "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
 "bufferViews":[{"buffer":0,"byteLength":36}],
 "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
 "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
 "nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}
EOF
echo '{"asset":{"version":"2.0"},"extensionsRequired":["VENDOR_thing"]}' > needs.gltf
touch file
# shellcheck disable=SC2034
tiny=(--gltf plane.gltf --grid 3x3x3 --rays 16)
