#include "formats/run/neat.h"

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/json_object.h"
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

Species species_from_json(const JsonObject& object, int generation) {
  Species species;
  species.key = object.integer("key", 1, largest_count);
  species.created = object.integer("created", 0, generation);
  species.last_improved = object.integer("last_improved", 0, generation);
  const Json& members = object.array("members");
  for (std::size_t i = 0; i < members.size(); ++i)
    species.members.push_back(json_integer(
        members[i], fmt::format("{}/{}", object.path_of("members"), i), 0, largest_count));
  const Json& history = object.array("fitness_history");
  for (std::size_t i = 0; i < history.size(); ++i)
    species.fitness_history.push_back(
        json_number(history[i], fmt::format("{}/{}", object.path_of("fitness_history"), i)));
  species.representative =
      genome_from_json(object.at("representative"), object.path_of("representative"));
  return species;
}

// Counters are beyond every key in use, and nothing is in two places.
void check_keys(const NeatState& state) {
  std::set<int> species_keys;
  std::set<int> members;
  for (std::size_t i = 0; i < state.species.size(); ++i) {
    const Species& species = state.species[i];
    const std::string path = fmt::format("/species/{}", i);
    if (!species_keys.insert(species.key).second)
      throw refusal(path + "/key", "species {} is there twice", species.key);
    if (species.key >= state.next_species_key)
      throw refusal("/next_species_key", "{} is not beyond species {}", state.next_species_key,
                    species.key);
    for (const int member : species.members) {
      if (!members.insert(member).second)
        throw refusal(path + "/members", "genome {} is a member twice", member);
      if (member >= state.next_genome_key)
        throw refusal("/next_genome_key", "{} is not beyond genome {}", state.next_genome_key,
                      member);
    }
    const int last_node = species.representative.nodes.back().key;
    if (last_node >= state.next_node_key)
      throw refusal("/next_node_key", "{} is not beyond node {}", state.next_node_key, last_node);
  }
}

NeatState state_from_json(const Json& document) {
  check_format(document, format::neat_state);
  const JsonObject object(document, "");
  NeatState state;
  state.generation = object.integer("generation", 0, largest_count);
  state.next_genome_key = object.integer("next_genome_key", 1, largest_count);
  state.next_node_key = object.integer("next_node_key", 0, largest_count);
  state.next_species_key = object.integer("next_species_key", 1, largest_count);
  const Json& species = object.array("species");
  for (std::size_t i = 0; i < species.size(); ++i)
    state.species.push_back(
        species_from_json(JsonObject(species[i], fmt::format("/species/{}", i)), state.generation));
  check_keys(state);
  return state;
}

// ---- settings -------------------------------------------------------------------

using Setter = std::function<void(NeatSettings&, const YamlNode&)>;
using Setting = std::pair<std::string, Setter>;

Setter number(double NeatSettings::*member) {
  return [member](NeatSettings& s, const YamlNode& node) { s.*member = node.number(); };
}
Setter share(double NeatSettings::*member) {
  return [member](NeatSettings& s, const YamlNode& node) { s.*member = node.number(0, 1); };
}
Setter count(int NeatSettings::*member, int low) {
  return [member, low](NeatSettings& s, const YamlNode& node) {
    s.*member = node.integer(low, largest_count);
  };
}
Setter flag(bool NeatSettings::*member) {
  return [member](NeatSettings& s, const YamlNode& node) { s.*member = node.boolean(); };
}

Setter statistic(Statistic NeatSettings::*member) {
  return [member](NeatSettings& s, const YamlNode& node) {
    s.*member = node.choice<Statistic>("statistic");
  };
}

// neat-python's words: "partial_direct 0.5", "full_nodirect", "unconnected", ..
InitialConnection initial_connection(const YamlNode& node) {
  const std::vector<std::string> words{"unconnected", "full_direct", "full_nodirect",
                                       "partial_direct", "partial_nodirect"};
  std::istringstream text(node.string());
  std::string word;
  std::string fraction;
  std::string rest;
  text >> word >> fraction >> rest;
  const bool partial = word.starts_with("partial");
  if (std::find(words.begin(), words.end(), word) == words.end())
    throw node.error(unknown_name("initial connection", word, words));
  if (!rest.empty() || partial == fraction.empty())
    throw node.error(
        fmt::format("found {}; a partial connection takes one fraction from 0 to 1, "
                    "the others take none",
                    node.found()));
  InitialConnection connection{!word.ends_with("nodirect"), word == "unconnected" ? 0.0 : 1.0};
  if (partial) {
    const auto value = parse_number(fraction);
    if (!value || *value < 0.0 || *value > 1.0)
      throw node.error(fmt::format("fraction '{}': a number from 0 to 1 is allowed", fraction));
    connection.fraction = *value;
  }
  return connection;
}

// The settings of one number of the genes, such as bias_mutate_rate.
void add_attribute(std::vector<Setting>& settings, const std::string& name,
                   AttributeSettings NeatSettings::*attribute) {
  const std::pair<const char*, double AttributeSettings::*> parts[] = {
      {"init_mean", &AttributeSettings::init_mean},
      {"init_stdev", &AttributeSettings::init_stdev},
      {"replace_rate", &AttributeSettings::replace_rate},
      {"mutate_rate", &AttributeSettings::mutate_rate},
      {"mutate_power", &AttributeSettings::mutate_power},
      {"min_value", &AttributeSettings::min},
      {"max_value", &AttributeSettings::max}};
  for (const auto& [part, member] : parts)
    settings.emplace_back(name + "_" + part,
                          [attribute, member = member](NeatSettings& s, const YamlNode& node) {
                            (s.*attribute).*member = node.number();
                          });
}

std::vector<Setting> all_settings() {
  using S = NeatSettings;
  std::vector<Setting> settings{
      {"fitness_criterion", statistic(&S::fitness_criterion)},
      {"fitness_threshold", number(&S::fitness_threshold)},
      {"no_fitness_termination", flag(&S::no_fitness_termination)},
      {"pop_size", count(&S::pop_size, 2)},
      {"reset_on_extinction", flag(&S::reset_on_extinction)},
      {"keep_surplus", flag(&S::keep_surplus)},
      {"num_inputs", count(&S::num_inputs, 1)},
      {"num_hidden", count(&S::num_hidden, 0)},
      {"num_outputs", count(&S::num_outputs, 1)},
      {"initial_connection",
       [](S& s, const YamlNode& node) { s.initial_connection = initial_connection(node); }},
      {"feed_forward",
       [](S&, const YamlNode& node) {
         if (!node.boolean()) throw node.error("found false; only feed-forward networks are made");
       }},
      {"compatibility_disjoint_coefficient", number(&S::compatibility_disjoint_coefficient)},
      {"compatibility_weight_coefficient", number(&S::compatibility_weight_coefficient)},
      {"conn_add_prob", share(&S::conn_add_prob)},
      {"conn_delete_prob", share(&S::conn_delete_prob)},
      {"node_add_prob", share(&S::node_add_prob)},
      {"node_delete_prob", share(&S::node_delete_prob)},
      {"single_structural_mutation", flag(&S::single_structural_mutation)},
      {"activation_default",
       [](S& s, const YamlNode& node) {
         s.activation_default = node.choice<Activation>("activation");
       }},
      {"activation_options",
       [](S& s, const YamlNode& node) {
         s.activation_options.clear();
         for (const YamlNode& item : node.items())
           s.activation_options.push_back(item.choice<Activation>("activation"));
       }},
      {"activation_mutate_rate", share(&S::activation_mutate_rate)},
      {"aggregation_default",
       [](S& s, const YamlNode& node) {
         s.aggregation_default = node.choice<Aggregation>("aggregation");
       }},
      {"aggregation_options",
       [](S& s, const YamlNode& node) {
         s.aggregation_options.clear();
         for (const YamlNode& item : node.items())
           s.aggregation_options.push_back(item.choice<Aggregation>("aggregation"));
       }},
      {"aggregation_mutate_rate", share(&S::aggregation_mutate_rate)},
      {"enabled_default", flag(&S::enabled_default)},
      {"enabled_mutate_rate", share(&S::enabled_mutate_rate)},
      {"compatibility_threshold", number(&S::compatibility_threshold)},
      {"species_fitness_func", statistic(&S::species_fitness_func)},
      {"max_stagnation", count(&S::max_stagnation, 1)},
      {"species_elitism", count(&S::species_elitism, 0)},
      {"elitism", count(&S::elitism, 0)},
      {"survival_threshold", share(&S::survival_threshold)},
      {"min_species_size", count(&S::min_species_size, 1)}};
  add_attribute(settings, "bias", &S::bias);
  add_attribute(settings, "response", &S::response);
  add_attribute(settings, "weight", &S::weight);
  return settings;
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
  try {
    return state_from_json(parse_json(text, where));
  } catch (const Refusal& refused) {
    throw refused.at(where);
  }
}

NeatState load_neat_state(const std::string& file) {
  return parse_neat_state(read_input(file, largest_value), input_label(file));
}

NeatSettings neat_settings_from_yaml(const YamlNode& node) {
  const std::vector<Setting> known = all_settings();
  std::vector<std::string> keys{"format", "version"};
  for (const Setting& setting : known) keys.push_back(setting.first);
  const YamlMapping mapping(node, "NEAT settings", keys);
  check_format(mapping.node(), format::neat);
  NeatSettings settings;
  for (const auto& [key, set] : known)
    if (const auto value = mapping.find(key)) set(settings, *value);
  if (const auto found = defect(settings)) throw node.error(*found);
  return settings;
}

NeatSettings parse_neat_settings(const std::string& text, const std::string& where) {
  return neat_settings_from_yaml(
      YamlNode::parse(begins_as_ini(text) ? neat_ini_to_yaml(text, where) : text, where));
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

}  // namespace evo
