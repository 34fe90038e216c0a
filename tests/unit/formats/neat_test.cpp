#include "formats/run/neat.h"

#include <catch2/catch.hpp>

#include "formats/io/files.h"
#include "formats/io/number.h"
#include "formats/run/neat_ini.h"
#include "tests/unit/expect.h"

using namespace evo;
using evo::test::error_of;

namespace {

bool accept_all(const Genome&) { return true; }

std::vector<Scored> scored(const std::vector<Individual>& population) {
  std::vector<Scored> scored;
  for (const Individual& individual : population)
    scored.push_back({individual.genome, individual.genome.nodes[1].bias / 3.0});
  return scored;
}

NeatState some_state() {
  NeatSettings settings;
  NeatState state;
  auto population = first_generation(settings, accept_all, state, 1);
  for (int k = 0; k < 4; ++k)
    population = next_generation(settings, scored(population), accept_all, state, 1);
  return state;
}

// A sound state, but for one change.
template <typename Change>
void read_changed_state(Change change) {
  Json document = Json::parse(neat_state_to_text(some_state()));
  change(document);
  parse_neat_state(document.dump(), "s.json");
}

NeatSettings settings_of(const std::string& text) { return parse_neat_settings(text, "n.yaml"); }

}  // namespace

TEST_CASE("a state written and read is the same, and so is the generation after it") {
  NeatSettings settings;
  NeatState state;
  auto population = first_generation(settings, accept_all, state, 1);
  for (int k = 0; k < 6; ++k) {
    NeatState restored = parse_neat_state(neat_state_to_text(state), "state");
    REQUIRE(restored == state);
    const auto again = next_generation(settings, scored(population), accept_all, restored, 1);
    population = next_generation(settings, scored(population), accept_all, state, 1);
    REQUIRE(restored == state);
    for (std::size_t i = 0; i < population.size(); ++i)
      REQUIRE(again[i].genome == population[i].genome);
  }
}

TEST_CASE("a state that cannot be right is refused with its path") {
  using Change = void (*)(Json&);
  const std::vector<std::pair<Change, const char*>> all{
      {[](Json& s) { s["format"] = "evo/robot"; },
       ": /format: format 'evo/neat-state' is expected, found 'evo/robot'"},
      {[](Json& s) { s["version"] = 2; }, "newer than this program"},
      {[](Json& s) { s.erase("generation"); }, "s.json:1:1: key 'generation' is missing"},
      {[](Json& s) { s["species"][0]["last_improved"] = 77; },
       ": /species/0/last_improved: a whole number from 0 to 4 is expected, found '77'"},
      {[](Json& s) { s["species"][0]["members"][0] = "x"; },
       ": /species/0/members/0: a whole number from 0 to 1073741824 is expected, found 'x'"},
      {[](Json& s) { s["species"].push_back(s["species"][0]); }, "twice"},
      {[](Json& s) { s["next_genome_key"] = 3; }, "is not beyond genome"},
      {[](Json& s) { s["species"][0]["representative"]["nodes"][0]["bias"] = nullptr; },
       ": /species/0/representative/nodes/0/bias: a number is expected, found nothing"}};
  for (const auto& [change, expected] : all)
    CHECK_THAT(error_of(Failure::data, [&] { read_changed_state(change); }),
               Catch::Contains(expected));
  CHECK_NOTHROW(read_changed_state([](Json&) {}));
  CHECK_NOTHROW(read_changed_state([](Json& s) { s["later"] = 1; }));
  CHECK_THROWS_WITH(parse_neat_state("[1]", "s.json"), Catch::Contains("a mapping"));
}

TEST_CASE("tasks/neat.yaml spells out the built-in settings, every one of them") {
  const std::string file = "tasks/neat.yaml";
  CHECK(load_neat_settings(file) == NeatSettings{});
  // Another value of each number or flag must arrive somewhere: no key is deaf.
  const Node document = Node::yaml(read_file(file), file);
  int changed = 0;
  for (const auto& [key, value] : document.entries()) {
    const std::string name = key.string();
    if (!value.is_scalar() || name == "version" || name == "feed_forward") continue;
    std::string other;
    if (const auto number = finite_number(value.string())) {
      const bool whole = *number == static_cast<int>(*number);
      other = fmt::format("{}", !whole           ? *number / 2
                                : *number == 0.0 ? 1
                                : *number == 1.0 ? 2
                                                 : *number - 1);
    } else if (value.string() == "true" || value.string() == "false") {
      other = value.boolean() ? "false" : "true";
    } else {
      continue;  // words: tested below
    }
    INFO(name << ": " << other);
    CHECK_FALSE(settings_of(name + ": " + other) == NeatSettings{});
    ++changed;
  }
  CHECK(changed >= 41);
}

// tasks/neat.yaml as neat-python would have it.
std::string as_ini(const Node& document) {
  std::string text = "# of the benchmark\n[NEAT]\n";
  for (const auto& [key, value] : document.entries()) {
    const std::string name = key.string();
    if (name == "format" || name == "version") continue;
    if (name == "num_inputs") text += "\n[DefaultGenome]\n; more\n";
    std::string given = value.is_sequence() ? value.items()[0].string() : value.string();
    if (given == "true") given = "True";
    if (given == "false") given = "0";
    text += fmt::format("{:<24}= {} \n", name, given);
  }
  return text + "[DefaultStagnation]\n\n[DefaultReproduction]";
}

TEST_CASE("neat-python's own files are read, or refused with their line") {
  const std::string file = "tasks/neat.yaml";
  const std::string ini = as_ini(Node::yaml(read_file(file), file));
  CHECK(begins_as_ini(ini));
  CHECK(parse_neat_settings(ini, "neat.cfg") == NeatSettings{});
  const auto read = [](const std::string& text) { return parse_neat_settings(text, "neat.cfg"); };
  const NeatSettings settings = read(
      "[NEAT]\r\nPop_Size: 33\r\n[DefaultGenome]\nactivation_options = sigmoid\n  tanh sin\n"
      "bias_init_type = Gaussian\nsingle_structural_mutation = False\nenabled_default = "
      "off\ninitial_connection = partial_direct "
      "0.25\n");
  CHECK(settings.pop_size == 33);
  CHECK(settings.activation_options ==
        std::vector<Activation>{Activation::sigmoid, Activation::tanh, Activation::sin});
  CHECK_FALSE(settings.enabled_default);
  CHECK(settings.initial_connection == InitialConnection{true, 0.25});
  using Catch::StartsWith;
  CHECK_THROWS_WITH(read("[NEAT]\n\npop_size = five\n"),
                    StartsWith("neat.cfg:3:") && Catch::Contains("'five'"));
  CHECK_THROWS_WITH(read("[NEAT]\npop_sise = 5\n"),
                    StartsWith("neat.cfg:2:") && Catch::Contains("pop_size"));
  CHECK_THROWS_WITH(read("[NEAT]\n[Genome]\n"), Catch::Contains(":2: '[Genome]' is no section"));
  CHECK_THROWS_WITH(read("[NEAT]\nweight_init_type = uniform\n"),
                    Catch::Contains(":2: weight_init_type may be gaussian or normal here"));
  CHECK_THROWS_WITH(read("[DefaultGenome]\nsingle_structural_mutation = True\n"),
                    Catch::Contains(":2: single_structural_mutation may be false"));
  CHECK_THROWS_WITH(read("[NEAT]\npop_size\n"), Catch::Contains(":2: expected KEY = VALUE"));
  CHECK_THROWS_WITH(read("[NEAT]\npop_size = 3\npop_size = 4\n"), Catch::Contains("twice"));
  CHECK_THROWS_WITH(read("[NEAT]\npop_size =\n"), StartsWith("neat.cfg:2:"));
  CHECK_FALSE(begins_as_ini("[[3,3],[4,4]]"));
}

TEST_CASE("settings can be changed one by one") {
  CHECK(settings_of("initial_connection: unconnected").initial_connection ==
        InitialConnection{true, 0.0});
  CHECK(settings_of("initial_connection: full_nodirect").initial_connection ==
        InitialConnection{false, 1.0});
  CHECK(settings_of("initial_connection: partial_nodirect 0.25").initial_connection ==
        InitialConnection{false, 0.25});
  CHECK(settings_of("weight_mutate_power: 0.75").weight.mutate_power == 0.75);
  CHECK(settings_of("species_fitness_func: median").species_fitness_func == Statistic::median);
  CHECK(settings_of("activation_options: [sin, gauss]").activation_options ==
        std::vector{Activation::sin, Activation::gauss});
}

TEST_CASE("bad settings are refused with their place") {
  const std::vector<std::pair<const char*, const char*>> all{
      {"conn_add_probb: 0.1",
       "n.yaml:1:1: NEAT settings: unknown key 'conn_add_probb' (did you mean 'conn_add_prob'?)"},
      {"pop_size: 20\nconn_add_prob: 1.5", "n.yaml:2:16: "},
      {"weight_mutate_rate: 1.5", "n.yaml:1:21: "},
      {"bias_init_stdev: -1", "at least 0"},
      {"feed_forward: false", "only feed-forward"},
      {"initial_connection: partial_direct", "a partial one with a fraction from 0 to 1"},
      {"initial_connection: partial_direct 2", "from 0 to 1"},
      {"initial_connection: ful_direct", "did you mean 'full_direct'"},
      {"bias_min_value: 40", "bias: min 40 is above max 30"},
      {"format: evo/task", "evo/task"}};
  for (const auto& [text, expected] : all)
    CHECK_THAT(error_of(Failure::data, [&, &settings = text] { settings_of(settings); }),
               Catch::Contains(expected));
}
