// Inside of YamlNode: what a parser fills in (yaml_parser.cpp; bindings/web/wasm/yaml_parser.cpp in
// browsers) and yaml.cpp reads.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "formats/io/yaml.h"

namespace evo {

struct YamlNode::Data {
  Kind kind = Kind::null;
  std::shared_ptr<const std::string> file;
  int line = 0;  // from 1
  int column = 0;
  std::string text;             // scalar
  bool plain = false;           // scalar without quotes and tag
  std::vector<YamlNode> items;  // sequence
  std::vector<Entry> entries;   // mapping
};

}  // namespace evo
