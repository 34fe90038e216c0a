#include "formats/training/policy_json.h"

#include <cmath>
#include <span>
#include <variant>

#include "formats/io/format.h"
#include "formats/training/controller_fields.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

Json as_json(double value) {
  if (!std::isfinite(value))
    throw error(Failure::data, "the policy holds {}, which JSON cannot say", value);
  return value;
}

template <typename Values>
Json list_of(const Values& values) {
  Json list = Json::array();
  for (const auto value : values) list.push_back(as_json(static_cast<double>(value)));
  return list;
}

// Writes fields into a JSON object (controller_fields.h).
class JsonWriter {
 public:
  explicit JsonWriter(Json& at) : at_(at) {}

  void number(const char* name, double value) { at_[name] = as_json(value); }
  void numbers(const char* name, const std::vector<double>& values) { at_[name] = list_of(values); }
  void bounds(const char* name, const std::vector<double>& values) { numbers(name, values); }
  template <typename Dense>
  void vector(const char* name, const Dense& values) {
    at_[name] = list_of(values);
  }
  void matrix(const char* name, const Matrix& values) {
    Json& rows = at_[name] = Json::array();
    for (Eigen::Index r = 0; r < values.rows(); ++r) rows.push_back(list_of(values.row(r)));
  }
  void rows(const char* name, const std::vector<double>& values, int columns) {
    Json& rows = at_[name] = Json::array();
    const auto width = static_cast<std::size_t>(columns);
    for (std::size_t i = 0; i + width <= values.size() && width > 0; i += width)
      rows.push_back(list_of(std::span(values).subspan(i, width)));
  }
  template <Worded E>
  void word(const char* name, E value) {
    at_[name] = evo::word(value);
  }
  template <typename T>
  void parts(const char* name, std::vector<T>& list) {
    Json& parts = at_[name] = Json::array();
    for (T& item : list) {
      JsonWriter part(parts.emplace_back(Json::object()));
      describe(part, item);
    }
  }
  template <typename Fields>
  void part(const char* name, const Fields& fields) {
    JsonWriter deeper(at_[name] = Json::object());
    fields(deeper);
  }
  template <typename Fields>
  void choices(const char* name, const Fields& fields) {
    part(name, fields);
  }
  template <typename Fields>
  void optional(const char* /*name*/, bool present, const Fields& fields) {
    if (present) fields();
  }

 private:
  Json& at_;
};

Json curve_to_json(const std::vector<CurvePoint>& curve) {
  Json steps = Json::array();
  Json evaluations = Json::array();
  Json best = Json::array();
  for (const CurvePoint& point : curve) {
    steps.push_back(point.step);
    evaluations.push_back(as_json(point.evaluation));
    best.push_back(as_json(point.best));
  }
  return {{"step", steps}, {"evaluation", evaluations}, {"best", best}};
}

}  // namespace

std::string policy_to_json(const PolicyFile& policy) {
  Json document{{"format", format::policy.name}, {"version", format::policy.version}};
  std::visit(
      [&]<typename T>(T controller) {
        document["kind"] = kind_of<T>;
        JsonWriter fields(document);
        describe_controller(fields, controller);
      },
      policy.controller);
  document["robot"] = robot_to_document(policy.robot);
  for (const Robot& robot : policy.robots) document["robots"].push_back(robot_to_document(robot));
  document["task"] = policy.task;
  document["task_yaml"] = policy.task_yaml;
  document["physics_yaml"] = policy.physics_yaml;
  document["training_yaml"] = policy.training_yaml;
  document["observation_layout"] = layout_to_json(policy.layout);
  document["seed"] = policy.seed;
  document["isa"] = policy.isa;
  document["created_by"] = policy.created_by;
  document["settings_hash"] = policy.settings_hash;
  document["fitness"] = as_json(policy.fitness);
  document["best_step"] = policy.best_step;
  document["steps"] = policy.steps;
  if (const auto& score = policy.final_score)
    document["final"] = {{"episodes", score->episodes},
                         {"mean", as_json(score->mean)},
                         {"standard_error", as_json(score->standard_error)}};
  document["curve"] = curve_to_json(policy.curve);
  return compact(document) + "\n";
}

Json layout_to_json(const std::vector<ObservationSlice>& layout) {
  Json list = Json::array();
  for (const ObservationSlice& slice : layout)
    list.push_back({{"name", slice.name}, {"offset", slice.offset}, {"length", slice.length}});
  return list;
}

}  // namespace evo
