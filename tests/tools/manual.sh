#!/bin/sh
# The manual page has every command and every option that --help has, and troff takes it without a warning.
set -u
hooke="${HK_BUILD:?}/hooke" failed=0
dir=$(mktemp -d) && trap 'rm -rf "$dir"' EXIT || exit 1
fail() { echo "failed: $*"; failed=1; }

"${HK_ROOT:?}/tools/manual" "$hooke" >"$dir/hooke.1" || fail "no page is written"
# Without troff's own signs: text as a reader has it.
sed -e 's/\\-/-/g' -e 's/^\.B //' "$dir/hooke.1" >"$dir/text"

count=0
for command in $("$hooke" --help | sed -n 's/^  hooke \([a-z_]*\).*/\1/p'); do
  grep -qi "^\.SH HOOKE $command\$" "$dir/text" || fail "$command has no section"
  sed -n "/^\.SH HOOKE $(echo "$command" | tr '[:lower:]' '[:upper:]')\$/,/^\.SH [^H]/p" "$dir/text" | grep -e '^-' >"$dir/heads"
  for option in $("$hooke" "$command" --help | grep -E '^ +-' | sed 's/\([^ ]\)  .*/\1/' | grep -oE -e '--[a-z-]+'); do
    grep -q -e "\(^\|[ ,]\)$option\( \|\$\)" "$dir/heads" || fail "$command: $option has no entry"
    count=$((count + 1))
  done
done
[ $count -gt 60 ] || fail "only $count options were looked for"

if command -v groff >/dev/null; then
  groff -man -Tutf8 -ww "$dir/hooke.1" 2>"$dir/warnings" >"$dir/page" || fail "troff"
  [ -s "$dir/warnings" ] && fail "troff says: $(head -3 "$dir/warnings")"
fi
[ $failed = 0 ] && echo "passed: $count options"
exit $failed
