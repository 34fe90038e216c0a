// YAML where there is no yaml-cpp: in a browser the page reads it (bindings/web/site/yaml.js) and
// answers with a tree.
#include <utility>

#include "formats/io/json.h"
#include "formats/io/yaml_data.h"

// Reads the documents of a text into JSON for free(), as bindings/web/site/yaml.js says.
extern "C" char* evo_page_read_yaml(const char* text, std::size_t length)
    __attribute__((import_module("env"), import_name("evo_page_read_yaml")));

namespace evo {

class YamlBuilder {
 public:
  explicit YamlBuilder(const std::string& file)
      : file_(std::make_shared<const std::string>(file)) {}

  YamlNode build(const Json& tree) const {
    auto data = std::make_shared<YamlNode::Data>();
    data->file = file_;
    data->line = tree[1].get<int>();
    data->column = tree[2].get<int>();
    const auto& kind = tree[0].get_ref<const std::string&>();
    if (kind == "scalar") {
      data->kind = YamlNode::Kind::scalar;
      data->text = tree[3].get<std::string>();
      data->plain = tree[4].get<bool>();
    } else if (kind == "sequence") {
      data->kind = YamlNode::Kind::sequence;
      for (const Json& item : tree[3]) data->items.push_back(build(item));
    } else if (kind == "mapping") {
      data->kind = YamlNode::Kind::mapping;
      for (const Json& entry : tree[3]) data->entries.push_back({build(entry[0]), build(entry[1])});
      YamlNode::check_keys(data->entries);
    }
    YamlNode node;
    node.data_ = std::move(data);
    return node;
  }

 private:
  std::shared_ptr<const std::string> file_;
};

std::vector<YamlNode> YamlNode::documents(std::string_view text, const std::string& file) {
  const std::unique_ptr<char, decltype(&std::free)> answer(
      evo_page_read_yaml(text.data(), text.size()), &std::free);
  const Json read = Json::parse(answer.get());
  if (const auto problem = read.find("error"); problem != read.end())
    throw evo::error(Failure::data, "{}:{}:{}: not valid YAML: {}", file, read["line"].get<int>(),
                     read["column"].get<int>(), problem->get<std::string>());
  const YamlBuilder builder(file);
  std::vector<YamlNode> documents;
  for (const Json& tree : read["documents"]) documents.push_back(builder.build(tree));
  return documents;
}

}  // namespace evo
