# The settings of scripts/settings.tsv in the place of @SETTINGS@, as scdoc:
# awk -f settings.awk settings.tsv evo-pipelines.7.scd
BEGIN { FS = "\t" }

function escaped(text) {
  gsub(/[_*\\]/, "\\\\&", text)
  return text
}

# A word for the value, as in evo-run settings.
function value_of(type) {
  if (type ~ /\|/) return escaped(type)
  if (type == "count" || type == "number") return "N"
  return type == "shape" ? "ROWSxCOLS" : toupper(type)
}

function owners(pipelines,   words, count, i, text) {
  if (pipelines ~ /^all/) return ""
  count = split(pipelines, words, " ")
  for (i = 1; i <= count; i++) text = text (i == 1 ? "" : i == count ? " and " : ", ") "*" words[i] ".mk*"
  return "Of " text ": "
}

function sentence(text) { return toupper(substr(text, 1, 1)) substr(text, 2) }

FNR == NR {
  if (/^#/ || $1 == "name") next
  gsub(/^\(|\)$/, "", $4)
  settings = settings "*" escaped(toupper($1)) "*=_" value_of($3) "_\n\t" sentence(owners($2) escaped($6)) \
    ($4 == "" ? "" : " [" escaped($4) "]") ".\n\n"
  next
}
/^@SETTINGS@$/ { printf "%s", settings; getline; next }
{ print }
