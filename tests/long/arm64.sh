#!/bin/sh
# arm64: hooke, its plugins and the tests of core/engine are built by a cross compiler against Debian's libraries in
# build/arm64-system, and the tests run under QEMU, as do the first steps of whole scenes, which end with the same bits as
# on this processor with vectors of two lanes. Debian's packages are only extracted there: nothing of arm64 is
# installed on this system. Skipped tests are printed as "skipped: arm64 NAME".
set -u
cd "$(dirname "$0")/../.." || exit 1
triplet=aarch64-linux-gnu system=$PWD/build/arm64-system libraries=$PWD/build/arm64-system/usr/lib/aarch64-linux-gnu
stop() { echo "failed: $*"; echo "0 passed, 1 failed, 0 skipped"; exit 1; }

if [ ! -f "$system/complete" ]; then
  rm -rf "$system" && mkdir -p "$system" || exit 1
  packages=$(tools/install-deps --packages test | sed -n 's/^[a-z]* \(lib.*-dev\|libopenblas.*\|zlib.*\)$/\1/p' | sort -u | paste -sd,)
  mmdebstrap --quiet --variant=extract --architectures=arm64 --aptopt='Acquire::Retries "3"' --include="$packages" \
    "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$system" || stop "no libraries of arm64"
  # Absolute links lead back to this system; and no maintainer's script has chosen a BLAS.
  find "$system" -type l -lname '/*' | while read -r link; do ln -sfn "$system$(readlink "$link")" "$link"; done
  (cd "$libraries" && ln -sf openblas-pthread/*.so.* .)
  touch "$system/complete"
fi

set -- make --no-print-directory CROSS=$triplet SYSROOT="$system"
"$@" build || stop "the cross build"

# Tests that compile a plugin call cc, as on a system of arm64.
mkdir -p build/$triplet/bin
printf '#!/bin/sh\nexec %s-gcc --sysroot="%s" "$@"\n' $triplet "$system" >build/$triplet/bin/cc && chmod +x build/$triplet/bin/cc
PATH=$PWD/build/$triplet/bin:$PATH

# The kernel hands programs of arm64 to QEMU where that is registered. Where it is not, a namespace of our own gets a
# registration of its own (Linux 6.7), which ends with it.
export QEMU_LD_PREFIX="$system"
register='mount -t binfmt_misc binfmt_misc /proc/sys/fs/binfmt_misc && cat /usr/lib/binfmt.d/qemu-aarch64.conf \
  >/proc/sys/fs/binfmt_misc/register && exec "$@"'
emulated() { "$@"; }
if ! build/$triplet/hooke --version >/dev/null 2>&1; then
  emulated() { unshare --user --map-root-user --mount sh -c "$register" sh "$@"; }
fi
if ! emulated build/$triplet/hooke --version; then
  echo "skipped: tests/long/arm64.sh"
  echo "(the kernel does not know QEMU, and a namespace of our own may not tell it, which Linux can from 6.7 on)"
  echo "0 passed, 0 failed, 1 skipped"
  exit 0
fi

code=0
said=$(emulated "$@" test ONLY=tests/core/engine/) || code=1
echo "$said" | sed 's/^skipped: /skipped: arm64 /'

states=$PWD/build/$triplet/states same=0 different=0
rm -rf "$states" && mkdir -p "$states" && make --no-print-directory build >/dev/null || stop "this system's build"
last_state() { # HOOKE SCENE FILE
  HOOKE_LANES=2 emulated timeout 300 "$1" run "scripts/scenes/$2.lua" --until 0.02 --no-check --no-output --quiet --state "$3"
}
for scene in bounce bowling bricks circle cloth cradle curtain dam_break dominoes flame hair_methods knot lava sand; do
  if last_state build/hooke $scene "$states/here" && last_state build/$triplet/hooke $scene "$states/there" &&
    cmp "$states/here" "$states/there"; then
    same=$((same + 1))
  else
    echo "failed: tests/long/arm64.sh: $scene"
    different=$((different + 1)) code=1
  fi
done
echo "$same passed, $different failed, 0 skipped"
exit $code
