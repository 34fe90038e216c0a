# Completion of the evo tools in bash. Options and commands are those of the tool's own
# help; the words that an option may have as its value are asked for when they are needed.
# The words of a pattern with which lines of a help begin, before its examples.
_evo_words() { # PATTERN TOOL [COMMAND]
  "${@:2}" --help 2> /dev/null | sed -nE "/^Examples:/q; s/^$1.*/\\2/p"
}

_evo() {
  local tool=$1 word=$2 previous=$3 first=1
  COMPREPLY=()
  # evo train --al: as evo-train --al.
  if [[ ${tool##*/} == evo && $COMP_CWORD -gt 1 ]]; then
    if [[ ${COMP_WORDS[1]} == help ]]; then
      previous=help
    else
      tool=$tool-${COMP_WORDS[1]} first=2
    fi
  fi
  # evo-evolve ga --pop: a command within the tool has options of its own.
  local within=()
  [[ $COMP_CWORD -le $first || ! ${COMP_WORDS[first]} =~ ^[a-z]+$ ]] || within=("${COMP_WORDS[first]}")
  local words=
  case $previous in
    task) words=$(evo-data --names tasks 2> /dev/null) ;;
    physics | training) words=$(evo-data --names "$previous" 2> /dev/null) ;;
    help) words=$(_evo_words '  ()([a-z]+) ' "$tool") ;;
    --* | recipe) words=$("$tool" --values-of "$previous" 2> /dev/null) ;;
  esac
  if [[ -z $words ]]; then
    local kind=--
    if [[ $word != -* ]]; then
      ((COMP_CWORD == first)) || return 0  # a file
      kind=
    fi
    words=$(_evo_words "  (-[a-zA-Z], |    |)(${kind}[a-z][a-z-]*)" "$tool" "${within[@]}")
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  [[ ${COMPREPLY[0]} != *= ]] || compopt -o nospace 2> /dev/null || true
}
complete -o bashdefault -o default -F _evo \
  evo evo-{archive,bench,convert,data,env,eval,evolve,inspect,mutate,neat,render,report,sample,score,select,suggest,train}
