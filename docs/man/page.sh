#!/bin/sh
# The manual page of a tool from its help: page.sh TOOL VERSION ENDING > TOOL.1
# help2man runs this script again (with EVO_TOOL set) to read the help in the form
# that it knows: of examples, what they do as a paragraph, the command further in. The settings of
# commands within the tool stand before them.
set -eu
if [ -n "${EVO_TOOL:-}" ]; then
  "$EVO_TOOL" --help | sed -n '3,/^Examples:/p' | sed '$d'
  for command in $("$EVO_TOOL" --help | sed -nE '/^Commands:/,/^$/s/^  ([a-z]+) .*/\1/p'); do
    "$EVO_TOOL" "$command" --help | sed -n "/^Options:/q; 4,\$ s/^\([A-Z][a-z]*\):/\1 of $command:/; 4,\$p"
  done
  "$EVO_TOOL" --help | sed -n '/^Examples:/,$p' | sed -E '
    s/^  # (.*)$/\n\1:\n/
    s/^  ([a-z].*)$/       \1\n/
    s/^Exit status: (.*)$/Exit status:\n\1/'
  exit
fi
tool=$1 version=$2 ending=$3
name=$(basename "$tool")
purpose=$("$tool" --help | sed -n '1s/^[^ ]* - //p')
EVO_TOOL=$tool help2man --no-info --section=1 --version-string="$version" --name="$purpose" \
  --include="$ending" "$0" |
  sed "s/page\\.sh/$name/g; s/PAGE\\.SH/$(echo "$name" | tr '[:lower:]' '[:upper:]')/g
    s/^Exit status:\$/.SH \"EXIT STATUS\"/"
