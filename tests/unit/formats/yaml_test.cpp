#include "formats/io/yaml.h"

#include <catch2/catch.hpp>

using evo::Error;
using evo::YamlMapping;
using evo::YamlNode;

namespace {

// The message of the Error(data) that reading `text` this way throws.
template <typename Read>
std::string message(const std::string& text, Read read) {
  try {
    read(YamlNode::parse(text, "t.yaml"));
  } catch (const Error& error) {
    CHECK(error.kind() == evo::Failure::data);
    return error.what();
  }
  return "(no error)";
}

std::string parse_message(const std::string& text) {
  return message(text, [](const YamlNode&) {});
}

YamlNode value(const std::string& text) {
  return YamlMapping(YamlNode::parse(text, "t.yaml"), "test", {"a"}).at("a");
}

}  // namespace

TEST_CASE("typed values are read") {
  CHECK(value("a: walk it").string() == "walk it");
  CHECK(value("a: 12").integer() == 12);
  CHECK(value("a: -6").integer(-6, 4) == -6);
  CHECK(value("a: 0.1").number() == 0.1);
  CHECK(value("a: +3e8").number() == 3e8);
  CHECK(value("a: true").boolean());
  CHECK_FALSE(value("a: false").boolean());
  CHECK(value("a: [1, 2, 3]").items().size() == 3);
  CHECK(value("a: {z: 1, b: 2}").entries().front().key.string() == "z");
  CHECK(value("a:").is_null());
  CHECK(value("a: y").choice("axis", {"x", "y"}) == "y");
}

TEST_CASE("an alias is the value it names") {
  const YamlNode root = YamlNode::parse("one: &same [1, 2]\ntwo: *same\n", "t.yaml");
  const YamlMapping map(root, "test", {"one", "two"});
  CHECK(map.at("two").items().at(1).integer() == 2);
}

TEST_CASE("errors say where, what was found and what is expected") {
  CHECK(message("\n  a: fast\n", [](const YamlNode& n) { n.entries()[0].value.integer(); }) ==
        "t.yaml:2:6: a whole number is expected, found 'fast'");
  CHECK(message("a: 7", [](const YamlNode& n) { n.entries()[0].value.integer(0, 5); }) ==
        "t.yaml:1:4: a whole number from 0 to 5 is expected, found '7'");
  CHECK(message("a: 1.5", [](const YamlNode& n) { n.entries()[0].value.integer(); }) ==
        "t.yaml:1:4: a whole number is expected, found '1.5'");
  CHECK(message("a: 99999999999", [](const YamlNode& n) { n.entries()[0].value.integer(); }) ==
        "t.yaml:1:4: a whole number is expected, found '99999999999'");
  CHECK(message("a: -1", [](const YamlNode& n) { n.entries()[0].value.number(0); }) ==
        "t.yaml:1:4: a number of at least 0 is expected, found '-1'");
  CHECK(message("a: .nan", [](const YamlNode& n) { n.entries()[0].value.number(); }) ==
        "t.yaml:1:4: a number is expected, found '.nan'");
  CHECK(message("a: 0", [](const YamlNode& n) { n.entries()[0].value.positive(); }) ==
        "t.yaml:1:4: a number greater than 0 is expected, found '0'");
  CHECK(message("a: [1]", [](const YamlNode& n) { n.entries()[0].value.number(); }) ==
        "t.yaml:1:4: a number is expected, found a list");
  CHECK(message("a: yes", [](const YamlNode& n) { n.entries()[0].value.boolean(); }) ==
        "t.yaml:1:4: true or false is expected, found 'yes'");
  CHECK(message("a: 5", [](const YamlNode& n) { n.entries()[0].value.items(); }) ==
        "t.yaml:1:4: a list is expected, found '5'");
  CHECK(message("[1]", [](const YamlNode& n) { n.entries(); }) ==
        "t.yaml:1:1: a mapping (key: value) is expected, found a list");
  CHECK(message("a: z", [](const YamlNode& n) {
          n.entries()[0].value.choice("axis", {"x", "y"});
        }).find("unknown axis 'z'") != std::string::npos);
}

TEST_CASE("a mapping refuses keys it does not know") {
  CHECK(message("steps: 3\nrewrad: 1\n",
                [](const YamlNode& n) {
                  YamlMapping(n, "task", {"reward", "steps"});
                }) ==
        "t.yaml:2:1: task: unknown key 'rewrad' (did you mean 'reward'?); allowed: reward, steps");
  CHECK(message("steps: 3\n", [](const YamlNode& n) {
          YamlMapping(n, "task", {"reward", "steps"}).at("reward");
        }) == "t.yaml:1:1: task: key 'reward' is missing");
}

TEST_CASE("a document that makes no sense is refused") {
  CHECK(parse_message("a: 1\nb: 2\na: 3\n") ==
        "t.yaml:3:1: key 'a' is given twice (first in line 1)");
  CHECK(parse_message("a: {b: 1, b: 2}") ==
        "t.yaml:1:11: key 'b' is given twice (first in line 1)");
  CHECK(parse_message("").find("t.yaml: the file is empty") == 0);
  CHECK(parse_message("# only a comment\n").find("t.yaml: the file is empty") == 0);
  CHECK(parse_message("a: 1\n---\nb: 1\n").find("t.yaml:3:1: a second document") == 0);
  CHECK(parse_message("a: [1, 2\n").find("t.yaml:") == 0);
  CHECK(parse_message("a: &x [*x]\n").find("t.yaml:1:8: an alias stands inside") == 0);
  CHECK(parse_message("a: *nowhere\n").find("t.yaml:1:4: not valid YAML") == 0);
  CHECK(parse_message("? [1]\n: 2\n").find("t.yaml:1:3: a key is expected, found a list") == 0);
  CHECK(parse_message("a: 1\nb: \"\x8a\"\n") == "t.yaml:2:4: text that is not UTF-8");
  CHECK(parse_message("\xff: 1\n").find("t.yaml:1:") == 0);
  CHECK(parse_message(std::string(100000, '[')).find("t.yaml:") == 0);
}
