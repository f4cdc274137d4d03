#!/usr/bin/env bash
# Manual pages hold what --help says, and depend on nothing but that: no date, no zone, no language.
#   man_pages.sh GENERATE HELP2MAN VERSION PAGE PROGRAM INCLUDED
set -u
generate=$1 help2man=$2 version=$3 page=$4 program=$5 included=$6
failures=0
failed() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}
# text of a page, without the marks of troff
text=$(sed -e 's/\\f.//g; s/\\-/-/g; s/\\e/\\/g; s/\\[,\/]//g; s/\\&//g' "$page")

# Every option, setting and exit code of --help, with its first line of explanation, has its paragraph.
tagged=0
last=
while IFS= read -r line; do
  if [[ "$line" =~ ^\ {1,10}([^\ ].*[^\ ]|[^\ ])\ {2,}([^\ ].*)$ ]]; then
    tag=${BASH_REMATCH[1]} told=${BASH_REMATCH[2]}
  elif [[ "$line" =~ ^\ {20,}([^\ ].*)$ && -n "$last" ]]; then
    tag=$last told=${BASH_REMATCH[1]}
  else
    last=
    [[ "$line" =~ ^\ \ (-.*)$ ]] && last=${BASH_REMATCH[1]}
    continue
  fi
  last=
  tagged=$((tagged + 1))
  [[ "$text" == *$'\n.TP\n'"$tag"$'\n'"$told"* ]] || failed "$page lacks \"$tag\": $told"
done < <("$program" --help)
[ "$tagged" -ge 10 ] || failed "--help of $program has $tagged explanations"
for section in NAME SYNOPSIS DESCRIPTION OPTIONS '"EXIT STATUS"' EXAMPLES '"SEE ALSO"'; do
  [ "$(grep -cx "\.SH $section" "$page")" = 1 ] || failed "$page has no section $section, or several"
done

# Another day, zone and language, the same bytes.
again=$(mktemp)
trap 'rm -f "$again"' EXIT
TZ=Asia/Tokyo LANG=de_DE.UTF-8 SOURCE_DATE_EPOCH=1700000000 \
  "$generate" "$help2man" "$program" "$included" "$version" "$again" || failed "$generate"
cmp "$page" "$again" || failed "$page depends on more than the program"
exit $((failures > 0))
