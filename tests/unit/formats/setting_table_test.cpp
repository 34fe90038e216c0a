#include "formats/run/setting_table.h"

#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "formats/io/values.h"

using namespace evo;

namespace {

std::string without(const std::string& name,
                    const std::map<std::string, std::string>& others = {}) {
  return find_setting_entry(name)->value_without([&](const std::string& other) {
    const auto found = others.find(other);
    return found == others.end() ? std::string() : found->second;
  });
}

}  // namespace

TEST_CASE("the table of a run's settings is sound") {
  const std::set<std::string> types{"count", "number", "shape",   "name",   "list",
                                    "file",  "folder", "options", "command"};
  std::set<std::string> names;
  for (const SettingEntry& entry : setting_table()) {
    INFO(entry.name);
    CHECK(names.insert(entry.name).second);
    CHECK((types.contains(entry.type) || split_list(entry.type, '|').size() > 1));
    CHECK(!entry.pipelines.empty());
    CHECK(!entry.help.empty());
    // A default that is no words is a value; one that depends on another names a setting.
    const std::string initial = entry.value_without([](const std::string& other) {
      CHECK((other == "method" || find_setting_entry(other) != nullptr));
      return std::string();
    });
    if (!initial.empty()) CHECK(!entry.defect(initial));
    CHECK((entry.kept == Kept::no || run_schema().at("properties").contains(entry.name)));
  }
}

TEST_CASE("defaults of settings, some by another setting") {
  CHECK(without("pop") == "25");
  CHECK(without("pop", {{"method", "modular"}}) == "64");
  CHECK(without("shape") == "5x5");
  CHECK(without("shape", {{"task", "Lifter-v0"}}) == "5x7");
  CHECK(without("algo", {{"train", "paper"}}) == "ppo");
  CHECK(without("algo", {{"train", "lineage"}}) == "profile");
  CHECK(without("founder_steps").empty());
}

TEST_CASE("values of settings") {
  const SettingEntry& pop = *find_setting_entry("pop");
  for (const char* value : {"1", "25", "100000"}) CHECK(!pop.defect(value));
  for (const char* value : {"", "0", "-1", "1.5", "03", "x", "3 4", " 3"})
    CHECK(pop.defect(value) == fmt::format("is a number from 1, not '{}'", value));
  CHECK(!find_setting_entry("seed")->defect("0"));
  CHECK(find_setting_entry("inherit")->defect("maybe") == "is yes, no or all, not 'maybe'");
  CHECK(find_setting_entry("founder_steps")->variable() == "FOUNDER_STEPS");
  CHECK(find_setting_entry("rungs")->belongs_to("race"));
  CHECK(!find_setting_entry("rungs")->belongs_to("ga"));
  CHECK(present_name("population") == "pop");
}
