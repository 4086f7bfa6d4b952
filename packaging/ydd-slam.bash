# SPDX-License-Identifier: Apache-2.0
# Completion of ydd-slam for bash. What can follow is asked of the program itself: `--help` of the
# sub-command lists its options and their choices.

_ydd_slam_words() {  # FIELD HELP...: sub-commands, options, or the choices of an option
  case "$1" in
    subcommands) sed -n '/^Subcommands:/,/^$/s/^  \([a-z]\+\) .*/\1/p' <<<"$2" ;;
    options) grep -oE '^  (-[a-zA-Z],)?--[a-z0-9,-]+' <<<"$2" | tr -s ' ,' '\n' ;;
    choices) sed -n "s/^ .*$3[ ,][^{]*TEXT:{\([^}]*\)}.*/\1/p" <<<"$2" | tr ',' '\n' ;;
  esac
}

_ydd_slam() {
  local cur prev words cword
  _init_completion || return
  local command=() help i
  for ((i = 1; i < cword; ++i)); do  # the sub-command, and one below it (bench speed, map export)
    [[ ${words[i]} == [a-z]* && ${#command[@]} -lt 2 ]] || break
    command+=("${words[i]}")
  done
  while :; do
    help=$("${words[0]}" "${command[@]}" --help 2>/dev/null) && break
    [[ ${#command[@]} -gt 0 ]] || return
    unset 'command[-1]'  # it was a file
  done
  if [[ $prev == --* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_ydd_slam_words choices "$help" "$prev")" -- "$cur")
    [[ ${#COMPREPLY[@]} -gt 0 ]] && return
  fi
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_ydd_slam_words options "$help")" -- "$cur")
    return
  fi
  mapfile -t COMPREPLY < <(compgen -W "$(_ydd_slam_words subcommands "$help")" -- "$cur")
  [[ ${#COMPREPLY[@]} -gt 0 ]] || _filedir
}

complete -F _ydd_slam ydd-slam
