// A small strict reader over YAML, for what people write by hand: tasks,
// physics and training profiles. Every value knows its file, line and column;
// every error says what was found there and what is allowed.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libevo/base/error.h"
#include "libevo/base/words.h"

namespace evo {

class YamlNode {
 public:
  enum class Kind { null, scalar, sequence, mapping };
  struct Entry;

  // The one document in `text`; `file` begins every message. Throws Error(data)
  // for malformed YAML, a key given twice, no or more than one document.
  static YamlNode parse(std::string_view text, const std::string& file);
  // All of them, in order; one that is empty is null.
  static std::vector<YamlNode> documents(std::string_view text, const std::string& file);

  Kind kind() const;
  bool is_null() const { return kind() == Kind::null; }
  bool is_scalar() const { return kind() == Kind::scalar; }
  bool is_sequence() const { return kind() == Kind::sequence; }
  bool is_mapping() const { return kind() == Kind::mapping; }

  bool is_plain() const;            // a scalar without quotes or tag
  const std::string& text() const;  // of a scalar, empty or not

  const std::string& file() const;
  int line() const;           // from 1
  std::string where() const;  // "tasks/walk.yaml:12:5"
  // Error(data) at this place, to be thrown: "tasks/walk.yaml:12:5: <message>".
  Error error(const std::string& message) const;

  // Typed reads. Throw error() with the value found and the type or the range
  // (bounds included) expected.
  std::string string() const;  // not empty
  bool boolean() const;        // true or false
  double number(double low = -std::numeric_limits<double>::infinity(),
                double high = std::numeric_limits<double>::infinity()) const;
  double positive() const;  // number > 0
  int integer(int low = std::numeric_limits<int>::min(),
              int high = std::numeric_limits<int>::max()) const;
  const std::vector<YamlNode>& items() const;  // a sequence
  const std::vector<Entry>& entries() const;   // a mapping, in the order written
  // One word of a closed list; `what` names it in messages.
  std::string choice(const std::string& what, const std::vector<std::string>& allowed) const;
  template <Worded E>
  E choice(const std::string& what) const {
    return from_word<E>(choice(what, words_of<E>())).value();
  }

  // How a message shows this value: "'fast'", "a list", "a mapping", "nothing".
  std::string found() const;

 private:
  friend class YamlBuilder;
  struct Data;
  static void check_keys(const std::vector<Entry>& entries);
  std::shared_ptr<const Data> data_;
};

struct YamlNode::Entry {
  YamlNode key;  // a scalar; its place is where the key stands
  YamlNode value;
};

// A mapping of which only `allowed` keys may be present, checked on
// construction: an unknown key is refused with the nearest allowed one and all
// of them. `what` names the mapping in messages ("task", "physics profile").
class YamlMapping {
 public:
  YamlMapping(YamlNode node, std::string what, std::vector<std::string> allowed);

  const YamlNode& node() const { return node_; }
  bool has(std::string_view key) const { return find(key).has_value(); }
  std::optional<YamlNode> find(std::string_view key) const;
  YamlNode at(std::string_view key) const;  // throws when it is missing

  // Gives keys that are missing here the values that they have in `base`.
  void complete_from(const YamlMapping& base);

 private:
  YamlNode node_;
  std::string what_;
  std::vector<YamlNode::Entry> entries_;
};

// "unknown <what> '<name>' (did you mean 'x'?); allowed: x, y, z"
std::string unknown_name(const std::string& what, const std::string& name,
                         const std::vector<std::string>& allowed);

// A finite decimal number that fills the whole text, or nothing.
std::optional<double> parse_number(std::string_view text);

}  // namespace evo
