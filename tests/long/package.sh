#!/bin/sh
# The packages of `make deb` on a clean system: a minimal Debian in a folder of its own, where apt installs hooke with what
# it depends on and no more. A scene runs and is drawn, every plugin is there, an author's plugin is built against hooke-dev
# alone and holds, versions agree, and after the removal nothing is left.
set -u
cd "$(dirname "$0")/../.." || exit 1
failed=0 log=build/package.log
fail() { echo "failed: $*"; failed=1; }
stop() { echo "failed: $*"; echo "0 passed, 1 failed, 0 skipped"; exit 1; }
unshare --mount --pid --fork true 2>/dev/null ||
  { echo "skipped: tests/long/package.sh"; echo "(only root, on a system with namespaces, may make a system in a folder)"; echo "0 passed, 0 failed, 1 skipped"; exit 0; }

make deb || stop "make deb"
version=$(build/hooke --version | sed 's/^hooke //')
set -- build/deb/hooke_"$version"_*.deb build/deb/hooke-dev_"$version"_*.deb
[ -f "$1" ] && [ -f "$2" ] || stop "there are no packages of version $version in build/deb"
if command -v lintian >/dev/null; then lintian --allow-root --fail-on error "$@" || fail "lintian has errors"; fi

system=$(mktemp -d) || exit 1
trap 'rm -rf "$system"' EXIT
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
mmdebstrap --quiet --variant=apt --aptopt='Acquire::Retries "3"' "$suite" "$system" || stop "no minimal Debian is made"
cp /etc/resolv.conf "$system/etc/"
cp "$@" "$system/root/"

# inside TEXT: the command in the system, with processes and mounts of its own.
inside() {
  unshare --mount --pid --fork sh -ec 'mount -t proc proc "$1/proc"; exec chroot "$1" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin \
    DEBIAN_FRONTEND=noninteractive sh -ec "cd /root; $2"' sh "$system" "$1"
}
apt() { inside "apt-get -qq -o Acquire::Retries=3 $*" >$log 2>&1 || { tail -n 20 $log; stop "apt-get $*"; }; }
install() { apt "install -y --no-install-recommends $*"; }
files() { (cd "$system" && find etc usr opt srv var | sort); }

apt update
install "./$(basename "$1")"
said=$(inside 'hooke run /usr/share/hooke/scripts/scenes/cloth.lua --until 0.1 --out cloth') || fail "a scene ends with $?"
echo "$said" | grep -q '^ *verdict  *ok' || fail "the verdict on a scene: $said"
[ -n "$(find "$system/root/cloth" -name "*.png")" ] || fail "a scene is not drawn"
[ "$(inside 'hooke --version')" = "hooke $version" ] || fail "hooke --version"

# The author's tools, and a compiler.
install "./$(basename "$2") gcc make pkg-config lua-argparse lua-cjson lua-filesystem"
[ "$(inside 'pkg-config --modversion hooke')" = "$version" ] || fail "the version that pkg-config knows"
[ "$(inside 'dpkg-query -W -f "\${Version} \${Architecture}" hooke')" = "$version $(dpkg --print-architecture)" ] || fail "the package's version"
inside 'hooke plugins' >"$system/root/catalogue" || fail "hooke plugins ends with $?"
for source in plugins/forces/*.c plugins/solvers/*.c plugins/integrators/*.c plugins/outputs/*.c; do
  name=$(basename "$source" .c)
  grep -qw "$name" "$system/root/catalogue" || fail "the plugin $name is not in the catalogue"
done
inside 'hooke new force breeze && cc -shared -fPIC $(pkg-config --cflags hooke) breeze.c -o breeze.so &&
  cc -shared -fPIC $(hooke --cflags) breeze.c -o again.so && hooke check ./breeze.so && make test && mkdir "two words" &&
  cd "two words" && hooke new service tally && make test' || fail "a plugin built against hooke-dev"

inside 'dpkg -L hooke hooke-dev' | sort -u >"$system/root/packaged"
apt purge -y hooke hooke-dev
left=$(inside 'while read -r f; do [ -d "$f" ] || [ ! -e "$f" ] || echo "$f"; done <packaged
  find / -xdev -path /root -prune -o -name "*hooke*" -print | grep -v ^/var/log/ || true')
[ -z "$left" ] || fail "left behind: $left"
echo "$((1 - failed)) passed, $failed failed, 0 skipped"
exit $failed
