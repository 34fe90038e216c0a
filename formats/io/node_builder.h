// Inside of Node: what a parser fills in (yaml.cpp, json.cpp; bindings/web/wasm/yaml.cpp in
// browsers) and node.cpp reads.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/io/node.h"

namespace evo {

inline constexpr std::size_t deepest_document = 100;              // levels
inline constexpr std::size_t most_values = std::size_t{1} << 22;  // of one document
inline constexpr std::size_t most_keys = 40'000;                  // of one mapping

struct Node::Data {
  const Document* document;
  const Data* parent;  // where it stands first; of the root none
  Kind kind;
  bool plain;  // a scalar without quotes and tag
  int line;    // from 1
  int column;
  std::string text;                   // of a scalar
  std::vector<const Data*> children;  // items; of a mapping key, value, key, value, ..
};

struct Node::Document {
  std::string file;
  bool is_json = false;
  std::deque<Data> all;
  const Data* root = nullptr;
};

// Told of the parts of one document in their order. Throws Error(data) for keys that are given
// twice and for documents that are too deep or too large.
class NodeBuilder {
 public:
  NodeBuilder(const std::string& file, bool is_json);

  struct Place {
    int line;
    int column;
  };
  // What `anchor` names can be repeated by alias(); 0 is none.
  void null(Place place, std::size_t anchor = 0);
  void scalar(Place place, std::string text, bool plain, std::size_t anchor = 0);
  void open(Node::Kind kind, Place place, std::size_t anchor = 0);
  void close();
  void alias(Place place, std::size_t anchor);

  std::optional<Node> take() const;  // nothing where there was nothing

 private:
  struct Open {
    Node::Data* data;
    std::size_t anchor;
  };

  Node node(const Node::Data* data) const { return Node({document_, data}); }
  Node::Data* add(Node::Kind kind, Place place, std::size_t anchor);
  void check_keys(const Node::Data& mapping) const;

  std::shared_ptr<Node::Document> document_;
  std::vector<Open> open_;
  std::map<std::size_t, const Node::Data*> anchors_;
};

}  // namespace evo
