#include "formats/io/json.h"

#include <catch2/catch.hpp>

#include "tests/unit/expect.h"

using namespace evo;

namespace {

// The message of the Error(data) that reading `text` this way throws.
template <typename Read>
std::string message(const std::string& text, Read read) {
  return test::error_of(Failure::data, [&] { read(Node::yaml(text, "t")); });
}

Node value(const std::string& text) {
  return Mapping(Node::yaml(text, "t"), "test", {"a"}).at("a");
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
  const Node root = Node::yaml("one: &same [1, 2]\ntwo: *same\n", "t");
  const Mapping map(root, "test", {"one", "two"});
  CHECK(map.at("two").items().at(1).integer() == 2);
}

TEST_CASE("errors say where, what was found and what is expected") {
  using Read = void (*)(const Node&);
  const auto whole = [](const Node& n) { n.entries()[0].value.integer(); };
  const auto number = [](const Node& n) { n.entries()[0].value.number(); };
  const std::vector<std::tuple<const char*, Read, const char*>> all{
      {"\n  a: fast\n", whole, "t:2:6: a whole number is expected, found 'fast'"},
      {"a: 7", [](const Node& n) { n.entries()[0].value.integer(0, 5); },
       "t:1:4: a whole number from 0 to 5 is expected, found '7'"},
      {"a: 1.5", whole, "t:1:4: a whole number is expected, found '1.5'"},
      {"a: 99999999999", whole, "t:1:4: a whole number is expected, found '99999999999'"},
      {"a: -1", [](const Node& n) { n.entries()[0].value.number(0); },
       "t:1:4: a number of at least 0 is expected, found '-1'"},
      {"a: .nan", number, "t:1:4: a number is expected, found '.nan'"},
      {"a: [1]", number, "t:1:4: a number is expected, found a list"},
      {"a: 0", [](const Node& n) { n.entries()[0].value.positive(); },
       "t:1:4: a number greater than 0 is expected, found '0'"},
      {"a: yes", [](const Node& n) { n.entries()[0].value.boolean(); },
       "t:1:4: true or false is expected, found 'yes'"},
      {"a: 5", [](const Node& n) { n.entries()[0].value.items(); },
       "t:1:4: a list is expected, found '5'"},
      {"[1]", [](const Node& n) { n.entries(); },
       "t:1:1: a mapping (key: value) is expected, found a list"},
      {"a: z",
       [](const Node& n) {
         n.entries()[0].value.choice("axis", {"x", "y"});
       },
       "t:1:4: unknown axis 'z' (did you mean 'x'?); allowed: x, y"},
      {"steps: 3\nrewrad: 1\n",
       [](const Node& n) {
         Mapping(n, "task", {"reward", "steps"});
       },
       "t:2:1: task: unknown key 'rewrad' (did you mean 'reward'?); allowed: reward, steps"},
      {"steps: 3\n",
       [](const Node& n) {
         Mapping(n, "task", {"reward", "steps"}).at("reward");
       },
       "t:1:1: task: key 'reward' is missing"}};
  for (const auto& [text, read, expected] : all) CHECK(message(text, read) == expected);
}

TEST_CASE("JSON has places and paths, and its types are kept apart") {
  const Node root = Node::json("{\"a\": [1, \"two \\\" ,\", true],\n \"b\":{\"c\":-2.5e1} }", "t");
  const std::vector<Node> items = root.at("a").items();
  CHECK(items[0].integer() == 1);
  CHECK(items[1].string() == "two \" ,");
  CHECK(items[2].boolean());
  CHECK(items[2].where() == "t:1:23: /a/2");
  CHECK(root.at("b").at("c").number() == -25.0);
  CHECK(root.at("b").at("c").where() == "t:2:11: /b/c");
  CHECK_THROWS_WITH(items[0].string(), "t:1:8: /a/0: text is expected, found '1'");
  CHECK_THROWS_WITH(items[1].number(), Catch::StartsWith("t:1:11: /a/1: a number is expected"));
  CHECK(to_json(root) == Json::parse(R"({"a":[1,"two \" ,",true],"b":{"c":-2.5e1}})"));
  CHECK_THROWS_WITH(Node::json("{\"a\":1,\n\"a\":2}", "t"),
                    "t:2:1: /a: key 'a' is given twice (first in line 1)");
  CHECK_THROWS_WITH(Node::json("{\"a\":\n [1,,2]}", "t"),
                    Catch::StartsWith("t:2:5: not valid JSON: "));
}

TEST_CASE("a document that makes no sense is refused") {
  const std::vector<std::pair<std::string, const char*>> all{
      {"a: 1\nb: 2\na: 3\n", "t:3:1: key 'a' is given twice (first in line 1)"},
      {"a: {b: 1, b: 2}", "t:1:11: key 'b' is given twice (first in line 1)"},
      {"", "t: the file is empty"},
      {"# only a comment\n", "t: the file is empty"},
      {"a: 1\n---\nb: 1\n", "t:3:1: a second document"},
      {"a: [1, 2\n", "t:"},
      {"a: &x [*x]\n", "t:1:8: an alias stands inside"},
      {"a: &x {b: 1}\nc:\n  <<: *x\n", "t:3:3: merge keys (<<) are not read"},
      {"a: *nowhere\n", "t:1:4: not valid YAML"},
      {"? [1]\n: 2\n", "t:1:3: a key is expected, found a list"},
      {"a: 1\nb: \"\x8a\"\n", "t:2:4: text that is not UTF-8"},
      {"\xff: 1\n", "t:1:"},
      {std::string(100000, '['), "t:"}};
  for (const auto& [text, expected] : all)
    CHECK_THAT(message(text, [](const Node&) {}), Catch::StartsWith(expected));
}
