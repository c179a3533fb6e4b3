# Completion of hooke's command lines for bash: commands, their options, scenes and their parameters, names of plugins.
# Everything is asked of hooke itself (--help, plugins), so that nothing here has to follow it. Installed where
# bash-completion finds it; otherwise: source completion.bash

_hooke_ask() { timeout 3 "$_hooke_program" "$@" 2>/dev/null </dev/null; }

_hooke_commands() { _hooke_ask --help | sed -n 's/^  hooke \([a-z_]*\).*/\1/p'; }

_hooke_options() { _hooke_ask "$1" --help | grep -oE '^ +-.*' | grep -oE '^ +(-[a-z],? )?--[a-z-]+' | grep -oE -e '--[a-z-]+'; }

# The plugins of a kind ("force"), or of all.
_hooke_plugins() { _hooke_ask plugins | awk -v kind="$1" '/^[a-z]/ { at = $1 } /^  [a-z]/ && (kind == "" || at == kind) { print $1 }'; }

# The parameters that the scene's script declares, as NAME=.
_hooke_parameters() { _hooke_ask run "$1" --help | awk 'on && NF { print $1 "=" } /^parameters of this scene/ { on = 1 }'; }

_hooke_files() { # of these endings, and folders
  local ending
  compopt -o filenames 2>/dev/null
  compgen -d -- "$word"
  for ending in "$@"; do compgen -f -X "!*.$ending" -- "$word"; done
}

# What follows the option before the cursor; false: it takes nothing that is known here.
_hooke_value() {
  case $1 in
  --integrator) compgen -W "auto $(_hooke_plugins integrator)" -- "$word" ;;
  --integrators) compgen -W "$(_hooke_plugins integrator)" -- "$word" ;;
  --solver) compgen -W "auto $(_hooke_plugins solver)" -- "$word" ;;
  --accuracy-at) compgen -W 'frames end' -- "$word" ;;
  --resume) _hooke_files checkpoint ;;
  --out) compopt -o filenames 2>/dev/null; compgen -d -- "$word" ;;
  --state | --csv | --summary | --db | --merge) compopt -o filenames 2>/dev/null; compgen -f -- "$word" ;;
  --scene) _hooke_files lua ;;
  --plugin) _hooke_files so ;;
  *) return 1 ;;
  esac
}

# The first word after the command that ends in .lua.
_hooke_scene() {
  local k
  for ((k = 2; k < COMP_CWORD; k++)); do
    case ${COMP_WORDS[k]} in *.lua) printf '%s\n' "${COMP_WORDS[k]/#\~/$HOME}"; return ;; esac
  done
}

_hooke_arguments() {
  local scene
  case $command in
  plugins) compgen -W "$(_hooke_plugins '')" -- "$word" ;;
  check) _hooke_files so ;;
  new) ((COMP_CWORD == 2)) && compgen -W "$(_hooke_ask new --help | sed -n 's/^ *kind *//p' | tr -d ,)" -- "$word" ;;
  *)
    scene=$(_hooke_scene)
    if [ -z "$scene" ]; then _hooke_files lua
    else compopt -o nospace 2>/dev/null; compgen -W "$(_hooke_parameters "$scene")" -- "$word"
    fi ;;
  esac
}

_hooke() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]} _hooke_program=$1
  if [ "$before" = = ]; then before=${COMP_WORDS[COMP_CWORD - 2]}; fi # --integrator=NAME comes in three words
  if [ "$word" = = ]; then before=${COMP_WORDS[COMP_CWORD - 1]} word=; fi
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$(_hooke_commands) --help --version --cflags" -- "$word")
    return
  fi
  mapfile -t COMPREPLY < <(_hooke_value "$before" || case $word in
    -*) compgen -W "$(_hooke_options "$command")" -- "$word" ;;
    *) _hooke_arguments ;;
    esac)
  case ${COMPREPLY[0]-} in *=) compopt -o nospace 2>/dev/null ;; esac
  case ${COMPREPLY[0]-} in */* | *.*) compopt -o filenames 2>/dev/null ;; esac
}

complete -F _hooke hooke
