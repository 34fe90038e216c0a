# Completion of the evo tools in bash. Options and commands are those of the tool's own
# help; the words that an option may have as its value are asked for when they are needed.
# The words with which lines of a tool's help begin, before its examples.
_evo_words() {
  "$1" --help 2> /dev/null | sed -nE "/^Examples:/q; s/^$2.*/\\2/p"
}

_evo() {
  local tool=$1 word=$2 previous=$3 at=$COMP_CWORD
  COMPREPLY=()
  # evo train --al: as evo-train --al.
  if [[ ${tool##*/} == evo && $at -gt 1 ]]; then
    if [[ ${COMP_WORDS[1]} == help ]]; then
      previous=help
    else
      tool=$tool-${COMP_WORDS[1]} at=$((at - 1))
    fi
  fi
  local words=
  case $previous in
    task) words=$(evo-data --names tasks 2> /dev/null) ;;
    physics | training) words=$(evo-data --names "$previous" 2> /dev/null) ;;
    help) words=$(_evo_words "$tool" '  ()([a-z]+) ') ;;
    --* | recipe) words=$("$tool" --values-of "$previous" 2> /dev/null) ;;
  esac
  if [[ -z $words ]]; then
    local kind=--
    if [[ $word != -* ]]; then
      ((at == 1)) || return 0  # a file
      kind=
    fi
    words=$(_evo_words "$tool" "  (-[a-zA-Z], |    |)(${kind}[a-z][a-z-]*)")
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  [[ ${COMPREPLY[0]} != *= ]] || compopt -o nospace 2> /dev/null || true
}
complete -o bashdefault -o default -F _evo \
  evo evo-{archive,bench,convert,data,env,eval,evolve,inspect,mutate,neat,render,report,sample,score,select,suggest,train}
