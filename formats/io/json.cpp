#include "formats/io/json.h"

#include <algorithm>
#include <cstdint>

#include "formats/io/node_builder.h"
#include "formats/io/number.h"

template class nlohmann::basic_json<nlohmann::ordered_map>;

namespace evo {
namespace {

// What the parser has to say, without its own numbering and line breaks.
std::string parser_reason(const std::string& message) {
  constexpr std::size_t most = 160;
  std::string reason = message;
  for (const char* prefix_end : {"] ", "column ", ": "})
    if (const auto found = reason.find(prefix_end); found != std::string::npos)
      reason.erase(0, found + std::string_view(prefix_end).size());
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  if (reason.size() > most) reason = reason.substr(0, most) + "...";
  return reason;
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

}  // namespace

bool is_utf8(const std::string& text) {
  try {
    (void)Json(text).dump();
    return true;
  } catch (const Json::exception&) {
    return false;
  }
}

std::string compact(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string shown(std::string_view text) {
  constexpr std::size_t most = 40;
  std::string all = Json(text).dump(-1, ' ', true, Json::error_handler_t::replace);
  if (all.size() > most) all = all.substr(0, most) + "...";
  return all;
}

std::string shown(char letter) {
  if (letter >= ' ' && letter <= '~') return fmt::format("'{}'", letter);
  return fmt::format("0x{:02X}", static_cast<unsigned char>(letter));
}

// ---- JsonPieces ---------------------------------------------------------------

std::optional<JsonPiece> JsonPieces::next() {
  skip_blanks();
  if (at_ == text_.size()) return std::nullopt;
  JsonPiece piece{{}, line_, static_cast<int>(at_ - line_start_) + 1};
  if (text_[at_] != '{' && text_[at_] != '[')
    throw error(Failure::data,
                "{}:{}:{}: a JSON object is expected, which begins with '{{', found {}", file_,
                piece.line, piece.column, shown(text_[at_]));
  const std::size_t begin = at_;
  skip_value();
  piece.text = text_.substr(begin, at_ - begin);
  return piece;
}

bool JsonPieces::done() {
  skip_blanks();
  return at_ == text_.size();
}

void JsonPieces::skip_blanks() {
  for (; at_ < text_.size() && is_blank(text_[at_]); ++at_)
    if (text_[at_] == '\n') {
      ++line_;
      line_start_ = at_ + 1;
    }
}

void JsonPieces::skip_value() {
  int depth = 0;
  bool in_text = false;
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (c == '\n') {
      ++line_;
      line_start_ = at_ + 1;
    }
    if (in_text) {
      if (c == '\\') ++at_;
      if (c == '"') in_text = false;
      continue;
    }
    if (c == '"') in_text = true;
    if (c == '{' || c == '[') ++depth;
    if ((c == '}' || c == ']') && --depth == 0) {
      ++at_;
      return;
    }
  }
  at_ = text_.size();  // never closed, which the parser will say
}

// ---- parsing ------------------------------------------------------------------

namespace {

// The library's events do not say where: the place follows the tokens along.
class JsonEvents : public nlohmann::json_sax<Json> {
 public:
  JsonEvents(const JsonPiece& piece, const std::string& file)
      : builder(file, true), piece_(piece), file_(file) {}

  NodeBuilder builder;

  bool null() override {
    builder.null(next());
    return true;
  }
  bool boolean(bool) override { return plain(); }
  bool number_integer(std::int64_t) override { return plain(); }
  bool number_unsigned(std::uint64_t) override { return plain(); }
  bool number_float(double, const std::string&) override { return plain(); }
  bool string(std::string& text) override {
    builder.scalar(next(), std::move(text), false);
    return true;
  }
  bool binary(Json::binary_t&) override { return false; }  // JSON has none
  bool start_object(std::size_t) override { return open(Node::Kind::mapping); }
  bool key(std::string& name) override { return string(name); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(Node::Kind::sequence); }
  bool end_array() override { return close(); }

  bool parse_error(std::size_t position, const std::string&,
                   const Json::exception& failure) override {
    pass(std::max<std::size_t>(position, 1) - 1);
    const auto [line, column] = place();
    throw error(Failure::data, "{}:{}:{}: not valid JSON: {}", file_, line, column,
                parser_reason(failure.what()));
  }

 private:
  bool plain() {
    const NodeBuilder::Place place = next();
    builder.scalar(place, std::string(token_), true);
    return true;
  }
  bool open(Node::Kind kind) {
    builder.open(kind, next());
    return true;
  }
  bool close() {
    next();
    builder.close();
    return true;
  }

  NodeBuilder::Place place() const {
    const int before = line_ == piece_.line ? piece_.column - 1 : 0;
    return {line_, static_cast<int>(at_ - line_start_) + 1 + before};
  }

  // To a later place in the text.
  void pass(std::size_t to) {
    for (; at_ < std::min(to, piece_.text.size()); ++at_)
      if (piece_.text[at_] == '\n') {
        ++line_;
        line_start_ = at_ + 1;
      }
  }

  // Over the next token.
  NodeBuilder::Place next() {
    const std::string_view text = piece_.text;
    pass(text.find_first_not_of(" \t\r\n,:", at_));
    const NodeBuilder::Place here = place();
    const std::size_t begin = at_++;
    if (text[begin] == '"') {
      while (text[at_] != '"') at_ += text[at_] == '\\' ? 2 : 1;
      ++at_;
    } else if (std::string_view("{}[]").find(text[begin]) == std::string_view::npos) {
      at_ = std::min(text.find_first_of(" \t\r\n,:]}", at_), text.size());
    }
    token_ = text.substr(begin, at_ - begin);
    return here;
  }

  const JsonPiece& piece_;
  const std::string& file_;
  std::string_view token_;
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  int line_ = piece_.line;
};

// A plain scalar by YAML's core schema.
Json plain_value(const std::string& text) {
  if (text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL") return {};
  if (text == "true" || text == "True" || text == "TRUE") return true;
  if (text == "false" || text == "False" || text == "FALSE") return false;
  if (const auto value = number_in<std::uint64_t>(text)) return *value;
  if (const auto value = number_in<std::int64_t>(text)) return *value;
  if (const auto value = finite_number(text)) return *value;
  return text;
}

// `as_text`: whatever plain scalars of YAML look like.
Json convert(const Node& node, std::size_t& values, bool as_text,
             const std::vector<std::string>& text_keys) {
  if (++values > most_values) throw node.error("aliases repeat too much");
  if (node.is_null()) return {};
  if (node.is_scalar())
    return node.is_plain() && !(as_text && node.is_text()) ? plain_value(node.text())
                                                           : Json(node.text());
  if (node.is_sequence()) {
    Json list = Json::array();
    for (const Node& item : node.items()) list.push_back(convert(item, values, as_text, {}));
    return list;
  }
  Json object = Json::object();
  for (const auto& [key, value] : node.entries())
    object[key.text()] =
        convert(value, values,
                std::find(text_keys.begin(), text_keys.end(), key.text()) != text_keys.end(), {});
  return object;
}

}  // namespace

Node JsonPiece::parse(const std::string& file) const {
  JsonEvents events(*this, file);
  Json::sax_parse(text, &events);
  return *events.builder.take();
}

Node Node::json(std::string_view text, const std::string& file) {
  JsonPieces pieces(text, file);
  const auto piece = pieces.next();
  if (!piece) throw evo::error(Failure::data, "{}: is empty, JSON is expected", file);
  if (!pieces.done()) throw evo::error(Failure::data, "{}: more than one JSON value", file);
  return piece->parse(file);
}

Json to_json(const Node& node, const std::vector<std::string>& text_keys) {
  std::size_t values = 0;
  return convert(node, values, false, text_keys);
}

Node to_node(const Json& value, const std::string& where) {
  return Node::json(compact(value), where);
}

}  // namespace evo
