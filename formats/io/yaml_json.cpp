#include "formats/io/yaml_json.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

namespace evo {
namespace {

std::string line_text(const std::string& where, const YAML::Mark& mark) {
  return with_place(where, fmt::format("line {}", mark.line + 1));
}

Error malformed(const std::string& where, const YAML::Mark& mark, const std::string& reason) {
  return refusal("", "malformed YAML at column {}: {}", mark.column + 1, reason)
      .at(line_text(where, mark));
}

// A plain scalar by YAML's core schema, without hexadecimal and octal numbers.
Json plain_value(const std::string& text) {
  if (text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL") return {};
  if (text == "true" || text == "True" || text == "TRUE") return true;
  if (text == "false" || text == "False" || text == "FALSE") return false;
  const char* begin = text.data() + (text.front() == '+' ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto whole = [&](auto value) -> std::optional<Json> {
    const auto [stopped, status] = std::from_chars(begin, end, value);
    if (status != std::errc{} || stopped != end) return std::nullopt;
    return Json(value);
  };
  if (auto value = whole(std::uint64_t{0})) return *value;
  if (auto value = whole(std::int64_t{0})) return *value;
  const auto value = whole(0.0);
  if (value && text.find_first_not_of("+-0123456789") == text.npos &&
      std::string_view(begin, end) != fmt::format("{:.0f}", value->get<double>()))
    throw refusal("", "the whole number {} has more than 64 bits; write it as text",
                  shown(Json(text)));
  if (value && std::isfinite(value->get<double>())) return *value;
  return text;
}

std::size_t count_values(const Json& value) {
  std::size_t n = 1;
  if (value.is_structured())
    for (const Json& item : value) n += count_values(item);
  return n;
}

// Builds one document from the parser's events.
class Builder : public YAML::EventHandler {
 public:
  // Without aliases a text of n bytes has at most n + 1 values.
  Builder(const std::string& where, std::size_t text_size,
          const std::vector<std::string>& text_keys)
      : where_(where), text_keys_(text_keys), values_left_(text_size + 1) {}

  YamlDocument document;
  YAML::Mark begin;

  void OnDocumentStart(const YAML::Mark& mark) override { begin = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (take_key("", mark)) return;
    attach({}, mark, anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    if (!is_utf8(text)) throw refuse(mark, "text that is not UTF-8");
    if (take_key(text, mark)) return;
    const bool is_plain = tag == "?";
    attach(is_plain && !is_text_by_key() ? plain_value_at(text, mark) : Json(text), mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto named = anchors_.find(anchor);
    if (named == anchors_.end()) throw refuse(mark, "an alias stands inside of what it names");
    if (expects_key()) throw refuse(mark, "a key that is not a word");
    const std::size_t more = count_values(named->second);
    if (more > values_left_) throw refuse(mark, "aliases repeat too much");
    attach(Json(named->second), mark, YAML::NullAnchor);
    values_left_ -= more - 1;  // one was counted by attach
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(Json::array(), mark, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(Json::object(), mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

 private:
  // A sequence or mapping that is being read.
  struct Open {
    Json value;
    std::string path;
    YAML::Mark mark;
    YAML::anchor_t anchor;
    std::optional<std::string> key;  // read, its value is still to come
  };

  Json plain_value_at(const std::string& text, const YAML::Mark& mark) const {
    try {
      return plain_value(text);
    } catch (const Refusal& refused) {
      throw refuse(mark, refused.message);
    }
  }

  Error refuse(const YAML::Mark& mark, const std::string& message) const {
    return Refusal{path(), message}.at(line_text(where_, mark));
  }

  bool expects_key() const {
    return !open_.empty() && open_.back().value.is_object() && !open_.back().key;
  }

  // Whether the scalar is a key of the innermost mapping.
  bool take_key(const std::string& text, const YAML::Mark& mark) {
    if (!expects_key()) return false;
    if (open_.back().value.contains(text))
      throw refuse(mark, fmt::format("the key {} is given twice", shown(Json(text))));
    open_.back().key = text;
    return true;
  }

  // Whether the one mapping around says that its items are text.
  bool is_text_by_key() const {
    const Open* mapping = nullptr;
    for (const Open& open : open_) {
      if (!open.value.is_object()) continue;
      if (mapping != nullptr) return false;
      mapping = &open;
    }
    return mapping != nullptr && mapping->key &&
           std::find(text_keys_.begin(), text_keys_.end(), *mapping->key) != text_keys_.end();
  }

  // Of the value that comes next.
  std::string path() const {
    if (open_.empty()) return "";
    const Open& parent = open_.back();
    if (parent.value.is_array()) return fmt::format("{}/{}", parent.path, parent.value.size());
    return parent.key ? fmt::format("{}/{}", parent.path, *parent.key) : parent.path;
  }

  void open(Json empty, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (expects_key()) throw refuse(mark, "a key that is not a word");
    if (open_.size() >= static_cast<std::size_t>(deepest_json))
      throw refuse(mark, fmt::format("nested deeper than {} levels", deepest_json));
    open_.push_back({std::move(empty), path(), mark, anchor, std::nullopt});
  }

  void close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    attach(std::move(done.value), done.mark, done.anchor);
  }

  void attach(Json value, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (values_left_ == 0) throw refuse(mark, "aliases repeat too much");
    --values_left_;
    document.lines[path()] = mark.line + 1;
    if (anchor != YAML::NullAnchor) anchors_[anchor] = value;
    if (open_.empty()) {
      document.value = std::move(value);
    } else if (Open& parent = open_.back(); parent.value.is_array()) {
      parent.value.push_back(std::move(value));
    } else {
      parent.value[*parent.key] = std::move(value);
      parent.key.reset();
    }
  }

  const std::string& where_;
  const std::vector<std::string>& text_keys_;
  std::size_t values_left_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Json> anchors_;
};

}  // namespace

int YamlDocument::line_of(std::string path) const {
  for (;;) {
    if (const auto found = lines.find(path); found != lines.end()) return found->second;
    if (path.empty()) return 1;
    path.resize(std::min(path.rfind('/'), path.size() - 1));
  }
}

std::vector<YamlDocument> parse_yaml_documents(std::string_view text, const std::string& where,
                                               const std::vector<std::string>& text_keys) {
  std::vector<YamlDocument> documents;
  std::istringstream stream{std::string(text)};
  std::optional<YAML::Mark> last_begin;
  try {
    YAML::Parser parser(stream);
    for (;;) {
      Builder builder(where, text.size(), text_keys);
      if (!parser.HandleNextDocument(builder)) return documents;
      // Before a sign that cannot begin a document the parser finds empty
      // documents without end.
      if (last_begin && builder.begin.pos <= last_begin->pos)
        throw malformed(where, builder.begin, "no document can begin here");
      last_begin = builder.begin;
      if (!builder.document.value.is_null()) documents.push_back(std::move(builder.document));
    }
  } catch (const YAML::Exception& e) {
    throw malformed(where, e.mark, e.msg);
  }
}

}  // namespace evo
