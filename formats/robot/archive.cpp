#include "formats/robot/archive.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/io/text.h"
#include "formats/io/values.h"
#include "libevo/base/error.h"
#include "libevo/task/behaviour.h"

namespace evo {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
const std::string behaviour = "behaviour.";

std::vector<std::string> behaviours() {
  std::vector<std::string> names;
  names.reserve(behaviour_features.size());
  for (const BehaviourFeature& feature : behaviour_features)
    names.push_back(behaviour + feature.name);
  return names;
}

bool is_in(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// What names itself a behaviour is one; a slip would be found only after the trainings.
void check_behaviour(const std::string& name, const std::string& where) {
  if (const auto known = behaviours(); name.starts_with(behaviour) && !is_in(name, known))
    throw error(Failure::usage, "{}: '{}' is no behaviour{}; there are {}", where, name,
                did_you_mean(name, known), fmt::join(known, ", "));
}

FeatureAxis parse_axis(const std::string& text, const std::string& where) {
  const auto pieces = split(text, ":");
  const std::vector<std::string> words(pieces.begin(), pieces.end());
  if ((words.size() != 2 && words.size() != 4) || words[0].empty())
    throw error(Failure::usage, "{}: '{}' is neither NAME:BINS nor NAME:BINS:LOW:HIGH", where,
                text);
  FeatureAxis axis;
  axis.name = words[0];
  axis.bins = static_cast<int>(parse_whole(words[1], where, 1, 1'000'000));
  check_behaviour(axis.name, where);
  if (words.size() == 4) {
    axis.low = parse_number(words[2], where);
    axis.high = parse_number(words[3], where);
  } else if (is_in(axis.name, behaviours())) {
    throw error(Failure::usage, "{}: a behaviour needs its range, {}:LOW:HIGH", where, text);
  } else if (const auto& known = body_features(); !is_in(axis.name, known)) {
    throw error(Failure::usage,
                "{}: '{}' is no feature of bodies{}; a number of the documents needs its "
                "range, {}:LOW:HIGH",
                where, axis.name, did_you_mean(axis.name, known), text);
  }
  return axis;
}

}  // namespace

GridArchive parse_archive(const std::string& list, const std::string& where) {
  std::vector<FeatureAxis> axes;
  for (const std::string& text : split_list(list)) axes.push_back(parse_axis(text, where));
  return GridArchive(std::move(axes));
}

double feature_of(const Robot& robot, const std::string& name) {
  if (const auto value = body_feature(robot.body, name)) return *value;
  return number_of(robot, name).value_or(nothing);
}

std::string feature_title(const std::string& name) {
  for (const BehaviourFeature& feature : behaviour_features)
    if (name == behaviour + feature.name) return fmt::format("{}, {}", name, feature.measure);
  return is_in(name, body_features()) ? name + " (body), share" : name;
}

std::vector<double> features_of(const Robot& robot, const std::vector<FeatureAxis>& axes) {
  std::vector<double> features;
  features.reserve(axes.size());
  for (const FeatureAxis& axis : axes) {
    features.push_back(feature_of(robot, axis.name));
    if (std::isnan(features.back()) && axis.name.starts_with(behaviour) && robot.fitness())
      throw error(Failure::data, "robot {} has no '{}'; evo-train and evo-eval give it", robot.id,
                  axis.name);
  }
  return features;
}

void fill(GridArchive& archive, const std::vector<Robot>& robots) {
  std::vector<bool> known(archive.axes().size(), robots.empty());
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const Robot& robot = robots[i];
    const std::vector<double> features = features_of(robot, archive.axes());
    for (std::size_t k = 0; k < features.size(); ++k)
      known[k] = known[k] || !std::isnan(features[k]);
    archive.add(i, features, robot.fitness().value_or(nothing));
  }
  for (std::size_t k = 0; k < known.size(); ++k)
    if (!known[k]) throw error(Failure::data, "no robot has a number '{}'", archive.axes()[k].name);
}

}  // namespace evo
