# Make's part of scripts/settings.tsv: lines with @@ after each (make's $(shell) turns
# newlines into blanks).
#
#   awk -v pipeline=ga -v evolves=yes -f settings.awk settings.tsv
#
#   owners_POP := all          which pipelines have the setting
#   type_POP := count
#   initial_POP := 25          without the condition of another setting
#   POP ?= 25                  and, of those of this pipeline, default, check and line of run.yaml
#   checks += ..
#   SETTINGS += pop='$(POP)'
BEGIN { FS = "\t" }

function put(line) { printf "%s@@", line }

# As a word in single quotes of a shell, within a recipe of make.
function quoted(value) { return "'$(subst ','\\''," value ")'" }

function words_of(alternatives) {
  gsub(/\|/, " ", alternatives)
  return alternatives
}

# "A for task=T|U; B" as an expression of make.
function default_of(text,   parts, condition) {
  if (text ~ /^\(/) return ""
  if (split(text, parts, "; ") < 2) return text
  split(parts[1], condition, / for |=/)
  return "$(if $(filter " words_of(condition[3]) ",$(" toupper(condition[2]) "))," condition[1] "," parts[2] ")"
}

# "yes, no or all"
function either(words) {
  match(words, /\|[^|]*$/)
  words = substr(words, 1, RSTART - 1) " or " substr(words, RSTART + 1)
  gsub(/\|/, ", ", words)
  return words
}

/^#/ || $1 == "name" { next }

{
  variable = toupper($1)
  put("known += " variable)
  put("owners_" variable " := " $2)
  initial = $4
  sub(/.*; /, "", initial)
  if (initial !~ /^\(/) put("initial_" variable " := " initial)
  put("type_" variable " := " $3)
  if (index(" " $2 " ", " " pipeline " ") == 0 && !(evolves && $2 ~ /(^| )all( |$)/)) next

  default = default_of($4)
  if (variable != "RUN" && $4 !~ /^\(/) put(variable " ?= " default)
  check = ""
  if ($3 == "count" || $3 == "number") check = "$(call must_be_" $3 "," variable ")"
  if ($3 ~ /\|/) {
    put("words_" variable " := " words_of($3))
    put("either_" variable " := " either($3))
    check = "$(call must_be_one," variable ")"
  }
  if (check != "") put("checks += " ($5 == "changed" ? "$(if $(" variable ")," check ")" : check))

  if ($5 == "yes") put("SETTINGS += " $1 "=" quoted("$(" variable ")"))
  if ($5 == "quiet") put("SETTINGS += " $1 "=" quoted("$(or $(" variable ")," default ")"))
  if ($5 == "changed") put("SETTINGS += $(if $(filter-out " default ",$(" variable "))," $1 "=" quoted("$(" variable ")") ")")
}
