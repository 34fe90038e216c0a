#include "formats/training/controller_json.h"

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "formats/io/format.h"

namespace evo {
namespace {

const Json& member(const Json& value, const char* name, const std::string& path) {
  if (!value.is_object()) throw refusal(path, "an object is expected, found {}", shown(value));
  const auto found = value.find(name);
  if (found == value.end()) throw refusal(path, "'{}' is missing", name);
  return *found;
}

double number(const Json& value, const std::string& path) {
  if (!value.is_number()) throw refusal(path, "a number is expected, found {}", shown(value));
  return value.get<double>();
}

double number(const Json& object, const char* name, const std::string& path) {
  return number(member(object, name, path), path + "/" + name);
}

std::vector<double> numbers(const Json& value, const std::string& path) {
  if (!value.is_array())
    throw refusal(path, "a list of numbers is expected, found {}", shown(value));
  std::vector<double> list;
  for (std::size_t i = 0; i < value.size(); ++i)
    list.push_back(number(value[i], fmt::format("{}/{}", path, i)));
  return list;
}

std::vector<double> numbers(const Json& object, const char* name, const std::string& path) {
  return numbers(member(object, name, path), path + "/" + name);
}

// A row after the other, equally long; `columns` is told.
std::vector<double> rows(const Json& value, const std::string& path, std::size_t& columns) {
  if (!value.is_array() || value.empty())
    throw refusal(path, "a list of rows is expected, found {}", shown(value));
  std::vector<double> all;
  for (std::size_t r = 0; r < value.size(); ++r) {
    const std::string at = fmt::format("{}/{}", path, r);
    const std::vector<double> row = numbers(value[r], at);
    if (r == 0) columns = row.size();
    if (row.empty() || row.size() != columns)
      throw refusal(at, "the row has {} numbers, the first has {}", row.size(), columns);
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

Layer layer(const Json& value, const std::string& path, Eigen::Index inputs) {
  std::size_t columns = 0;
  const std::vector<double> weight = rows(member(value, "weight", path), path + "/weight", columns);
  const std::vector<double> bias = numbers(value, "bias", path);
  const auto outputs = static_cast<Eigen::Index>(weight.size() / columns);
  const auto width = static_cast<Eigen::Index>(columns);
  if (inputs != 0 && width != inputs)
    throw refusal(path + "/weight", "rows of {} numbers after a layer of {} outputs", width,
                  inputs);
  if (static_cast<Eigen::Index>(bias.size()) != outputs)
    throw refusal(path + "/bias", "{} numbers for {} rows of weights", bias.size(), outputs);
  Layer made{Matrix(outputs, width), Vector(outputs)};
  for (std::size_t i = 0; i < weight.size(); ++i)
    made.weight.data()[i] = static_cast<float>(weight[i]);
  for (std::size_t i = 0; i < bias.size(); ++i)
    made.bias[static_cast<Eigen::Index>(i)] = static_cast<float>(bias[i]);
  return made;
}

Network network(const Json& value, const std::string& path) {
  if (!value.is_array() || value.empty())
    throw refusal(path, "a list of layers is expected, found {}", shown(value));
  Network made;
  for (std::size_t l = 0; l < value.size(); ++l)
    made.layers.push_back(layer(value[l], fmt::format("{}/{}", path, l),
                                l == 0 ? 0 : made.layers.back().weight.rows()));
  return made;
}

SineController sine(const Json& value, const std::string& path) {
  SineController made;
  made.amplitude = numbers(value, "amplitude", path);
  made.phase = numbers(value, "phase", path);
  made.period = number(value, "period", path);
  if (value.contains("middle")) made.middle = number(value, "middle", path);
  if (value.contains("shift")) made.shift = numbers(value, "shift", path);
  if (!(made.period > 0.0)) throw refusal(path + "/period", "a number greater than 0 is expected");
  return made;
}

Eigen::VectorXd vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

ReplayController sequence(const Json& document, const char* key) {
  ReplayController made;
  std::size_t columns = 0;
  made.actions = rows(member(document, key, ""), fmt::format("/{}", key), columns);
  made.actuators = static_cast<int>(columns);
  return made;
}

Normalizer normalizer(const Json& value, const std::string& path) {
  Normalizer made;
  made.mean = vector(numbers(value, "mean", path));
  made.variance = vector(numbers(value, "var", path));
  made.count = number(value, "count", path);
  made.clip = number(value, "clip", path);
  made.epsilon = number(value, "epsilon", path);
  if (made.variance.size() != made.mean.size())
    throw refusal(path, "{} means and {} variances", made.mean.size(), made.variance.size());
  return made;
}

// Of a policy of either kind of network.
template <typename AnyPolicy>
void read_action(const Json& document, AnyPolicy& made) {
  const Json& action = member(document, "action", "");
  const Json& map = member(action, "map", "/action");
  if (map != "offset" && map != "squash")
    throw refusal("/action/map", "offset or squash is expected, found {}", shown(map));
  made.action_map = map == "offset" ? ActionMap::offset : ActionMap::squash;
  made.action_offset = number(action, "offset", "/action");
  const std::vector<double> bounds = numbers(action, "bounds", "/action");
  if (bounds.size() != 2) throw refusal("/action/bounds", "[low, high] is expected");
  made.low = bounds[0];
  made.high = bounds[1];
}

Policy policy(const Json& document) {
  Policy made;
  made.actor = network(member(document, "actor", ""), "/actor");
  made.normalizer = normalizer(member(document, "normalizer", ""), "/normalizer");
  read_action(document, made);
  if (document.contains("clock")) made.clock = numbers(document, "clock", "");
  if (document.contains("gait")) made.base = sine(document["gait"], "/gait");
  if (document.contains("sequence")) made.base = sequence(document, "sequence");
  if (document.contains("critic")) made.critic = network(document["critic"], "/critic");
  const Eigen::Index outputs = made.actor.layers.back().weight.rows();
  made.log_std = document.contains("log_std")
                     ? Vector(vector(numbers(document, "log_std", "")).cast<float>())
                     : Vector(Vector::Zero(outputs));
  if (made.log_std.size() != outputs)
    throw refusal("/log_std", "{} numbers for {} outputs", made.log_std.size(), outputs);
  const Eigen::Index inputs = made.actor.layers.front().weight.cols();
  const auto clock = static_cast<Eigen::Index>(2 * made.clock.size());
  if (made.normalizer.mean.size() + clock != inputs)
    throw refusal("/normalizer", "of {} values, where the network takes {} from observations",
                  made.normalizer.mean.size(), inputs - clock);
  return made;
}

Matrix matrix(const Json& object, const char* name, const std::string& path) {
  std::size_t columns = 0;
  const std::vector<double> values = rows(member(object, name, path), path + "/" + name, columns);
  Matrix made(static_cast<Eigen::Index>(values.size() / columns),
              static_cast<Eigen::Index>(columns));
  for (std::size_t i = 0; i < values.size(); ++i) made.data()[i] = static_cast<float>(values[i]);
  return made;
}

ModularNetwork modular_network(const Json& value, const std::string& path) {
  ModularNetwork made;
  const Json& first = member(value, "first", path);
  const std::string at = path + "/first";
  made.local = matrix(first, "local", at);
  made.task = matrix(first, "task", at);
  made.fixed = matrix(first, "fixed", at);
  made.bias = vector(numbers(first, "bias", at)).cast<float>();
  const Json& rest = member(value, "rest", path);
  if (!rest.is_array() || rest.empty())
    throw refusal(path + "/rest", "a list of layers is expected, found {}", shown(rest));
  for (std::size_t l = 0; l < rest.size(); ++l)
    made.rest.layers.push_back(layer(rest[l], fmt::format("{}/rest/{}", path, l), 0));
  const Json& gates = member(value, "gates", path);
  if (!gates.is_array())
    throw refusal(path + "/gates", "a list of gates is expected, found {}", shown(gates));
  for (std::size_t l = 0; l < gates.size(); ++l) {
    const std::string of_gate = fmt::format("{}/gates/{}", path, l);
    made.gates.push_back({matrix(gates[l], "scale", of_gate),
                          l == 0 ? Matrix() : matrix(gates[l], "shift", of_gate)});
  }
  return made;
}

ModularPolicy modular_policy(const Json& document) {
  ModularPolicy made;
  const Json& normalizers = member(document, "normalizer", "");
  made.local = normalizer(member(normalizers, "local", "/normalizer"), "/normalizer/local");
  made.task = normalizer(member(normalizers, "task", "/normalizer"), "/normalizer/task");
  read_action(document, made);
  if (document.contains("clock")) made.clock = numbers(document, "clock", "");
  made.actor = modular_network(member(document, "actor", ""), "/actor");
  // What does not act may be missing; the shapes are then those of the actor.
  if (document.contains("critic")) {
    made.critic = modular_network(document["critic"], "/critic");
  } else {
    made.critic = made.actor;
    made.critic.rest.layers = {{Matrix::Zero(1, made.actor.bias.size()), Vector::Zero(1)}};
    made.critic.gates.resize(1);
  }
  made.log_std = document.contains("log_std")
                     ? Vector(vector(numbers(document, "log_std", "")).cast<float>())
                     : Vector(Vector::Zero(1));
  if (const auto problem = defect(made)) throw refusal("", "{}", *problem);
  return made;
}

TrainedController read(const Json& document) {
  const Json& kind = member(document, "kind", "");
  if (document.contains("format")) check_format(document, format::policy);
  if (kind == "network") return policy(document);
  if (kind == "modular") return modular_policy(document);
  if (kind == "sine") return sine(member(document, "sine", ""), "/sine");
  if (kind == "sequence") return sequence(document, "actions");
  throw refusal("/kind", "network, modular, sine or sequence is expected, found {}", shown(kind));
}

}  // namespace

TrainedController controller_from_json(const Json& document, const std::string& where) {
  try {
    return read(document);
  } catch (const Refusal& refused) {
    throw refused.at(where);
  }
}

}  // namespace evo
