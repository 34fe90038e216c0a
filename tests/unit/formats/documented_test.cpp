// What the lists in the code name, the schemas and the manual name, too.
#include <catch2/catch.hpp>

#include "formats/io/files.h"
#include "formats/io/json.h"
#include "formats/task/physics_profile.h"
#include "formats/training/training.h"
#include "libevo/base/alternatives.h"
#include "libevo/control/settings.h"
#include "libevo/task/spec.h"

using namespace evo;

namespace {

std::string document(const std::string& name) { return read_file("docs/" + name); }

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
  const Json schema = Json::parse(document("formats/schema/task.schema.json"));
  const std::string manual = document("make-a-task.md");
  for (const std::string& name : names_of<Pieces>()) {
    INFO(name);
    CHECK(mentions(schema.at(Json::json_pointer(section)), name));
    CHECK_THAT(manual, Catch::Contains("`" + name));
  }
}

// What a new line of the table brings by itself.
template <typename Settings>
void check_rows(const Profiles<Settings>& profiles) {
  for (const SettingRow& row : profiles.rows({})) {
    INFO(row.key);
    const std::size_t dot = row.key.find('.');
    const std::string own_key = row.key.substr(dot + 1);  // of soft.edge: edge
    Json group = profiles.schema();
    if (dot != std::string::npos) group = group.at("properties").at(row.key.substr(0, dot));
    const Json& property = group.at("properties").at(own_key);
    CHECK(property.at("description") == row.meaning);
    // Another value, of its kind.
    std::string other = row.value == "true" ? "false" : row.value == "false" ? "true" : "0.5";
    if (property.contains("enum"))
      for (const Json& word : property.at("enum"))
        if (word != row.value) other = word.get<std::string>();
    const bool whole = row.kind.starts_with("whole");
    const bool list = row.kind.starts_with("list");
    if (whole) other = "12";
    if (list) other = "[7, 8]";
    if (other == row.value) other = "0.25";
    if (property.contains("minimum") && property.at("minimum") > 0.5) other = "12";
    Settings changed;
    profiles.assign(changed, row.key + "=" + other);
    CHECK(!(changed == Settings{}));
    CHECK(profiles.identity(changed) != profiles.identity({}));
    CHECK_THAT(profiles.to_yaml(changed), Catch::Contains(own_key + ": " + other));
    // What the schema has for the least is the least.
    const Json& number = list ? property.at("items") : property;
    for (const char* bound : {"minimum", "exclusiveMinimum"})
      if (number.contains(bound)) {
        const double below = number.at(bound).get<double>() - (whole || list ? 1.0 : 1e-3);
        CHECK_THROWS_WITH(profiles.assign(changed, fmt::format("{}={}", row.key, below)),
                          Catch::Contains(row.key));
      }
  }
}

}  // namespace

TEST_CASE("schema and manual of tasks know every piece") {
  check_pieces<ObservationPart>("/properties/observation");
  check_pieces<reward::Term>("/properties/reward");
  check_pieces<Condition>("/$defs/condition");
}

TEST_CASE("a setting stands in one table, and is read, written, checked and identified") {
  check_rows(physics_profiles());
  check_rows(training_profiles());
}

TEST_CASE("schema and help of the setting algorithm name every algorithm") {
  const std::vector<std::string> listed =
      training_profiles().schema().at("properties").at("algorithm").at("enum");
  CHECK(listed == words_of<Algorithm>());
  const SettingRow algorithm = training_profiles().rows({}).front();
  REQUIRE(algorithm.key == "algorithm");
  for (const std::string& name : words_of<Algorithm>())
    CHECK_THAT(algorithm.meaning, Catch::Contains(name));
}
