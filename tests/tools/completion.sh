#!/bin/bash
# The completion of command lines for bash: what it offers for a line, with the cursor at the end.
set -u
command -v mapfile >/dev/null || exit 77 # needs bash 4
hooke="$HK_BUILD/hooke" failed=0
folder=$(mktemp -d) && trap 'rm -rf "$folder"' EXIT && cd "$folder" || exit 1
source "$HK_ROOT/tools/completion.bash"

cat >rope.lua <<'END'
local N = param("N", 12, "particles")
local stiffness = param("stiffness", 100, "N/m")
local scene = hooke.scene { duration = 0.1 }
scene:particle { position = { N, stiffness, 0 }, mass = 1 }
return scene
END
touch wind.so notes.txt newest.checkpoint
mkdir out

# offers WORD... -- NAME...: the line, of which the last word is being typed, is offered all of these.
offers() {
  COMP_WORDS=(hooke)
  while [ "$1" != -- ]; do COMP_WORDS+=("$1"); shift; done
  shift
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  _hooke "$hooke"
  local name
  for name; do
    if ! printf '%s\n' "${COMPREPLY[@]}" | grep -qxF -e "$name"; then
      echo "${COMP_WORDS[*]}: '$name' is not among: ${COMPREPLY[*]}"
      failed=1
    fi
  done
}

# After `offers`: these are not.
never() {
  local name
  for name; do
    if printf '%s\n' "${COMPREPLY[@]}" | grep -qxF -e "$name"; then
      echo "${COMP_WORDS[*]}: '$name' is among: ${COMPREPLY[*]}"
      failed=1
    fi
  done
}

offers '' -- run bench check explain new plugins stability sweep validate auto --help --version --cflags
offers st -- stability; never run
offers run r -- rope.lua; never wind.so
offers run '' -- rope.lua out; never notes.txt
offers run --s -- --seed --state --solver; never --dt
offers run rope.lua '' -- N= stiffness=
offers run rope.lua st -- stiffness=; never N=
offers run rope.lua --integrator l -- leapfrog local_global; never rk4
offers run rope.lua --integrator = l -- leapfrog
offers run --solver '' -- auto cholmod pcg; never leapfrog
offers run --resume '' -- newest.checkpoint; never rope.lua
offers run rope.lua --out '' -- out; never rope.lua
offers bench rope.lua --t -- --target --threads --trust
offers sweep rope.lua -- rope.lua
offers sweep rope.lua --i -- --integrators
offers explain rope.lua -- rope.lua
offers check '' -- wind.so; never rope.lua
offers new '' -- scene force integrator service
offers new in -- integrator; never force
offers plugins sp -- springs
# Every option that a command's help has, is offered.
for command in $("$hooke" --help | sed -n 's/^  hooke \([a-z_]*\).*/\1/p'); do
  options=$("$hooke" "$command" --help | grep -oE '^ +-.*' | sed 's/\([^ ]\)  .*/\1/' | grep -oE -e '--[a-z-]+')
  offers "$command" - -- $(printf '%s\n' $options | sort -u | grep -x -e '--[a-z-]*')
done
[ $failed -eq 0 ] && echo passed
exit $failed
