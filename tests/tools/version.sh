#!/bin/sh
# One version: of the program, the manual page and the change log. (That of the installed hooke.pc is in tools/new.c,
# that of the packages in long/package.sh.) A tag of the commit that is tested has the same number.
set -u
root=${HK_ROOT:?} hooke=${HK_BUILD:?}/hooke failed=0
fail() { echo "failed: $*"; failed=1; }
version=$("$hooke" --version | sed -n 's/^hooke \([0-9]*\.[0-9]*\.[0-9]*\)$/\1/p')
[ -n "$version" ] || fail "hooke --version: $("$hooke" --version)"
newest=$(sed -n 's/^## \([0-9.]*\)[, ].*/\1/p' "$root/CHANGELOG.md" | head -n 1)
[ "$newest" = "$version" ] || fail "CHANGELOG.md begins with $newest, hooke is $version"
"$root/tools/manual" "$hooke" | grep -qF "\"hooke $version\"" || fail "the manual page is of another version"
for tag in $(git -C "$root" tag --points-at HEAD 2>/dev/null | sed -n 's/^v\([0-9].*\)/\1/p'); do
  [ "$tag" = "$version" ] || fail "the tag v$tag is on hooke $version"
done
[ $failed = 0 ] && echo "passed: $version"
exit $failed
