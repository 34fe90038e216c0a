#include "formats/run/steady.h"

#include "formats/io/format.h"
#include "formats/io/json_object.h"
#include "formats/run/neat.h"

namespace evo {
namespace {

constexpr int largest_count = 1 << 30;

// What a parent needs, and nothing else of its document.
Json member_to_json(const Robot& robot) {
  Robot member(robot.body);
  for (const char* field : {"fitness", "genome"})
    if (const auto found = robot.document.find(field); found != robot.document.end())
      member.document[field] = *found;
  return Json::parse(robot_to_line(member));
}

SteadyState from_json(const Json& document, const std::string& where) {
  check_format(document, format::steady);
  const JsonObject object(document, "");
  SteadyState state;
  state.robots = object.integer("robots", 0, largest_count);
  state.scores = object.integer("scores", 0, state.robots);
  if (document.contains("parameters")) {
    const JsonObject parameters(object.at("parameters"), "/parameters");
    state.fitted = parameters.integer("fitted", 1, state.scores);
    state.parameters = GpParameters{parameters.number("variance"),
                                    parameters.number("length_scale"), parameters.number("noise")};
  }
  state.species = parse_neat_state(compact(object.at("species")), where);
  const Json& members = object.array("members");
  for (std::size_t i = 0; i < members.size(); ++i)
    state.members.push_back(
        robot_from_json(members[i], fmt::format("{}: /members/{}", where, i), BodyCheck::any));
  return state;
}

}  // namespace

std::string steady_state_to_text(const SteadyState& state) {
  Json document;
  document["format"] = format::steady.name;
  document["version"] = format::steady.version;
  document["robots"] = state.robots;
  document["scores"] = state.scores;
  if (state.parameters)
    document["parameters"] = {{"fitted", state.fitted},
                              {"variance", state.parameters->variance},
                              {"length_scale", state.parameters->length_scale},
                              {"noise", state.parameters->noise}};
  document["species"] = Json::parse(neat_state_to_text(state.species));
  document["members"] = Json::array();
  for (const Robot& robot : state.members) document["members"].push_back(member_to_json(robot));
  return compact(document) + "\n";
}

SteadyState parse_steady_state(std::string_view text, const std::string& where) {
  try {
    return from_json(parse_json(text, where), where);
  } catch (const Refusal& refused) {
    throw refused.at(where);
  }
}

}  // namespace evo
