#include "render/report/markup.h"

#include <fmt/format.h>

namespace evo::report {

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::vector<std::string> csv_fields(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (quoted && c == '"' && line.substr(k + 1).starts_with('"'))
      fields.back() += line[++k];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

std::string picture(const std::string& id, const Body& body, const std::vector<Change>& changed) {
  std::string marks;
  for (const Change& change : changed)
    marks += fmt::format("M{} {}h1v1h-1z", change.col, change.row);
  if (!marks.empty()) marks = "<path class=\"changed\" d=\"" + marks + "\"/>";
  return fmt::format(
      "<svg class=\"body\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"robot "
      "{}\"><use href=\"#b-{}\"/>{}</svg>",
      body.cols, body.rows, id, id, marks);
}

}  // namespace evo::report
