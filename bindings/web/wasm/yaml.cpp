// YAML where there is no yaml-cpp: in a browser the page reads it (bindings/web/site/yaml.js) and
// answers with a tree.
#include <memory>

#include "formats/io/json.h"
#include "formats/io/node_builder.h"

// Reads the documents of a text into JSON for free(), as bindings/web/site/yaml.js says.
extern "C" char* evo_page_read_yaml(const char* text, std::size_t length)
    __attribute__((import_module("env"), import_name("evo_page_read_yaml")));

namespace evo {
namespace {

void add(const Json& tree, NodeBuilder& builder) {
  const NodeBuilder::Place place{tree[1].get<int>(), tree[2].get<int>()};
  const auto& kind = tree[0].get_ref<const std::string&>();
  if (kind == "scalar") {
    builder.scalar(place, tree[3].get<std::string>(), tree[4].get<bool>());
  } else if (kind == "sequence") {
    builder.open(Node::Kind::sequence, place);
    for (const Json& item : tree[3]) add(item, builder);
    builder.close();
  } else if (kind == "mapping") {
    builder.open(Node::Kind::mapping, place);
    for (const Json& entry : tree[3]) {
      add(entry[0], builder);
      add(entry[1], builder);
    }
    builder.close();
  } else {
    builder.null(place);
  }
}

}  // namespace

std::vector<Node> Node::yaml_documents(std::string_view text, const std::string& file) {
  const std::unique_ptr<char, decltype(&std::free)> answer(
      evo_page_read_yaml(text.data(), text.size()), &std::free);
  const Json read = Json::parse(answer.get());
  if (const auto problem = read.find("error"); problem != read.end())
    throw evo::error(Failure::data, "{}:{}:{}: not valid YAML: {}", file, read["line"].get<int>(),
                     read["column"].get<int>(), problem->get<std::string>());
  std::vector<Node> documents;
  for (const Json& tree : read["documents"]) {
    NodeBuilder builder(file, false);
    add(tree, builder);
    documents.push_back(*builder.take());
  }
  return documents;
}

}  // namespace evo
