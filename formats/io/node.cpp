#include "formats/io/node.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

#include "formats/io/node_builder.h"
#include "formats/io/number.h"

namespace evo {

Node Node::yaml(std::string_view text, const std::string& file) {
  const std::vector<Node> all = yaml_documents(text, file);
  if (all.empty()) throw evo::error(Failure::data, "{}: the file is empty", file);
  for (std::size_t i = 1; i < all.size(); ++i)
    if (!all[i].is_null()) throw all[i].error("a second document begins here; one is expected");
  return all.front();
}

Node::Kind Node::kind() const { return data_->kind; }
bool Node::is_text() const { return is_scalar() && !(data_->plain && data_->document->is_json); }
bool Node::is_plain() const { return data_->plain; }
const std::string& Node::text() const { return data_->text; }
std::size_t Node::size() const { return data_->children.size() / (is_mapping() ? 2 : 1); }

std::string Node::path() const {
  std::string path;
  for (const Data* at = data_.get(); at->parent != nullptr; at = at->parent) {
    const auto& siblings = at->parent->children;
    const auto i = std::find(siblings.begin(), siblings.end(), at) - siblings.begin();
    const bool named = at->parent->kind == Kind::mapping;
    const auto name = static_cast<std::size_t>(i - i % 2);  // of a key and of its value
    path.insert(0, named ? "/" + siblings[name]->text : fmt::format("/{}", i));
  }
  return path;
}

std::string Node::where() const {
  const std::string place =
      fmt::format("{}:{}:{}", data_->document->file, data_->line, data_->column);
  const std::string steps = data_->document->is_json ? path() : "";
  return steps.empty() ? place : place + ": " + steps;
}

Error Node::error(const std::string& message) const {
  std::string line = where() + ": " + message;
  for (char& c : line)  // of keys and texts
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return {Failure::data, line};
}

std::string Node::found() const {
  switch (data_->kind) {
    case Kind::null:
      return "nothing";
    case Kind::sequence:
      return "a list";
    case Kind::mapping:
      return "a mapping";
    case Kind::scalar:
      break;
  }
  constexpr std::size_t longest = 60;
  std::string shown = data_->text.substr(0, longest);
  if (data_->text.size() > longest) shown += "...";
  return "'" + shown + "'";
}

std::string Node::string() const {
  if (!is_text() || data_->text.empty()) throw error("text is expected, found " + found());
  return data_->text;
}

// A scalar that may be a number, true or false: in JSON, one without quotes.
bool Node::holds_value() const {
  return is_scalar() && (data_->plain || !data_->document->is_json);
}

bool Node::boolean() const {
  if (holds_value() && data_->text == "true") return true;
  if (holds_value() && data_->text == "false") return false;
  throw error("true or false is expected, found " + found());
}

namespace {

// "a number", "a number of at least 0", "a number from 0 to 5"
template <typename Number>
std::string expectation(const std::string& kind, Number low, Number high, bool has_low,
                        bool has_high) {
  if (has_low && has_high) return fmt::format("{} from {} to {}", kind, low, high);
  if (has_low) return fmt::format("{} of at least {}", kind, low);
  if (has_high) return fmt::format("{} of at most {}", kind, high);
  return kind;
}

}  // namespace

std::optional<double> Node::real() const {
  return holds_value() ? finite_number(data_->text) : std::nullopt;
}

double Node::number(double low, double high) const {
  const std::optional<double> value = real();
  if (!value || *value < low || *value > high)
    throw error(fmt::format(
        "{} is expected, found {}",
        expectation("a number", low, high, std::isfinite(low), std::isfinite(high)), found()));
  return *value;
}

double Node::positive() const {
  const std::optional<double> value = real();
  if (!value || *value <= 0.0) throw error("a number greater than 0 is expected, found " + found());
  return *value;
}

std::vector<double> Node::numbers() const {
  std::vector<double> list;
  list.reserve(size());
  for (const Node& item : items()) list.push_back(item.number());
  return list;
}

int Node::integer(int low, int high) const {
  const std::optional<int> value = holds_value() ? number_in<int>(data_->text) : std::nullopt;
  if (!value || *value < low || *value > high)
    throw error(
        fmt::format("{} is expected, found {}",
                    expectation("a whole number", low, high, low != std::numeric_limits<int>::min(),
                                high != std::numeric_limits<int>::max()),
                    found()));
  return *value;
}

std::uint64_t Node::natural() const {
  const auto value = holds_value() ? number_in<std::uint64_t>(data_->text) : std::nullopt;
  if (!value) throw error("a whole number from 0 is expected, found " + found());
  return *value;
}

std::vector<Node> Node::items() const {
  if (!is_sequence()) throw error("a list is expected, found " + found());
  std::vector<Node> items;
  items.reserve(data_->children.size());
  for (const Data* item : data_->children) items.push_back(child(item));
  return items;
}

std::vector<Node::Entry> Node::entries() const {
  if (!is_mapping()) throw error("a mapping (key: value) is expected, found " + found());
  const auto& children = data_->children;
  std::vector<Entry> entries;
  entries.reserve(size());
  for (std::size_t i = 0; i < children.size(); i += 2)
    entries.push_back({child(children[i]), child(children[i + 1])});
  return entries;
}

std::optional<Node> Node::find(std::string_view key) const {
  if (!is_mapping()) return std::nullopt;
  for (std::size_t i = 0; i < data_->children.size(); i += 2)
    if (data_->children[i]->text == key) return child(data_->children[i + 1]);
  return std::nullopt;
}

Node Node::at(std::string_view key) const {
  if (!is_mapping()) throw error("a mapping (key: value) is expected, found " + found());
  if (auto value = find(key)) return *value;
  throw error(fmt::format("key '{}' is missing", key));
}

std::string Node::choice(const std::string& what, const std::vector<std::string>& allowed) const {
  std::string name = string();
  for (const std::string& candidate : allowed)
    if (candidate == name) return name;
  throw error(unknown_name(what, name, allowed));
}

Mapping::Mapping(Node node, std::string what, std::vector<std::string> allowed)
    : node_(std::move(node)), what_(std::move(what)) {
  if (!node_.is_mapping())
    throw node_.error(fmt::format("{}: a mapping (key: value) is expected, found {}; allowed: {}",
                                  what_, node_.found(), fmt::join(allowed, ", ")));
  const std::set<std::string> known(allowed.begin(), allowed.end());
  for (const Node::Entry& entry : node_.entries()) {
    const std::string key = entry.key.string();
    if (known.count(key) == 0)
      throw entry.key.error(what_ + ": " + unknown_name("key", key, allowed));
    entries_.push_back(entry);
  }
}

void Mapping::complete_from(const Mapping& base) {
  for (const Node::Entry& entry : base.entries_)
    if (!has(entry.key.string())) entries_.push_back(entry);
}

std::optional<Node> Mapping::find(std::string_view key) const {
  for (const Node::Entry& entry : entries_)
    if (entry.key.string() == key) return entry.value;
  return std::nullopt;
}

Node Mapping::at(std::string_view key) const {
  if (auto value = find(key)) return *value;
  throw node_.error(fmt::format("{}: key '{}' is missing", what_, key));
}

std::string unknown_name(const std::string& what, const std::string& name,
                         const std::vector<std::string>& allowed) {
  return fmt::format("unknown {} '{}'{}; allowed: {}", what, name, did_you_mean(name, allowed),
                     fmt::join(allowed, ", "));
}

// ---- filled by parsers ------------------------------------------------------------

NodeBuilder::NodeBuilder(const std::string& file, bool is_json)
    : document_(std::make_shared<Node::Document>()) {
  document_->file = file;
  document_->is_json = is_json;
}

Node::Data* NodeBuilder::add(Node::Kind kind, Place place, std::size_t anchor) {
  auto& all = document_->all;
  const Node::Data* const parent = open_.empty() ? nullptr : open_.back().data;
  all.push_back({document_.get(), parent, kind, false, place.line, place.column, {}, {}});
  Node::Data* const data = &all.back();
  if (anchor != 0 && kind != Node::Kind::sequence && kind != Node::Kind::mapping)
    anchors_[anchor] = data;
  if (!open_.empty())
    open_.back().data->children.push_back(data);
  else
    document_->root = data;
  if (all.size() > most_values)
    throw node(data).error(fmt::format("more than {} values in one document", most_values));
  return data;
}

void NodeBuilder::null(Place place, std::size_t anchor) { add(Node::Kind::null, place, anchor); }

void NodeBuilder::scalar(Place place, std::string text, bool plain, std::size_t anchor) {
  Node::Data* const data = add(Node::Kind::scalar, place, anchor);
  data->text = std::move(text);
  data->plain = plain;
}

void NodeBuilder::open(Node::Kind kind, Place place, std::size_t anchor) {
  Node::Data* const data = add(kind, place, anchor);
  if (open_.size() == deepest_document)
    throw node(data).error(fmt::format("nested deeper than {} levels", deepest_document));
  open_.push_back({data, anchor});
}

void NodeBuilder::close() {
  const Open done = open_.back();
  open_.pop_back();
  if (done.data->kind == Node::Kind::mapping) check_keys(*done.data);
  if (done.anchor != 0) anchors_[done.anchor] = done.data;
}

void NodeBuilder::alias(Place place, std::size_t anchor) {
  const auto known = anchors_.find(anchor);
  if (known == anchors_.end())
    throw node(add(Node::Kind::null, place, 0)).error("an alias stands inside of what it names");
  if (!open_.empty()) open_.back().data->children.push_back(known->second);
}

// A mapping's keys are scalars, and each is there once.
void NodeBuilder::check_keys(const Node::Data& mapping) const {
  std::unordered_map<std::string_view, int> lines;
  for (std::size_t i = 0; i < mapping.children.size(); i += 2) {
    const Node::Data* const key = mapping.children[i];
    if (key->kind != Node::Kind::scalar)
      throw node(key).error("a key is expected, found " + node(key).found());
    if (key->plain && key->text == "<<")
      throw node(key).error("merge keys (<<) are not read; write the keys that it stands for");
    const auto [first, fresh] = lines.emplace(key->text, key->line);
    if (!fresh)
      throw node(key).error(
          fmt::format("key '{}' is given twice (first in line {})", key->text, first->second));
  }
  if (lines.size() > most_keys)
    throw node(&mapping).error(fmt::format("a mapping with more than {} keys", most_keys));
}

std::optional<Node> NodeBuilder::take() const {
  if (document_->root == nullptr) return std::nullopt;
  return node(document_->root);
}

}  // namespace evo
