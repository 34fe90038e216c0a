#include "formats/run/steady.h"

#include <limits>

#include "formats/io/format.h"
#include "formats/io/json_object.h"
#include "formats/robot/genome.h"
#include "formats/run/neat.h"

namespace evo {
namespace {

constexpr int largest_count = 1 << 30;

// What a parent needs, and nothing else of its document.
Json member_to_json(const ScoredRobot& robot) {
  Robot member(robot.body);
  member.document["fitness"] = robot.fitness;
  if (robot.genome) member.document["genome"] = genome_to_json(*robot.genome);
  if (!robot.features.empty()) member.document["features"] = robot.features;
  return Json::parse(robot_to_line(member));
}

ScoredRobot member_from_json(const Json& json, const std::string& where) {
  const Robot robot = robot_from_json(json, where, BodyCheck::any);
  ScoredRobot member = scored_robot(robot);
  if (!robot.fitness()) throw error(Failure::data, "{}: a member has a fitness", where);
  if (!json.contains("features")) return member;
  const JsonObject object(json, "");
  const Json& features = object.array("features");
  for (std::size_t i = 0; i < features.size(); ++i)
    member.features.push_back(
        json_number(features[i], fmt::format("{}/{}", object.path_of("features"), i)));
  return member;
}

SteadyState from_json(const Json& document, const std::string& where) {
  check_format(document, format::steady);
  const JsonObject object(document, "");
  SteadyState state;
  state.robots = object.integer("robots", 0, largest_count);
  MethodState& method = state.method;
  method.told = object.integer("scores", 0, state.robots);
  if (document.contains("parameters")) {
    const JsonObject parameters(object.at("parameters"), "/parameters");
    method.fitted = parameters.integer("fitted", 1, method.told);
    method.parameters = GpParameters{parameters.number("variance"),
                                     parameters.number("length_scale"), parameters.number("noise")};
  }
  method.species = parse_neat_state(compact(object.at("species")), where);
  const Json& members = object.array("members");
  for (std::size_t i = 0; i < members.size(); ++i)
    method.members.push_back(
        member_from_json(members[i], fmt::format("{}: /members/{}", where, i)));
  return state;
}

}  // namespace

std::string steady_state_to_text(const SteadyState& state) {
  const MethodState& method = state.method;
  Json document;
  document["format"] = format::steady.name;
  document["version"] = format::steady.version;
  document["robots"] = state.robots;
  document["scores"] = method.told;
  if (method.parameters)
    document["parameters"] = {{"fitted", method.fitted},
                              {"variance", method.parameters->variance},
                              {"length_scale", method.parameters->length_scale},
                              {"noise", method.parameters->noise}};
  document["species"] = Json::parse(neat_state_to_text(method.species));
  document["members"] = Json::array();
  for (const ScoredRobot& robot : method.members)
    document["members"].push_back(member_to_json(robot));
  return compact(document) + "\n";
}

ScoredRobot scored_robot(const Robot& robot) {
  return {robot.id,
          robot.body,
          robot.fitness().value_or(std::numeric_limits<double>::quiet_NaN()),
          genome_of(robot, "robot " + robot.id),
          {}};
}

SteadyState parse_steady_state(std::string_view text, const std::string& where) {
  try {
    return from_json(parse_json(text, where), where);
  } catch (const Refusal& refused) {
    throw refused.at(where);
  }
}

}  // namespace evo
