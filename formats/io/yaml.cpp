#include "formats/io/yaml.h"

#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "formats/io/number.h"
#include "formats/io/yaml_data.h"

namespace evo {

// A mapping's keys are scalars, and each is there once.
void YamlNode::check_keys(const std::vector<Entry>& entries) {
  std::map<std::string, int> lines;
  for (const YamlNode::Entry& entry : entries) {
    if (!entry.key.is_scalar())
      throw entry.key.error("a key is expected, found " + entry.key.found());
    const std::string& key = entry.key.text();
    const auto [first, fresh] = lines.emplace(key, entry.key.line());
    if (!fresh)
      throw entry.key.error(
          fmt::format("key '{}' is given twice (first in line {})", key, first->second));
  }
}

YamlNode YamlNode::parse(std::string_view text, const std::string& file) {
  const std::vector<YamlNode> all = documents(text, file);
  if (all.empty()) throw evo::error(Failure::data, "{}: the file is empty", file);
  for (std::size_t i = 1; i < all.size(); ++i)
    if (!all[i].is_null()) throw all[i].error("a second document begins here; one is expected");
  return all.front();
}

YamlNode::Kind YamlNode::kind() const { return data_->kind; }
bool YamlNode::is_plain() const { return data_->plain; }
const std::string& YamlNode::text() const { return data_->text; }
const std::string& YamlNode::file() const { return *data_->file; }
int YamlNode::line() const { return data_->line; }

std::string YamlNode::where() const {
  return fmt::format("{}:{}:{}", *data_->file, data_->line, data_->column);
}

Error YamlNode::error(const std::string& message) const {
  return Error(Failure::data, message).at(where());
}

std::string YamlNode::found() const {
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

std::string YamlNode::string() const {
  if (!is_scalar() || data_->text.empty()) throw error("text is expected, found " + found());
  return data_->text;
}

bool YamlNode::boolean() const {
  if (is_scalar() && data_->text == "true") return true;
  if (is_scalar() && data_->text == "false") return false;
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

double YamlNode::number(double low, double high) const {
  const std::optional<double> value = is_scalar() ? parse_number(data_->text) : std::nullopt;
  if (!value || *value < low || *value > high)
    throw error(fmt::format(
        "{} is expected, found {}",
        expectation("a number", low, high, std::isfinite(low), std::isfinite(high)), found()));
  return *value;
}

double YamlNode::positive() const {
  const std::optional<double> value = is_scalar() ? parse_number(data_->text) : std::nullopt;
  if (!value || *value <= 0.0) throw error("a number greater than 0 is expected, found " + found());
  return *value;
}

int YamlNode::integer(int low, int high) const {
  const std::optional<int> value = is_scalar() ? number_in<int>(data_->text) : std::nullopt;
  if (!value || *value < low || *value > high)
    throw error(
        fmt::format("{} is expected, found {}",
                    expectation("a whole number", low, high, low != std::numeric_limits<int>::min(),
                                high != std::numeric_limits<int>::max()),
                    found()));
  return *value;
}

const std::vector<YamlNode>& YamlNode::items() const {
  if (!is_sequence()) throw error("a list is expected, found " + found());
  return data_->items;
}

const std::vector<YamlNode::Entry>& YamlNode::entries() const {
  if (!is_mapping()) throw error("a mapping (key: value) is expected, found " + found());
  return data_->entries;
}

std::string YamlNode::choice(const std::string& what,
                             const std::vector<std::string>& allowed) const {
  std::string name = string();
  for (const std::string& candidate : allowed)
    if (candidate == name) return name;
  throw error(unknown_name(what, name, allowed));
}

YamlMapping::YamlMapping(YamlNode node, std::string what, std::vector<std::string> allowed)
    : node_(std::move(node)), what_(std::move(what)) {
  if (!node_.is_mapping())
    throw node_.error(fmt::format("{}: a mapping (key: value) is expected, found {}; allowed: {}",
                                  what_, node_.found(), fmt::join(allowed, ", ")));
  const std::set<std::string> known(allowed.begin(), allowed.end());
  for (const YamlNode::Entry& entry : node_.entries()) {
    const std::string key = entry.key.string();
    if (known.count(key) == 0)
      throw entry.key.error(what_ + ": " + unknown_name("key", key, allowed));
    entries_.push_back(entry);
  }
}

void YamlMapping::complete_from(const YamlMapping& base) {
  for (const YamlNode::Entry& entry : base.entries_)
    if (!has(entry.key.string())) entries_.push_back(entry);
}

std::optional<YamlNode> YamlMapping::find(std::string_view key) const {
  for (const YamlNode::Entry& entry : entries_)
    if (entry.key.string() == key) return entry.value;
  return std::nullopt;
}

YamlNode YamlMapping::at(std::string_view key) const {
  if (auto value = find(key)) return *value;
  throw node_.error(fmt::format("{}: key '{}' is missing", what_, key));
}

std::string unknown_name(const std::string& what, const std::string& name,
                         const std::vector<std::string>& allowed) {
  return fmt::format("unknown {} '{}'{}; allowed: {}", what, name, did_you_mean(name, allowed),
                     fmt::join(allowed, ", "));
}

std::optional<double> parse_number(std::string_view text) {
  const auto value = number_in<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

}  // namespace evo
