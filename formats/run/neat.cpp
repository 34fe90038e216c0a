#include "formats/run/neat.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/settings.h"
#include "formats/robot/genome.h"
#include "formats/run/neat_ini.h"

namespace evo {
namespace {

constexpr int largest_count = 1 << 30;  // leaves room to count on

// ---- state ----------------------------------------------------------------------

Json species_to_json(const Species& species) {
  Json document;
  document["key"] = species.key;
  document["created"] = species.created;
  document["last_improved"] = species.last_improved;
  document["members"] = species.members;
  document["fitness_history"] = species.fitness_history;
  document["representative"] = genome_to_json(species.representative);
  return document;
}

Species read_species(const Node& node, int generation) {
  Species species;
  species.key = node.at("key").integer(1, largest_count);
  species.created = node.at("created").integer(0, generation);
  species.last_improved = node.at("last_improved").integer(0, generation);
  for (const Node& member : node.at("members").items())
    species.members.push_back(member.integer(0, largest_count));
  species.fitness_history = node.at("fitness_history").numbers();
  species.representative = read_genome(node.at("representative"));
  return species;
}

// Counters are beyond every key in use, and nothing is in two places.
void check_keys(const NeatState& state, const Node& document) {
  std::set<int> species_keys;
  std::set<int> members;
  const std::vector<Node> nodes = document.at("species").items();
  const auto check_counter = [&](const char* name, int next, const char* what, int used) {
    if (used >= next)
      throw document.at(name).error(fmt::format("{} is not beyond {} {}", next, what, used));
  };
  for (std::size_t i = 0; i < state.species.size(); ++i) {
    const Species& species = state.species[i];
    if (!species_keys.insert(species.key).second)
      throw nodes[i].at("key").error(fmt::format("species {} is there twice", species.key));
    check_counter("next_species_key", state.next_species_key, "species", species.key);
    for (const int member : species.members) {
      if (!members.insert(member).second)
        throw nodes[i].at("members").error(fmt::format("genome {} is a member twice", member));
      check_counter("next_genome_key", state.next_genome_key, "genome", member);
    }
    check_counter("next_node_key", state.next_node_key, "node",
                  species.representative.nodes.back().key);
  }
}

// ---- settings -------------------------------------------------------------------

}  // namespace

// neat-python's words: "partial_direct 0.5", "full_nodirect", "unconnected", ..
template <>
struct setting::Value<InitialConnection> {
  static std::vector<std::string> all() {
    return {"unconnected", "full_direct", "full_nodirect", "partial_direct", "partial_nodirect"};
  }
  static std::string kind(const Range&) { return fmt::format("{}", fmt::join(all(), "|")); }
  static std::string expected(const Range&) {
    return fmt::format(
        "one of {}, a partial one with a fraction from 0 to 1, as in "
        "'partial_direct 0.5',",
        fmt::join(all(), ", "));
  }
  static std::optional<InitialConnection> parse(std::string_view given, const Range&) {
    std::istringstream text{std::string(given)};
    std::string word;
    std::string fraction;
    std::string rest;
    text >> word >> fraction >> rest;
    const auto known = all();
    const bool partial = word.starts_with("partial");
    if (std::find(known.begin(), known.end(), word) == known.end() || !rest.empty() ||
        partial == fraction.empty())
      return std::nullopt;
    const bool direct = !word.ends_with("nodirect");
    if (!partial) return InitialConnection{direct, word == "unconnected" ? 0.0 : 1.0};
    const auto share = Value<double>::parse(fraction, a_share);
    return share ? std::optional(InitialConnection{direct, *share}) : std::nullopt;
  }
  static std::string text(const InitialConnection& connection) {
    return fmt::format("partial_{} {}", connection.direct ? "direct" : "nodirect",
                       connection.fraction);
  }
  static Json schema(const Range&) { return {{"type", "string"}}; }
};

namespace {

// The settings of one number of the genes, such as bias_mutate_rate.
void add_attribute(std::vector<Setting<NeatSettings>>& settings, const std::string& name,
                   AttributeSettings NeatSettings::*attribute) {
  const auto add = [&](const char* part, double AttributeSettings::*member, Range range,
                       const char* meaning) {
    settings.emplace_back(name + "_" + part, within(attribute, member), range, "", meaning);
  };
  add("init_mean", &AttributeSettings::init_mean, {}, "of a new one");
  add("init_stdev", &AttributeSettings::init_stdev, at_least(0), "of a new one");
  add("replace_rate", &AttributeSettings::replace_rate, a_share, "chance of a new one");
  add("mutate_rate", &AttributeSettings::mutate_rate, a_share, "chance of a change");
  add("mutate_power", &AttributeSettings::mutate_power, at_least(0), "deviation of a change");
  add("min_value", &AttributeSettings::min, {}, "the least");
  add("max_value", &AttributeSettings::max, {}, "the most");
}

void check_neat(const NeatSettings& settings) {
  if (const auto found = defect(settings)) throw Error(Failure::usage, *found);
}

const SettingTable<NeatSettings>& table() {
  using S = NeatSettings;
  const Range from_1 = between(1, largest_count);
  const Range from_0 = between(0, largest_count);
  static const SettingTable<NeatSettings> all = [&] {
    std::vector<Setting<NeatSettings>> settings{
        {"fitness_criterion", &S::fitness_criterion, "", "of a generation"},
        {"fitness_threshold", &S::fitness_threshold, "", "at which a run ends"},
        {"no_fitness_termination", &S::no_fitness_termination, "", "no threshold"},
        {"pop_size", &S::pop_size, between(2, largest_count), "", "robots of a generation"},
        {"reset_on_extinction", &S::reset_on_extinction, "", "begin anew without species"},
        {"num_inputs", &S::num_inputs, from_1, "", "of the CPPN"},
        {"num_hidden", &S::num_hidden, from_0, "", "of the CPPN, at first"},
        {"num_outputs", &S::num_outputs, from_1, "", "of the CPPN"},
        {"initial_connection", &S::initial_connection, "", "of inputs and outputs"},
        {"compatibility_disjoint_coefficient", &S::compatibility_disjoint_coefficient, "",
         "of genes that one of two genomes has"},
        {"compatibility_weight_coefficient", &S::compatibility_weight_coefficient, "",
         "of differences in numbers"},
        {"conn_add_prob", &S::conn_add_prob, a_share, "", "chance of a new connection"},
        {"conn_delete_prob", &S::conn_delete_prob, a_share, "", "chance to lose a connection"},
        {"node_add_prob", &S::node_add_prob, a_share, "", "chance of a new node"},
        {"node_delete_prob", &S::node_delete_prob, a_share, "", "chance to lose a node"},
        {"activation_default", &S::activation_default, "", "of new nodes"},
        {"activation_options", &S::activation_options, "", "those that nodes may have"},
        {"activation_mutate_rate", &S::activation_mutate_rate, a_share, "", "chance of another"},
        {"aggregation_default", &S::aggregation_default, "", "of new nodes"},
        {"aggregation_options", &S::aggregation_options, "", "those that nodes may have"},
        {"aggregation_mutate_rate", &S::aggregation_mutate_rate, a_share, "", "chance of another"},
        {"enabled_default", &S::enabled_default, "", "of new connections"},
        {"enabled_mutate_rate", &S::enabled_mutate_rate, a_share, "", "chance of a fair coin"},
        {"compatibility_threshold", &S::compatibility_threshold, "", "within a species"},
        {"species_fitness_func", &S::species_fitness_func, "", "of its members'"},
        {"max_stagnation", &S::max_stagnation, from_1, "generations",
         "without a better species fitness"},
        {"species_elitism", &S::species_elitism, from_0, "", "best species that never stagnate"},
        {"elitism", &S::elitism, from_0, "", "best members that stay unchanged"},
        {"survival_threshold", &S::survival_threshold, a_share, "",
         "share of a species that may be parents"},
        {"min_species_size", &S::min_species_size, from_1, "", "members of a species"}};
    add_attribute(settings, "bias", &S::bias);
    add_attribute(settings, "response", &S::response);
    add_attribute(settings, "weight", &S::weight);
    return SettingTable<NeatSettings>(std::move(settings), check_neat);
  }();
  return all;
}

}  // namespace

std::string neat_state_to_text(const NeatState& state) {
  std::string text = fmt::format(
      "{{\"format\": \"{}\", \"version\": {},\n"
      " \"generation\": {}, \"next_genome_key\": {}, \"next_node_key\": {}, "
      "\"next_species_key\": {},\n"
      " \"species\": [",
      format::neat_state.name, format::neat_state.version, state.generation, state.next_genome_key,
      state.next_node_key, state.next_species_key);
  const char* separator = "\n  ";
  for (const Species& species : state.species) {
    text += separator + compact(species_to_json(species));
    separator = ",\n  ";
  }
  return text + "\n ]}\n";
}

NeatState parse_neat_state(std::string_view text, const std::string& where) {
  const Node document = Node::json(text, where);
  check_format(document, format::neat_state);
  NeatState state;
  state.generation = document.at("generation").integer(0, largest_count);
  state.next_genome_key = document.at("next_genome_key").integer(1, largest_count);
  state.next_node_key = document.at("next_node_key").integer(0, largest_count);
  state.next_species_key = document.at("next_species_key").integer(1, largest_count);
  for (const Node& species : document.at("species").items())
    state.species.push_back(read_species(species, state.generation));
  check_keys(state, document);
  return state;
}

NeatState load_neat_state(const std::string& file) {
  return parse_neat_state(read_input(file, largest_value), input_label(file));
}

NeatSettings parse_neat_settings(const std::string& text, const std::string& where) {
  const Node node = Node::yaml(begins_as_ini(text) ? neat_ini_to_yaml(text, where) : text, where);
  std::vector<std::string> keys = table().keys();
  for (const char* key : {"format", "version", "feed_forward"}) keys.emplace_back(key);
  const Mapping mapping(node, "NEAT settings", keys);
  check_format(mapping.node(), format::neat);
  if (const auto feed_forward = mapping.find("feed_forward"))
    if (!feed_forward->boolean())
      throw feed_forward->error("found false; only feed-forward networks are made");
  NeatSettings settings;
  table().read(settings, mapping);
  return settings;
}

NeatSettings load_neat_settings(const std::string& file) {
  return parse_neat_settings(read_input(file, largest_document), input_label(file));
}

NeatSettings neat_settings(const std::optional<std::string>& file, std::optional<int> count,
                           const DataFolders& folders) {
  NeatSettings settings;
  if (file) {
    settings = load_neat_settings(*file);
    if (!settings.no_fitness_termination)
      throw error(Failure::data,
                  "{}: no_fitness_termination is false, but runs end by their number of robots; "
                  "set it to true",
                  input_label(*file));
  } else if (const auto found = find_data_file(folders, "", "neat")) {
    settings = load_neat_settings(found->string());
  }
  if (count || !file) settings.pop_size = count.value_or(default_population);
  return settings;
}

Json neat_schema() {
  Json schema = table().schema(format::neat);
  schema["properties"]["feed_forward"] = {{"const", true}};
  return schema;
}

}  // namespace evo
