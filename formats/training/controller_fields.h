// What a trained controller consists of, said once: an archive writes these fields to HDF5 or
// JSON, or reads them there. It has a place in the document, and
//   number, numbers, vector, matrix, word   one field each
//   rows(name, values, width)               a row of `width` numbers after the other
//   parts(name, list)                       describe() of each item, in order
//   part(name, fields)                      fields(deeper) one level deeper
//   choices(name, fields)                   the same; in HDF5 attributes of this level, whose
//                                           names begin with this one
//   optional(name, present, fields)         fields() that are there only sometimes
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "libevo/control/controller.h"

namespace evo {

void describe(auto& archive, Layer& layer) {
  archive.matrix("weight", layer.weight);
  archive.vector("bias", layer.bias);
}

void describe(auto& archive, Gate& gate) {
  archive.matrix("scale", gate.scale);
  archive.optional("shift", gate.shift.size() > 0, [&] { archive.matrix("shift", gate.shift); });
}

void describe(auto& archive, ModularNetwork& network) {
  archive.part("first", [&](auto& first) {
    first.matrix("local", network.local);
    first.matrix("task", network.task);
    first.matrix("fixed", network.fixed);
    first.vector("bias", network.bias);
  });
  archive.parts("rest", network.rest.layers);
  archive.parts("gates", network.gates);
}

void describe(auto& archive, Normalizer& normalizer) {
  archive.vector("mean", normalizer.mean);
  archive.vector("var", normalizer.variance);
  archive.number("count", normalizer.count);
  archive.number("clip", normalizer.clip);
  archive.number("epsilon", normalizer.epsilon);
}

// Shifts only where there are any.
void describe(auto& archive, SineController& sine) {
  archive.numbers("amplitude", sine.amplitude);
  archive.numbers("phase", sine.phase);
  archive.optional("shift", !sine.shift.empty(), [&] { archive.numbers("shift", sine.shift); });
  archive.number("period", sine.period);
  archive.number("middle", sine.middle);
}

// For a policy of either kind of network.
template <typename AnyPolicy>
void describe_actions(auto& archive, AnyPolicy& policy) {
  archive.choices("action", [&](auto& action) {
    action.word("map", policy.action_map);
    action.number("offset", policy.action_offset);
    std::vector<double> bounds{policy.low, policy.high};
    action.bounds("bounds", bounds);
    policy.low = bounds.at(0);
    policy.high = bounds.at(1);
  });
  archive.optional("clock", !policy.clock.empty(), [&] { archive.numbers("clock", policy.clock); });
}

void describe(auto& archive, Policy& policy) {
  archive.parts("actor", policy.actor.layers);
  archive.optional("critic", true, [&] { archive.parts("critic", policy.critic.layers); });
  archive.optional("log_std", true, [&] { archive.vector("log_std", policy.log_std); });
  archive.part("normalizer", [&](auto& part) { describe(part, policy.normalizer); });
  describe_actions(archive, policy);
  const bool on_gait = policy.base && std::holds_alternative<SineController>(*policy.base);
  archive.optional("gait", on_gait, [&] {
    if (!on_gait) policy.base = SineController{};
    archive.part("gait",
                 [&](auto& part) { describe(part, std::get<SineController>(*policy.base)); });
  });
  const bool on_sequence = policy.base && std::holds_alternative<ReplayController>(*policy.base);
  archive.optional("sequence", on_sequence, [&] {
    if (!on_sequence) policy.base = ReplayController{};
    auto& sequence = std::get<ReplayController>(*policy.base);
    archive.rows("sequence", sequence.actions, sequence.actuators);
  });
}

void describe(auto& archive, ModularPolicy& policy) {
  archive.part("actor", [&](auto& part) { describe(part, policy.actor); });
  archive.optional("critic", true, [&] {
    archive.part("critic", [&](auto& part) { describe(part, policy.critic); });
  });
  archive.optional("log_std", true, [&] { archive.vector("log_std", policy.log_std); });
  archive.part("normalizer", [&](auto& both) {
    both.part("local", [&](auto& part) { describe(part, policy.local); });
    both.part("task", [&](auto& part) { describe(part, policy.task); });
  });
  describe_actions(archive, policy);
}

// One for every TrainedController; `kind` names it in documents.
template <typename Controller>
constexpr const char* kind_of = nullptr;
template <>
inline constexpr const char* kind_of<Policy> = "network";
template <>
inline constexpr const char* kind_of<ModularPolicy> = "modular";
template <>
inline constexpr const char* kind_of<SineController> = "sine";
template <>
inline constexpr const char* kind_of<ReplayController> = "sequence";

void describe_controller(auto& archive, Policy& policy) { describe(archive, policy); }
void describe_controller(auto& archive, ModularPolicy& policy) { describe(archive, policy); }
void describe_controller(auto& archive, SineController& sine) {
  archive.part("sine", [&](auto& part) { describe(part, sine); });
}
void describe_controller(auto& archive, ReplayController& sequence) {
  archive.rows("actions", sequence.actions, sequence.actuators);
}

// What does not fit together in a controller that was read, in words, or nothing.
std::optional<std::string> misfit(const TrainedController& controller);

}  // namespace evo
