// The one model of documents that are read: YAML, which people write by hand, and JSON. Every
// value knows its file, line and column; every error says what was found there and what is
// allowed.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libevo/base/error.h"
#include "libevo/base/words.h"

namespace evo {

class Node {
 public:
  enum class Kind { null, scalar, sequence, mapping };
  struct Entry;

  // The one document in `text`; `file` begins every message. Throws Error(data) for what is
  // malformed, a key given twice, no or more than one document, and for one that is nested
  // deeper than 100 levels or has more values than memory is for.
  static Node yaml(std::string_view text, const std::string& file);
  static Node json(std::string_view text, const std::string& file);
  // All of them, in order; one that is empty is null.
  static std::vector<Node> yaml_documents(std::string_view text, const std::string& file);

  Kind kind() const;
  bool is_null() const { return kind() == Kind::null; }
  bool is_scalar() const { return kind() == Kind::scalar; }
  bool is_sequence() const { return kind() == Kind::sequence; }
  bool is_mapping() const { return kind() == Kind::mapping; }
  bool is_text() const;             // a scalar; in JSON one in quotes
  bool is_plain() const;            // a scalar without quotes or tag
  const std::string& text() const;  // of a scalar, empty or not
  std::size_t size() const;         // items of a sequence, entries of a mapping

  // "tasks/walk.yaml:12:5"; with a path in JSON, whose lines are long:
  // "robots.jsonl:7:40: /genome/nodes/2/bias".
  std::string where() const;
  // Error(data) at this place, to be thrown: "tasks/walk.yaml:12:5: <message>".
  Error error(const std::string& message) const;

  // Typed reads. Throw error() with the value found and the type or the range
  // (bounds included) expected.
  std::string string() const;  // not empty
  bool boolean() const;        // true or false
  double number(double low = -std::numeric_limits<double>::infinity(),
                double high = std::numeric_limits<double>::infinity()) const;
  double positive() const;              // number > 0
  std::vector<double> numbers() const;  // a list of them
  int integer(int low = std::numeric_limits<int>::min(),
              int high = std::numeric_limits<int>::max()) const;
  std::uint64_t natural() const;
  std::vector<Node> items() const;     // of a sequence
  std::vector<Entry> entries() const;  // of a mapping, in the order written
  // The value of a key of a mapping; nothing where the key is not there, or this is no mapping.
  std::optional<Node> find(std::string_view key) const;
  Node at(std::string_view key) const;  // throws when it is missing
  // One word of a closed list; `what` names it in messages.
  std::string choice(const std::string& what, const std::vector<std::string>& allowed) const;
  template <Worded E>
  E choice(const std::string& what) const {
    return from_word<E>(choice(what, words_of<E>())).value();
  }

  // How a message shows this value: "'fast'", "a list", "a mapping", "nothing".
  std::string found() const;

 private:
  friend class NodeBuilder;
  struct Document;
  struct Data;
  explicit Node(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  Node child(const Data* data) const { return Node({data_, data}); }
  std::string path() const;
  bool holds_value() const;
  std::optional<double> real() const;

  std::shared_ptr<const Data> data_;  // owns the whole document
};

struct Node::Entry {
  Node key;  // a scalar; its place is where the key stands
  Node value;
};

// A mapping in which only `allowed` keys may be present, checked on
// construction: an unknown key is refused with the nearest allowed one and all
// of them. `what` names the mapping in messages ("task", "physics profile").
class Mapping {
 public:
  Mapping(Node node, std::string what, std::vector<std::string> allowed);

  const Node& node() const { return node_; }
  bool has(std::string_view key) const { return find(key).has_value(); }
  std::optional<Node> find(std::string_view key) const;
  Node at(std::string_view key) const;  // throws when it is missing

  // Gives keys that are missing here the values that they have in `base`.
  void complete_from(const Mapping& base);

 private:
  Node node_;
  std::string what_;
  std::vector<Node::Entry> entries_;
};

// "unknown <what> '<name>' (did you mean 'x'?); allowed: x, y, z"
std::string unknown_name(const std::string& what, const std::string& name,
                         const std::vector<std::string>& allowed);

}  // namespace evo
