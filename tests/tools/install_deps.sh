#!/bin/sh
# tools/install-deps and the BLAS: the reference BLAS is seen behind links on every system that is known, and OpenBLAS is
# asked for then and only then. PATH has nothing but stubs, in one folder, and links to a few harmless programs, in
# another that nothing is written to, so no package manager of the system can be reached.
set -u
root=${HK_ROOT:?}
dir=$(mktemp -d /tmp/hooke-deps-XXXXXX) || exit 1
trap 'rm -rf "$dir"' EXIT
failed=0
fail() { echo "failed: $*"; failed=1; }

[ -f /usr/include/suitesparse/cholmod.h ] || [ -f /usr/include/cholmod.h ] || { echo "no cholmod.h"; exit 77; }
mkdir "$dir/tools" "$dir/stubs" "$dir/programs" "$dir/lib"
cp "$root/tools/install-deps" "$dir/tools/"
for p in sh env cat sed awk grep head ls ln mkdir readlink dirname pkg-config; do
  ln -s "$(command -v "$p")" "$dir/programs/$p"
done
stub() { printf '#!/bin/sh\n%s\n' "$2" >"$dir/stubs/$1"; chmod +x "$dir/stubs/$1"; }
stub cc :
stub make :
stub id 'echo 0' # as root: no sudo
stub ldconfig "echo '	libcholmod.so.3 (libc6,x86-64) => $dir/lib/libcholmod.so.3'"
stub ldd "cat '$dir/libraries'"

# The BLAS that CHOLMOD loads: by this name, which may be a link to that file.
blas() {
  rm -rf "$dir/lib" && mkdir -p "$dir/lib/$(dirname "$2")"
  : >"$dir/lib/$2"
  [ "$1" = "$2" ] || ln -s "$dir/lib/$2" "$dir/lib/$1"
  printf '\tlibm.so.6 => /lib/libm.so.6 (0x00)\n\t%s => %s (0x00)\n' "$1" "$dir/lib/$1" >"$dir/libraries"
}
deps() { CC=cc PATH="$dir/stubs:$dir/programs" "$dir/tools/install-deps" "$@" 2>&1; }
complains() { deps --check build | grep -q 'optimised BLAS' || fail "$1: the reference BLAS is not seen"; }
silent() { deps --check build | grep 'optimised BLAS' && fail "$1: taken for the reference BLAS"; }

# ---- what is seen ----

blas libblas.so.3 blas/libblas.so.3.11.0; complains "Debian, reference"
blas libblas.so.3 openblas-pthread/libblas.so.3; silent "Debian, OpenBLAS"
blas libblas.so.3 atlas/libblas.so.3.10.3; silent "Debian, ATLAS"
blas libblas.so.3 libmkl_rt.so; silent "Debian, MKL"
blas libblas.so.3 libblas.so.3.12.0; complains "Arch, reference"
blas libblas.so.3 libopenblas.so.0.3; silent "Arch, OpenBLAS"
blas libblas.so.3 openblas-pthreads/libblas.so.3; silent "openSUSE, OpenBLAS"
blas libflexiblas.so.3 libflexiblas.so.3; mkdir "$dir/lib/flexiblas"; : >"$dir/lib/flexiblas/libflexiblas_netlib.so"
complains "Fedora, NETLIB alone"
: >"$dir/lib/flexiblas/libflexiblas_openblas-openmp.so"; silent "Fedora, OpenBLAS"
: >"$dir/libraries"; silent "CHOLMOD without a BLAS that can be seen"

# It is wished for, not demanded: a check passes without.
blas libblas.so.3 blas/libblas.so.3.11.0
deps --check build >/dev/null || fail "the check for building fails without an optimised BLAS"
deps --check run | grep -q 'optimised BLAS' || fail "running does not ask for it"
deps --check test | grep -q 'optimised BLAS' || fail "testing does not ask for it"

# ---- every purpose has what it needs ----

# On a machine without any library that pkg-config knows.
without() { PKG_CONFIG_LIBDIR="$dir/nothing" deps --check "$1"; }
for purpose in bench study test lint; do
  without $purpose | grep -q cmocka || fail "$purpose: cmocka is not asked for"
done
for purpose in build run fuzz; do without $purpose | grep cmocka && fail "$purpose: cmocka is asked for"; done
without fuzz | grep -q 'lua5.4 interpreter' || fail "fuzz: no interpreter is asked for"
for purpose in run bench study fuzz test lint; do
  grep -q "tools/install-deps $purpose\$" "$root/Makefile" || fail "make $purpose does not ask for what it needs"
done

# ---- what is installed ----

# The one package manager that is there; it notes what it is asked for, and does this.
manager() {
  rm -f "$dir/stubs/apt-get" "$dir/stubs/apt-cache" "$dir/stubs/dnf" "$dir/stubs/pacman" "$dir/stubs/zypper"
  rm -f "$dir/asked" "$dir/build/goes-without"
  stub "$1" "echo \"$1 \$*\" >>'$dir/asked'; $2"
  [ "$1" != apt-get ] || stub apt-cache :
}

while read -r name package; do
  blas libblas.so.3 blas/libblas.so.3.11.0
  mkdir "$dir/lib/openblas" && : >"$dir/lib/openblas/libblas.so.3"
  manager "$name" "case \"\$*\" in *$package*) ln -sf '$dir/lib/openblas/libblas.so.3' '$dir/lib/libblas.so.3' ;; esac"
  deps build >"$dir/said" || fail "$name: exit code $?: $(cat "$dir/said")"
  grep -q "$package" "$dir/asked" 2>/dev/null || fail "$name: $package is not asked for"
  grep 'goes without' "$dir/said" && fail "$name: what was installed is not seen"
  rm -f "$dir/asked"
  deps build >"$dir/said" || fail "$name: exit code $? with OpenBLAS"
  [ ! -e "$dir/asked" ] || fail "$name: OpenBLAS is there and it is asked for again: $(cat "$dir/asked")"
done <<LIST
apt-get libopenblas0-pthread
dnf flexiblas-openblas-openmp
pacman blas-openblas
zypper libopenblas_pthreads0
LIST

# What cannot be had is said, and not asked for again at every make.
blas libblas.so.3 blas/libblas.so.3.11.0
manager apt-get "exit 100"
deps build >"$dir/said" || fail "no package to be had: exit code $?, and it is not needed"
grep -q 'goes without:.*optimised BLAS' "$dir/said" || fail "nothing says that there is no optimised BLAS"
rm -f "$dir/asked"
deps build >"$dir/said" || fail "asked again: exit code $?"
[ ! -e "$dir/asked" ] || fail "what cannot be had is asked for again"

# Without root one sentence says what is missing and why it stays so; without a network it is the last one.
stub id 'echo 1000'
manager apt-get "exit 100"
for case in "there is no sudo" "sudo asks for a password"; do
  [ "$case" = "there is no sudo" ] || stub sudo "exit 1"
  PKG_CONFIG_LIBDIR="$dir/nothing" deps run </dev/null >"$dir/said" && fail "$case: nothing is installed, and the exit code is 0"
  [ "$(wc -l <"$dir/said")" = 1 ] || fail "$case: $(wc -l <"$dir/said") lines instead of a sentence: $(cat "$dir/said")"
  grep -q "^hooke needs what is not here: .*Lua 5.4.*; to install it takes root, and $case: as root, tools/install-deps run\$" "$dir/said" ||
    fail "$case: $(cat "$dir/said")"
  [ ! -e "$dir/asked" ] || fail "$case: a package manager was called"
done
rm "$dir/stubs/sudo"
stub id 'echo 0'
PKG_CONFIG_LIBDIR="$dir/nothing" deps run >"$dir/said" && fail "no network: the exit code is 0"
tail -n 1 "$dir/said" | grep -q '^hooke needs what could not be installed here (is there a network?): .*Lua 5.4.*; install it' ||
  fail "no network: $(tail -n 1 "$dir/said")"

# openSUSE: where the system ranks the reference BLAS higher, OpenBLAS is chosen, unless somebody has chosen already.
for mode in auto manual; do
  blas libblas.so.3 blas/libblas.so.3.9.0
  mkdir "$dir/lib/openblas-pthreads" && : >"$dir/lib/openblas-pthreads/libblas.so.3"
  manager zypper :
  stub update-alternatives "case \$1 in
  --get-selections) echo 'libblas.so.3_x86_64  $mode  $dir/lib/blas/libblas.so.3.9.0' ;;
  --list) echo '$dir/lib/blas/libblas.so.3.9.0'; echo '$dir/lib/openblas-pthreads/libblas.so.3' ;;
  --set) ln -sf \"\$3\" '$dir/lib/libblas.so.3' ;;
  esac"
  deps build >"$dir/said" || fail "zypper, $mode: exit code $?: $(cat "$dir/said")"
  case $mode:$(readlink "$dir/lib/libblas.so.3") in
  auto:*/openblas-pthreads/* | manual:*/blas/*) ;;
  *) fail "zypper, $mode: libblas.so.3 is $(readlink "$dir/lib/libblas.so.3")" ;;
  esac
done

# ---- the container ----

# Packages that tools/Containerfile names are known here; what it takes from here is all that a run wants, no package for compiling.
file=$root/tools/Containerfile
known=$("$root/tools/install-deps" --packages package | cut -d' ' -f2)
for package in $(sed -n 's/.*apt-get install \([^&\\]*\).*/\1/p' "$file" | tr ' ' '\n' | grep -v -e '^-' -e '^/tmp/hooke_'); do
  echo "$known" | grep -qx -e "$package" || fail "tools/Containerfile installs $package, which tools/install-deps does not know"
done
filter=$(sed -n "s/.*install-deps --packages run | \(sed -n '[^']*'\).*/\1/p" "$file")
[ -n "$filter" ] || fail "tools/Containerfile does not ask tools/install-deps"
taken=$("$root/tools/install-deps" --packages run | sh -c "$filter")
for package in lua-cjson ffmpeg libopenblas0-pthread; do
  echo "$taken" | grep -qx "$package" || fail "the container has no $package"
done
echo "$taken" | grep -e '-dev$' -e '^gcc$' && fail "the container has what only compiling needs"
exit $failed
