# Manual pages and completion: there for every tool, well formed, and as the
# tools are.
load helpers

pages="$EVO_BIN/../docs/man"

@test "every tool has a manual page, without warnings of the formatter" {
  command -v man > /dev/null || skip "man is not installed"
  [ -e "$pages/evo.1" ] || skip "built without help2man"
  for page in $(cd "$EVO_BIN" && printf '%s.1\n' evo evo-*); do
    LC_ALL=C.UTF-8 MANWIDTH=80 man -l --warnings=w "$pages/$page" 2> warnings | col -b > text
    [ ! -s warnings ] || { echo "$page: $(cat warnings)" >&2; return 1; }
    grep -q '^NAME' text
  done
}

@test "a page says what the help says: every option, the examples, the exit statuses" {
  [ -e "$pages/evo.1" ] || skip "built without help2man"
  for tool in $(cd "$EVO_BIN" && printf '%s\n' evo-*); do
    page="$pages/$tool.1"
    head -c 300 "$page" | grep -q "$tool"
    "$tool" --help | sed -nE 's/^  (-[a-zA-Z], |    )(--[a-z-]+).*/\2/p' | while read -r option; do
      grep -qF -- "${option//-/\\-}" "$page" || { echo "$tool: no $option" >&2; exit 1; }
    done
    for section in EXAMPLES '"EXIT STATUS"' '"SEE ALSO"'; do grep -qx ".SH $section" "$page"; done
    run ! grep -qi 'page\\*.sh' "$page"
  done
}

# What bash would offer for the last word of a line.
offers() {
  local words=("$@")
  bash -c 'source "$1"; shift; COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)); _evo "$1" "${!#}" "${*: -2:1}"; printf "%s\n" "${COMPREPLY[@]}"' \
    bash "$EVO_SOURCE/scripts/completion/evo.bash" "${words[@]}"
}

@test "bash: options of the tool, names of tasks and profiles" {
  offers evo-train --out | diff - <(printf '%s\n' --out-dir --output)
  offers evo-eval --task Walk | diff - <(echo Walker-v0)
  [ "$(offers evo-train --task '' | wc -l)" -eq "$(evo-data --names tasks | wc -l)" ]
  offers evo-train --physics p | diff - <(echo paper)
  offers evo-train --train pap | diff - <(echo paper)
  [ -z "$(offers evo-eval walk)" ]
  offers evo-evolve '' | diff - <(printf '%s\n' ga neat bo map random program race modular recipe compare)
  offers evo-inspect ta | diff - <(printf '%s\n' tasks task)
  offers evo-inspect task Walk | diff - <(echo Walker-v0)
  offers evo re | diff - <(printf '%s\n' render report)
  offers evo help re | diff - <(printf '%s\n' render report)
  offers evo eval --rollout | diff - <(offers evo-eval --rollout)
  offers evo evolve '' | diff - <(offers evo-evolve '')
  offers evo-evolve ga --inherit '' | diff - <(printf '%s\n' no yes all)
}

@test "bash: the words that an option may have as its value" {
  offers evo-train --train algo | diff - <(echo algorithm=)
  [ -z "$(offers evo-evolve ga --grac)" ]
  offers evo-evolve modular --grac | diff - <(echo --grace)
  offers evo-train --train gam | diff - <(echo gamma=)
  offers evo-train --failures '' | diff - <(printf '%s\n' stop skip)
  offers evo-eval --physics grav | diff - <(echo gravity=)
  offers evo-render --tint st | diff - <(printf '%s\n' strain stress stiffness)
  offers evo-convert --to json | diff - <(printf '%s\n' jsonl json)
  offers evo render --theme '' | diff - <(printf '%s\n' light dark paper)
  offers evo-inspect --progress l | diff - <(echo lines)
  [ -z "$(offers evo-eval --policy wal)" ]
}

@test "bash: every tool is completed" {
  bash -c 'source "$1"; complete -p' bash "$EVO_SOURCE/scripts/completion/evo.bash" | sed 's/.* //' | sort > completed
  (cd "$EVO_BIN" && printf '%s\n' evo evo-*) | sort | diff - completed
}

@test "zsh: options and names, in a shell with its own completion system" {
  command -v zsh > /dev/null || skip "zsh is not installed"
  zsh -f -c 'fpath=("'"$EVO_SOURCE"'/scripts/completion" $fpath); autoload -U compinit; compinit -D
    [[ ${_postpatcomps[evo-*]} == _evo ]]'
  cat > offers.zsh <<'END'
compadd() { [[ $* == *-a* ]] && print -l -- ${(P)@[-1]}; }
_files() { print files; }
words=("$@") CURRENT=$#
source "$EVO_SOURCE/scripts/completion/_evo"
END
  zsh -f offers.zsh evo-eval --task '' | grep -qx Walker-v0
  zsh -f offers.zsh evo-eval -- | grep -qx -- --rollout
  zsh -f offers.zsh evo-render --tint '' | grep -qx strain
  zsh -f offers.zsh evo '' | grep -qx train
  zsh -f offers.zsh evo eval -- | grep -qx -- --rollout
  zsh -f offers.zsh evo-eval walk | diff - <(echo files)
  zsh -f offers.zsh evo-evolve '' | diff - <(printf '%s\n' ga neat bo map random program race modular recipe compare files)
}
