# Completion of rths for bash. For zsh: autoload -U bashcompinit && bashcompinit, then source this file.
_rths() {
  local IFS=$'\n'
  COMPREPLY=($("${COMP_WORDS[0]}" complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null))
}
complete -o default -F _rths rths
