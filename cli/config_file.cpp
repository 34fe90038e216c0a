#include "cli/config_file.h"

#include <istream>

#include "formats/io/format.h"
#include "formats/io/yaml.h"

namespace evo::cli {
namespace {

constexpr std::size_t largest_config = std::size_t{1} << 20;  // bytes

std::string read_text(std::istream& input) {
  std::string text(largest_config + 1, '\0');
  input.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(input.gcount()));
  if (text.size() > largest_config)
    throw error(Failure::data, "--config: larger than {} bytes", largest_config);
  return text;
}

}  // namespace

std::vector<CLI::ConfigItem> YamlConfig::from_config(std::istream& input) const {
  const std::string text = read_text(input);
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) return {};
  const YamlNode root = YamlNode::parse(text, "--config");
  if (root.is_null()) return {};
  check_format(root, format::config);
  std::vector<CLI::ConfigItem> items;
  for (const YamlNode::Entry& entry : root.entries()) {
    CLI::ConfigItem item;
    item.name = entry.key.string();
    if (item.name == "format" || item.name == "version") continue;
    if (item.name == "config" || item.name == "help")
      throw entry.key.error(fmt::format("'{}' cannot be set in a configuration file", item.name));
    if (entry.value.is_sequence()) {
      const CLI::Option* option = app_.get_option_no_throw("--" + item.name);
      if (option != nullptr && option->get_multi_option_policy() != CLI::MultiOptionPolicy::TakeAll)
        throw entry.value.error(fmt::format("'{}' takes one value, not a list", item.name));
      for (const YamlNode& element : entry.value.items()) item.inputs.push_back(element.string());
    } else if (entry.value.is_scalar()) {
      item.inputs.push_back(entry.value.string());
    }
    if (item.inputs.empty())
      throw entry.value.error(fmt::format("'{}' needs a value or a list of values", item.name));
    items.push_back(std::move(item));
  }
  return items;
}

}  // namespace evo::cli
