#include "formats/training/controller_json.h"

#include <string>
#include <vector>

#include "formats/io/format.h"
#include "formats/training/controller_fields.h"
#include "libevo/base/alternatives.h"

namespace evo {
namespace {

// Reads the fields of a JSON object (controller_fields.h).
class JsonReader {
 public:
  explicit JsonReader(Node at) : at_(std::move(at)) {}

  void number(const char* name, double& value) { value = at_.at(name).number(); }
  void numbers(const char* name, std::vector<double>& values) { values = at_.at(name).numbers(); }
  void bounds(const char* name, std::vector<double>& values) {
    const Node list = at_.at(name);
    values = list.numbers();
    if (values.size() != 2) throw list.error("[low, high] is expected");
  }
  template <typename Dense>
  void vector(const char* name, Dense& values) {
    const std::vector<double> list = at_.at(name).numbers();
    values = Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()))
                 .cast<typename Dense::Scalar>();
  }
  void matrix(const char* name, Matrix& values) {
    std::vector<double> all;
    int columns = 0;
    rows(name, all, columns);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    values = Eigen::Map<const RowMajor>(all.data(), static_cast<Eigen::Index>(all.size()) / columns,
                                        columns)
                 .cast<float>();
  }
  void rows(const char* name, std::vector<double>& all, int& columns) {
    const Node list = at_.at(name);
    all.clear();
    for (const Node& item : list.items()) {
      const std::vector<double> row = item.numbers();
      if (all.empty()) columns = static_cast<int>(row.size());
      if (row.empty() || std::cmp_not_equal(row.size(), columns))
        throw item.error(
            fmt::format("the row has {} numbers, the first has {}", row.size(), columns));
      all.insert(all.end(), row.begin(), row.end());
    }
    if (all.empty()) throw list.error("a list of rows is expected, found none");
  }
  template <Worded E>
  void word(const char* name, E& value) {
    value = at_.at(name).choice<E>(name);
  }
  template <typename T>
  void parts(const char* name, std::vector<T>& list) {
    for (const Node& item : at_.at(name).items()) {
      JsonReader part(item);
      describe(part, list.emplace_back());
    }
  }
  template <typename Fields>
  void part(const char* name, const Fields& fields) {
    JsonReader deeper(at_.at(name));
    fields(deeper);
  }
  template <typename Fields>
  void choices(const char* name, const Fields& fields) {
    part(name, fields);
  }
  template <typename Fields>
  void optional(const char* name, bool /*present*/, const Fields& fields) {
    if (at_.find(name)) fields();
  }

 private:
  Node at_;
};

// What does not act may be missing; the shapes are then those of the actor.
void fill_in(Policy& policy) {
  if (policy.actor.layers.empty()) return;
  const Layer& first = policy.actor.layers.front();
  const Layer& last = policy.actor.layers.back();
  if (policy.critic.layers.empty())
    policy.critic.layers = {{Matrix::Zero(1, first.weight.cols()), Vector::Zero(1)}};
  if (policy.log_std.size() == 0) policy.log_std = Vector::Zero(last.bias.size());
}

void fill_in(ModularPolicy& policy) {
  if (policy.critic.rest.layers.empty()) {
    policy.critic = policy.actor;
    policy.critic.rest.layers = {{Matrix::Zero(1, policy.actor.bias.size()), Vector::Zero(1)}};
    policy.critic.gates.resize(1);
  }
  if (policy.log_std.size() == 0) policy.log_std = Vector::Zero(1);
}

void fill_in(SineController&) {}
void fill_in(ReplayController&) {}

}  // namespace

TrainedController read_controller(const Node& document) {
  check_format(document, format::policy);
  std::vector<std::string> kinds;
  for_each_alternative<TrainedController>(
      [&]<typename T>(std::type_identity<T>) { kinds.emplace_back(kind_of<T>); });
  const std::string kind = document.at("kind").choice("kind of policy", kinds);
  TrainedController controller;
  for_each_alternative<TrainedController>([&]<typename T>(std::type_identity<T>) {
    if (kind == kind_of<T>) {
      JsonReader fields(document);
      describe_controller(fields, controller.emplace<T>());
      fill_in(std::get<T>(controller));
    }
  });
  if (const auto problem = misfit(controller)) throw document.error(*problem);
  return controller;
}

}  // namespace evo
