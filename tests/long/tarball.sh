#!/bin/sh
# The archive of `make tarball` in a folder that has the C library, a shell and nothing else, unpacked at another path than it
# was made at, and run by a user without rights: a scene runs, its page and its equilibrium are made, the tools find their modules,
# and every plugin is in the catalogue, also `frames`, which draws by the graphics driver of a system.
set -u
cd "$(dirname "$0")/../.." || exit 1
failed=0
fail() { echo "failed: $*"; failed=1; }
stop() { echo "failed: $*"; echo "0 passed, 1 failed, 0 skipped"; exit 1; }
# HK_TARBALL=FILE: that archive, in the place of one that is made.
unshare --mount --pid --fork true 2>/dev/null ||
  { echo "skipped: tests/long/tarball.sh"; echo "(only root, on a system with namespaces, may make a system in a folder)"; echo "0 passed, 0 failed, 1 skipped"; exit 0; }

[ -n "${HK_TARBALL:-}" ] || make tarball || stop "make tarball"
version=$(build/hooke --version | sed 's/^hooke //')
archive=${HK_TARBALL:-build/tarball/hooke-$version-$(uname -m).tar.gz}
[ -f "$archive" ] || stop "there is no $archive"

system=$(mktemp -d) || exit 1
trap 'rm -rf "$system"' EXIT
chmod 755 "$system"
mkdir -p "$system/bin" "$system/proc" "$system/dev" "$system/tmp" "$system/home/some where"
for file in /bin/sh /bin/ls /bin/mkdir /bin/rm /bin/mktemp; do
  cp -L "$file" "$system/bin/"
  for library in $(ldd "$file" | grep -o '/[^ ]*'); do mkdir -p "$system$(dirname "$library")" && cp -L "$library" "$system$library"; done
done
place=$(dirname "$(ldd /bin/sh | grep -o '/[^ ]*libc\.so\.6')")
for library in libm libdl libpthread librt libresolv; do cp -L "$place/$library".so.* "$system$place/" 2>/dev/null; done
mknod -m 666 "$system/dev/null" c 1 3 && mknod -m 666 "$system/dev/urandom" c 1 9 || stop "no devices are made"
tar -xzf "$archive" -C "$system/home/some where" || stop "the archive is not unpacked"
mv "$system/home/some where/hooke-$version" "$system/home/some where/hooke"
chmod -R a+rX "$system/home" && chmod 777 "$system/tmp" "$system/home"

# inside COMMAND: as nobody, in the system, where `hooke` is the program.
inside() {
  unshare --mount --pid --fork sh -ec 'mount -t proc proc "$1/proc"
    exec chroot --userspec=65534:65534 "$1" env -i HOME=/tmp PATH=/bin sh -ec "cd /home; hooke() { \"/home/some where/hooke/bin/hooke\" \"\$@\"; }; $2"' \
    sh "$system" "$1"
}
cp "$(command -v env)" "$system/bin/"
said=$(inside 'hooke --version') || fail "hooke --version ends with $?: $said"
[ "$said" = "hooke $version" ] || fail "hooke --version: $said"
said=$(inside 'hooke run "/home/some where/hooke/share/hooke/scripts/scenes/stiff_cloth.lua" N=8 --until 0.1 --no-output 2>&1') || fail "a scene ends with $?"
echo "$said" | grep -q '^ *verdict  *ok' || fail "the verdict on a scene: $said"
inside 'hooke view "/home/some where/hooke/share/hooke/scripts/scenes/curtain.lua" N=4 -- --until 0.1 >/tmp/said 2>&1' || fail "hooke view: $(cat "$system/tmp/said")"
said=$(inside 'hooke rest "/home/some where/hooke/share/hooke/scripts/scenes/catenary.lua" n=10 2>&1') || fail "hooke rest: $said"
said=$(inside 'hooke sweep "/home/some where/hooke/share/hooke/scripts/scenes/circle.lua" --dt 0.01,0.02 --quiet 2>&1') || fail "hooke sweep: $said"
inside 'hooke plugins' >"$system/tmp/catalogue" || fail "hooke plugins ends with $?"
for source in plugins/forces/*.c plugins/solvers/*.c plugins/integrators/*.c plugins/outputs/*.c; do
  name=$(basename "$source" .c)
  grep -qw "$name" "$system/tmp/catalogue" || fail "the plugin $name is not in the catalogue"
done
[ -z "$(find "$system/home/some where/hooke" -newer "$system/bin/env" -type f)" ] || fail "hooke writes where it is unpacked"
echo "$((1 - failed)) passed, $failed failed, 0 skipped"
