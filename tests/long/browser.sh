#!/bin/sh
# browser: hooke in WebAssembly is built with its page, which is opened from the disk in a headless Chromium and driven
# (tests/support/view/desk.lua). The string ends there in the same bits as in the program with two lanes: it takes no function of the
# library but the square root, which is rounded correctly everywhere. Last, steps a second beside the program's.
set -u
cd "$(dirname "$0")/../.." || exit 1
root=$PWD
stop() { echo "failed: $*"; echo "0 passed, 1 failed, 0 skipped"; exit 1; }

for program in emcc clang node chromedriver curl lua5.4; do
  command -v $program >/dev/null || { echo "skipped: tests/long/browser.sh ($program is not installed)"; echo "0 passed, 0 failed, 1 skipped"; exit 0; }
done
make --no-print-directory build browser || stop "the build"
page=build/browser/hooke.html
size=$(wc -c <$page)
echo "$page: $size bytes"
[ "$size" -lt 5000000 ] || stop "the page has $size bytes, and 5,000,000 are its bound"

export HK_ROOT="$root" HK_BUILD="$root/build"
folder=$(mktemp -d) && trap 'rm -rf "$folder"' EXIT
timeout 150 lua5.4 tests/support/view/desk.lua "$root/$page" "$folder/page.csv" "$root/build/browser/page.png" || stop "the page"

# Beside the program: the same bits. What the page has more, the user's hand, holds nothing.
HOOKE_LANES=2 build/hooke run scripts/scenes/string.lua --with force:pull:by_hand=true --no-output --no-check --quiet \
  --threads 1 --state "$folder/program.csv" || stop "the program"
cmp "$folder/page.csv" "$folder/program.csv" || stop "the string ends elsewhere in the page"

# A third of the program's speed with the same vectors is the least, in the best of at most ten rounds.
timeout 400 lua5.4 tests/bench/browser.lua 10 0.33 || stop "the speed"
echo "1 passed, 0 failed, 0 skipped"
