// What the lists in the code name, the schemas and the manual name, too.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>

#include "formats/io/files.h"
#include "formats/io/json.h"
#include "formats/training/training.h"
#include "libevo/base/alternatives.h"
#include "libevo/control/settings.h"
#include "libevo/task/spec.h"

using namespace evo;

namespace {

std::string document(const std::string& name) {
  return read_file(std::filesystem::path(EVO_SOURCE_DIR) / "docs" / name);
}

// Whether `name` is a key or a value anywhere in the schema.
bool mentions(const Json& schema, const std::string& name) {
  if (schema.is_string()) return schema == name;
  if (schema.is_object() && schema.contains(name)) return true;
  if (!schema.is_structured()) return false;
  for (const Json& inner : schema)
    if (mentions(inner, name)) return true;
  return false;
}

// `section`: where the schema has them.
template <typename Pieces>
void check_pieces(const char* section) {
  const Json schema = parse_json(document("formats/schema/task.schema.json"), "task schema");
  const std::string manual = document("make-a-task.md");
  for (const std::string& name : names_of<Pieces>()) {
    INFO(name);
    CHECK(mentions(schema.at(Json::json_pointer(section)), name));
    CHECK_THAT(manual, Catch::Contains("`" + name));
  }
}

}  // namespace

TEST_CASE("schema and manual of tasks know every piece") {
  check_pieces<ObservationPart>("/properties/observation");
  check_pieces<reward::Term>("/properties/reward");
  check_pieces<Condition>("/$defs/condition");
}

TEST_CASE("the schema of training profiles knows every setting and algorithm") {
  const Json schema =
      parse_json(document("formats/schema/training.schema.json"), "training schema");
  for (const std::string& key : training_keys()) {
    INFO(key);
    CHECK(schema.at("properties").contains(key));
  }
  std::vector<std::string> listed = schema.at("properties").at("algorithm").at("enum");
  std::vector<std::string> names = algorithm_names();
  std::sort(listed.begin(), listed.end());
  std::sort(names.begin(), names.end());
  CHECK(listed == names);
}
