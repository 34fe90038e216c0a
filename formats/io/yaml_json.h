// YAML documents as JSON values: for robots, whose documents are the same in
// both. (What people write by hand and what has a fixed set of keys is read by
// formats/io/yaml.h.)
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "formats/io/json.h"
#include "formats/io/yaml.h"

namespace evo {

struct YamlDocument {
  Json value;
  YamlNode root;

  // Of what a JSON path names, or of the nearest that exists around it; from 1.
  int line_of(std::string_view path) const;
};

// All documents that are not empty. Plain scalars have the types of YAML's core
// schema, what is quoted is text; so are the items of the keys `text_keys` at
// the outer level, quoted or not (an id may look like a number). Throws
// Error(data) with line and column; aliases that blow a small text up are errors, too.
std::vector<YamlDocument> parse_yaml_documents(std::string_view text, const std::string& where,
                                               const std::vector<std::string>& text_keys);

}  // namespace evo
