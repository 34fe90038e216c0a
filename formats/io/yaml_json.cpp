#include "formats/io/yaml_json.h"
#include "formats/io/number.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace evo {
namespace {

// A plain scalar by YAML's core schema, without hexadecimal and octal numbers.
Json plain_value(const YamlNode& node) {
  const std::string& text = node.text();
  if (text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL") return {};
  if (text == "true" || text == "True" || text == "TRUE") return true;
  if (text == "false" || text == "False" || text == "FALSE") return false;
  if (const auto value = number_in<std::uint64_t>(text)) return *value;
  if (const auto value = number_in<std::int64_t>(text)) return *value;
  if (const auto value = parse_number(text)) return *value;
  return text;
}

class Converter {
 public:
  // Without aliases a text of n bytes has at most n + 1 values.
  Converter(std::size_t text_size, const std::vector<std::string>& text_keys)
      : text_keys_(text_keys), values_left_(text_size + 1) {}

  // `mappings` are around the node; `as_text`: whatever plain scalars look like.
  Json convert(const YamlNode& node, int depth = 0, int mappings = 0, bool as_text = false) {
    if (values_left_-- == 0) throw node.error("aliases repeat too much");
    if (node.is_null()) return {};
    if (node.is_scalar())
      return node.is_plain() && !as_text ? plain_value(node) : Json(node.text());
    if (depth == deepest_json)
      throw node.error(fmt::format("nested deeper than {} levels", deepest_json));
    if (node.is_sequence()) {
      Json list = Json::array();
      for (const YamlNode& item : node.items())
        list.push_back(convert(item, depth + 1, mappings, as_text));
      return list;
    }
    Json object = Json::object();
    for (const auto& [key, value] : node.entries()) {
      const bool named = mappings == 0 && std::find(text_keys_.begin(), text_keys_.end(),
                                                    key.text()) != text_keys_.end();
      object[key.text()] = convert(value, depth + 1, mappings + 1, named);
    }
    return object;
  }

 private:
  const std::vector<std::string>& text_keys_;
  std::size_t values_left_;
};

}  // namespace

int YamlDocument::line_of(std::string_view path) const {
  YamlNode at = root;
  while (!path.empty()) {
    path.remove_prefix(1);  // the slash
    const std::string name(path.substr(0, path.find('/')));
    path.remove_prefix(name.size());
    std::optional<YamlNode> next;
    if (at.is_mapping())
      for (const auto& [key, value] : at.entries())
        if (key.text() == name) next = value;
    if (at.is_sequence())
      for (std::size_t i = 0; i < at.items().size(); ++i)
        if (fmt::format("{}", i) == name) next = at.items()[i];
    if (!next) break;
    at = *next;
  }
  return at.line();
}

std::vector<YamlDocument> parse_yaml_documents(std::string_view text, const std::string& where,
                                               const std::vector<std::string>& text_keys) {
  std::vector<YamlDocument> documents;
  for (YamlNode& root : YamlNode::documents(text, where))
    if (!root.is_null()) {
      Json value = Converter(text.size(), text_keys).convert(root);
      documents.push_back({std::move(value), std::move(root)});
    }
  return documents;
}

}  // namespace evo
