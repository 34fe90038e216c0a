// YAML documents as JSON values: for robots, whose documents are the same in
// both. (What people write by hand and what has a fixed set of keys is read by
// formats/io/yaml.h.)
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/json.h"

namespace evo {

struct YamlDocument {
  Json value;
  std::map<std::string, int> lines;  // by JSON path, from 1; "" is the whole

  // Of what a JSON path names, or of the nearest that exists around it.
  int line_of(std::string path) const;
};

// All documents that are not empty. Plain scalars have the types of YAML's core
// schema, what is quoted is text; so are the items of the keys `text_keys` at
// the outer level, quoted or not (an id may look like a number). Throws
// Error(data) with line and column; a key given twice, an alias inside of what it
// names, and aliases that blow a small text up are errors, too.
std::vector<YamlDocument> parse_yaml_documents(std::string_view text, const std::string& where,
                                               const std::vector<std::string>& text_keys);

}  // namespace evo
