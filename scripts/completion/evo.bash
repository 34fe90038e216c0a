# Completion of the evo tools in bash. Options and commands are those of the tool's own
# help; names of tasks and profiles are asked for when they are needed.
_evo() {
  local tool=$1 word=$2 previous=$3
  COMPREPLY=()
  case $previous in
    --task | task) mapfile -t COMPREPLY < <(compgen -W "$(evo-data --names tasks 2> /dev/null)" -- "$word") ;;
    --physics | physics) mapfile -t COMPREPLY < <(compgen -W "$(evo-data --names physics 2> /dev/null)" -- "$word") ;;
    --train | training) mapfile -t COMPREPLY < <(compgen -W "$(evo-data --names training 2> /dev/null)" -- "$word") ;;
    *)
      local kind=--
      if [[ $word != -* ]]; then
        ((COMP_CWORD == 1)) || return 0  # a file
        kind=
      fi
      mapfile -t COMPREPLY < <(compgen -W \
        "$("$tool" --help 2> /dev/null | sed -nE "s/^  (-[a-zA-Z], |    )(${kind}[a-z][a-z-]*).*/\\2/p")" -- "$word")
      ;;
  esac
}
complete -o bashdefault -o default -F _evo \
  evo-{archive,bench,convert,data,env,eval,inspect,mutate,neat,render,report,run,sample,select,suggest,train}
