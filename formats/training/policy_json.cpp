#include "formats/training/policy_json.h"

#include <cmath>
#include <span>
#include <variant>

#include "formats/io/format.h"
#include "formats/io/json.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

Json number(double value) {
  if (!std::isfinite(value))
    throw error(Failure::data, "the policy holds {}, which JSON cannot say", value);
  return value;
}

template <typename Values>
Json numbers(const Values& values) {
  Json list = Json::array();
  for (const auto value : values) list.push_back(number(static_cast<double>(value)));
  return list;
}

Json network_to_json(const Network& network) {
  Json layers = Json::array();
  for (const Layer& layer : network.layers) {
    Json rows = Json::array();
    for (Eigen::Index r = 0; r < layer.weight.rows(); ++r)
      rows.push_back(numbers(layer.weight.row(r)));
    layers.push_back({{"weight", std::move(rows)}, {"bias", numbers(layer.bias)}});
  }
  return layers;
}

Json sine_to_json(const SineController& sine) {
  Json wave{{"amplitude", numbers(sine.amplitude)},
            {"phase", numbers(sine.phase)},
            {"period", number(sine.period)},
            {"middle", number(sine.middle)}};
  if (!sine.shift.empty()) wave["shift"] = numbers(sine.shift);
  return wave;
}

Json sequence_to_json(const ReplayController& sequence) {
  Json rows = Json::array();
  const auto width = static_cast<std::size_t>(sequence.actuators);
  const std::span<const double> actions = sequence.actions;
  for (std::size_t row = 0; row + width <= actions.size(); row += width)
    rows.push_back(numbers(actions.subspan(row, width)));
  return rows;
}

void add_base(Json& document, const SineController& gait) { document["gait"] = sine_to_json(gait); }
void add_base(Json& document, const ReplayController& sequence) {
  document["sequence"] = sequence_to_json(sequence);
}

Json normalizer_to_json(const Normalizer& normalizer) {
  return {{"mean", numbers(normalizer.mean)},
          {"var", numbers(normalizer.variance)},
          {"count", number(normalizer.count)},
          {"clip", number(normalizer.clip)},
          {"epsilon", number(normalizer.epsilon)}};
}

// Of a policy of either kind of network.
template <typename AnyPolicy>
Json action_to_json(const AnyPolicy& policy) {
  return {{"map", word(policy.action_map)},
          {"offset", number(policy.action_offset)},
          {"bounds", {number(policy.low), number(policy.high)}}};
}

// One for every TrainedController.
void add_controller(Json& document, const Policy& policy) {
  document["kind"] = "network";
  document["normalizer"] = normalizer_to_json(policy.normalizer);
  document["action"] = action_to_json(policy);
  document["actor"] = network_to_json(policy.actor);
  document["critic"] = network_to_json(policy.critic);
  document["log_std"] = numbers(policy.log_std);
  if (!policy.clock.empty()) document["clock"] = numbers(policy.clock);
  if (policy.base) std::visit([&](const auto& base) { add_base(document, base); }, *policy.base);
}

Json rows_to_json(const Matrix& weight) {
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < weight.rows(); ++r) rows.push_back(numbers(weight.row(r)));
  return rows;
}

Json network_to_json(const ModularNetwork& network) {
  Json document = {{"first",
                    {{"local", rows_to_json(network.local)},
                     {"task", rows_to_json(network.task)},
                     {"fixed", rows_to_json(network.fixed)},
                     {"bias", numbers(network.bias)}}},
                   {"rest", network_to_json(network.rest)}};
  for (const Gate& gate : network.gates) {
    Json& own = document["gates"].emplace_back();
    own["scale"] = rows_to_json(gate.scale);
    if (gate.shift.size() > 0) own["shift"] = rows_to_json(gate.shift);
  }
  return document;
}

void add_controller(Json& document, const ModularPolicy& policy) {
  document["kind"] = "modular";
  document["normalizer"] = {{"local", normalizer_to_json(policy.local)},
                            {"task", normalizer_to_json(policy.task)}};
  document["action"] = action_to_json(policy);
  document["actor"] = network_to_json(policy.actor);
  document["critic"] = network_to_json(policy.critic);
  document["log_std"] = numbers(policy.log_std);
  if (!policy.clock.empty()) document["clock"] = numbers(policy.clock);
}

void add_controller(Json& document, const SineController& sine) {
  document["kind"] = "sine";
  document["sine"] = sine_to_json(sine);
}

void add_controller(Json& document, const ReplayController& sequence) {
  document["kind"] = "sequence";
  document["actions"] = sequence_to_json(sequence);
}

Json curve_to_json(const std::vector<CurvePoint>& curve) {
  Json steps = Json::array();
  Json evaluations = Json::array();
  Json best = Json::array();
  for (const CurvePoint& point : curve) {
    steps.push_back(point.step);
    evaluations.push_back(number(point.evaluation));
    best.push_back(number(point.best));
  }
  return {{"step", steps}, {"evaluation", evaluations}, {"best", best}};
}

}  // namespace

std::string policy_to_json(const PolicyFile& policy) {
  Json document{{"format", format::policy.name}, {"version", format::policy.version}};
  std::visit([&](const auto& controller) { add_controller(document, controller); },
             policy.controller);
  document["robot"] = parse_json(robot_to_line(policy.robot), "robot");
  for (const Robot& robot : policy.robots)
    document["robots"].push_back(parse_json(robot_to_line(robot), "robot"));
  document["task"] = policy.task;
  document["task_yaml"] = policy.task_yaml;
  document["physics_yaml"] = policy.physics_yaml;
  document["training_yaml"] = policy.training_yaml;
  Json& layout = document["observation_layout"] = Json::array();
  for (const ObservationSlice& slice : policy.layout)
    layout.push_back({{"name", slice.name}, {"offset", slice.offset}, {"length", slice.length}});
  document["seed"] = policy.seed;
  document["isa"] = policy.isa;
  document["created_by"] = policy.created_by;
  document["settings_hash"] = policy.settings_hash;
  document["fitness"] = number(policy.fitness);
  document["best_step"] = policy.best_step;
  document["steps"] = policy.steps;
  if (const auto& score = policy.final_score)
    document["final"] = {{"episodes", score->episodes},
                         {"mean", number(score->mean)},
                         {"standard_error", number(score->standard_error)}};
  document["curve"] = curve_to_json(policy.curve);
  return compact(document) + "\n";
}

}  // namespace evo
