#include "formats/foreign/onnx.h"

#include <bit>
#include <numbers>
#include <span>
#include <string_view>
#include <variant>

#include "libevo/base/error.h"
#include "libevo/control/modular_policy.h"

namespace evo {
namespace {

constexpr std::int64_t ir_version = 7;
constexpr std::int64_t operator_set = 13;
enum ElementType : std::int64_t { float32 = 1, int64 = 7, float64 = 11 };

// A message of Protocol Buffers, field by field in order of their numbers
// (protobuf.dev, "Encoding"; the numbers are those of onnx.proto).
class Message {
 public:
  Message& integer(unsigned field, std::int64_t value) {
    key(field, 0);
    varint(static_cast<std::uint64_t>(value));
    return *this;
  }
  Message& text(unsigned field, std::string_view value) {
    key(field, 2);
    varint(value.size());
    bytes_.append(value);
    return *this;
  }
  Message& message(unsigned field, const Message& value) { return text(field, value.bytes_); }
  template <typename T>
  Message& numbers(unsigned field, std::span<const T> values) {
    static_assert(std::endian::native == std::endian::little);
    return text(field, {reinterpret_cast<const char*>(values.data()),  // NOLINT: bytes
                        values.size_bytes()});
  }
  Message& integers(unsigned field, const std::vector<std::int64_t>& values) {  // packed
    Message packed;
    for (const std::int64_t value : values) packed.varint(static_cast<std::uint64_t>(value));
    return message(field, packed);
  }
  Message& append(const Message& more) {
    bytes_ += more.bytes_;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void key(unsigned field, unsigned wire_type) { varint(field << 3U | wire_type); }
  void varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7U) bytes_ += static_cast<char>(value | 0x80U);
    bytes_ += static_cast<char>(value);
  }

  std::string bytes_;
};

struct Attribute {
  const char* name;
  std::int64_t value;
};

// Adds nodes one behind the other; values are named by the node that makes them.
class Graph {
 public:
  // Of [N, shape].
  void input(const std::string& name, const std::vector<std::int64_t>& shape) {
    inputs_.message(11, described(name, shape));
    last_ = name;
  }
  // The value made last is the result, under this name.
  void output(const std::string& name, const std::vector<std::int64_t>& shape) {
    apply("Identity", {}, {}, name);
    outputs_.message(12, described(name, shape));
  }
  const std::string& last() const { return last_; }

  template <typename T>
  std::string constant(const std::string& name, const std::vector<std::int64_t>& shape,
                       std::span<const T> values) {
    constexpr bool is_float = std::is_same_v<T, float>;
    Message tensor;
    for (const std::int64_t n : shape) tensor.integer(1, n);
    tensor.integer(2, is_float ? float32 : float64);
    if (is_float) tensor.numbers(4, values);
    tensor.text(8, name);
    if (!is_float) tensor.numbers(10, values);
    constants_.message(5, tensor);
    return name;
  }
  std::string matrix(const std::string& name, const Matrix& values) {
    return constant(name, {values.rows(), values.cols()},
                    std::span<const float>(values.data(), static_cast<std::size_t>(values.size())));
  }
  template <typename T>
  std::string vector(const std::string& name, const Eigen::Matrix<T, Eigen::Dynamic, 1>& values) {
    return constant(name, {values.size()},
                    std::span<const T>(values.data(), static_cast<std::size_t>(values.size())));
  }
  std::string places(const std::string& name, const std::vector<std::int64_t>& values) {
    Message tensor;
    tensor.integer(1, std::ssize(values)).integer(2, int64).integers(7, values).text(8, name);
    constants_.message(5, tensor);
    return name;
  }
  std::string number(const std::string& name, double value) {
    return constant(name, {}, std::span<const double>(&value, 1));
  }

  // operation(last value, operands...)
  void apply(const std::string& operation, const std::vector<std::string>& operands,
             std::optional<Attribute> attribute = {}, const std::string& name = "") {
    std::vector<std::string> all{last_};
    all.insert(all.end(), operands.begin(), operands.end());
    add(operation, all, attribute, name);
  }
  // operation(operands..., last value)
  void apply_after(std::vector<std::string> operands, const std::string& operation,
                   std::optional<Attribute> attribute = {}) {
    operands.push_back(last_);
    add(operation, operands, attribute, "");
  }
  void cast(ElementType type) { apply("Cast", {}, Attribute{"to", type}); }

  std::string model(const std::string& name) const {
    Message graph(nodes_);
    graph.text(2, name).append(constants_).append(inputs_).append(outputs_);
    return Message()
        .integer(1, ir_version)
        .text(2, "evo")
        .message(7, graph)
        .message(8, Message().integer(2, operator_set))
        .bytes();
  }

 private:
  void add(const std::string& operation, const std::vector<std::string>& operands,
           std::optional<Attribute> attribute, const std::string& name) {
    Message node;
    for (const std::string& operand : operands) node.text(1, operand);
    last_ = name.empty() ? fmt::format("{}_{}", operation, ++made_) : name;
    node.text(2, last_).text(4, operation);
    constexpr std::int64_t type_of_integers = 2;
    if (attribute)
      node.message(5, Message()
                          .text(1, attribute->name)
                          .integer(3, attribute->value)
                          .integer(20, type_of_integers));
    nodes_.message(1, node);
  }
  // Doubles, [N, sizes].
  static Message described(const std::string& name, const std::vector<std::int64_t>& sizes) {
    Message shape = Message().message(1, Message().text(2, "N"));
    for (const std::int64_t size : sizes) shape.message(1, Message().integer(1, size));
    const Message tensor = Message().integer(1, float64).message(2, shape);
    return Message().text(1, name).message(2, Message().message(1, tensor));
  }

  Message nodes_, constants_, inputs_, outputs_;
  std::string last_;
  int made_ = 0;
};

// `part` ends the names of its constants.
void add_normalizer(Graph& graph, const Normalizer& normalizer, const std::string& part = "") {
  const Eigen::VectorXd deviation = (normalizer.variance.array() + normalizer.epsilon).sqrt();
  if (normalizer.count != 0.0) {
    graph.apply("Sub", {graph.vector("mean" + part, normalizer.mean)});
    graph.apply("Div", {graph.vector("deviation" + part, deviation)});
  }
  graph.apply("Clip", {graph.number("lowest" + part, -normalizer.clip),
                       graph.number("highest" + part, normalizer.clip)});
  graph.cast(float32);
}

void add_network(Graph& graph, const Network& network) {
  for (std::size_t l = 0; l < network.layers.size(); ++l) {
    const Layer& layer = network.layers[l];
    const std::string weight = graph.matrix(fmt::format("weight_{}", l), layer.weight);
    const std::string bias = graph.vector(fmt::format("bias_{}", l), layer.bias);
    graph.apply("Gemm", {weight, bias}, Attribute{"transB", 1});  // last W^T + b
    if (l + 1 < network.layers.size()) graph.apply("Tanh", {});
  }
}

template <typename AnyPolicy>
void add_action_map(Graph& graph, const AnyPolicy& policy) {
  if (policy.action_map == ActionMap::squash) {
    graph.apply("Tanh", {});
    graph.cast(float64);
    graph.apply("Mul", {graph.number("half", 0.5 * (policy.high - policy.low))});
    graph.apply("Add", {graph.number("middle", 0.5 * (policy.high + policy.low))});
    return;
  }
  graph.cast(float64);
  graph.apply("Add", {graph.number("offset", policy.action_offset)});
  graph.apply("Clip", {graph.number("low", policy.low), graph.number("high", policy.high)});
}

// ---- modular policies: for one body ------------------------------------------------------

// What the network reads of the task, [N, T and the clock].
void add_task(Graph& graph, const ModularPolicy& policy) {
  graph.input("task", {policy.task_length()});
  add_normalizer(graph, policy.task, "_task");
  if (policy.clock.empty()) return;
  const std::string task = graph.last();
  // The sine and the cosine of each period.
  std::vector<double> speeds, phases;
  for (const double period : policy.clock)
    for (const double phase : {0.0, 0.5 * std::numbers::pi}) {
      speeds.push_back(2.0 * std::numbers::pi / period);
      phases.push_back(phase);
    }
  const auto count = std::ssize(speeds);
  graph.input("step", {1});
  graph.apply("MatMul", {graph.constant("speeds", {1, count}, std::span<const double>(speeds))});
  graph.apply("Add", {graph.constant("phases", {count}, std::span<const double>(phases))});
  graph.apply("Sin", {});
  graph.cast(float32);
  graph.apply_after({task}, "Concat", Attribute{"axis", 1});
}

// y W^T + b, a row for each voxel.
void add_layer(Graph& graph, const Layer& layer, std::size_t l) {
  graph.apply("MatMul", {graph.matrix(fmt::format("weight_{}", l), layer.weight.transpose())});
  graph.apply("Add", {graph.vector(fmt::format("bias_{}", l), layer.bias)});
}

std::string modular_to_onnx(const ModularPolicy& policy, const PolicyFile& file,
                            const Robot& robot) {
  const Arena arena(policy_task(file, "the policy"), robot.body);
  const Arena* const one = &arena;
  const Bodies bodies({&one, 1});
  const VoxelViews& views = bodies[0];
  if (views.task_length() != policy.task_length())
    throw Error(Failure::data, "the policy does not fit the task that it carries");
  PreparedNetwork actor;
  prepare(policy.actor, bodies, actor);

  Graph graph;
  add_task(graph, policy);
  graph.apply("MatMul", {graph.matrix("weight_task", policy.actor.task.transpose())});
  graph.apply("Unsqueeze", {graph.places("of_voxels", {1})});
  const std::string task = graph.last();
  graph.input("local", {views.voxels(), VoxelViews::local_length});
  add_normalizer(graph, policy.local, "_local");
  graph.apply("MatMul", {graph.matrix("weight_local", policy.actor.local.transpose())});
  graph.apply("Add", {task});
  graph.apply("Add", {graph.matrix("bias", policy.actor.bias.transpose())});
  graph.apply("Mul", {graph.matrix("scale", actor.gates.front().scale)});
  graph.apply("Add", {graph.matrix("fixed", actor.fixed)});
  graph.apply("Tanh", {});
  const int voxels = views.voxels();  // each reads the mean of all
  graph.matrix("shares", Matrix::Constant(voxels, voxels, 1.0F / static_cast<float>(voxels)));
  for (std::size_t l = 0; l < policy.actor.rest.layers.size(); ++l) {
    const bool head = l + 1 == policy.actor.rest.layers.size();
    if (!head) {
      const std::string own = graph.last();
      graph.apply_after({"shares"}, "MatMul");
      graph.apply_after({own}, "Concat", Attribute{"axis", 2});
    }
    add_layer(graph, policy.actor.rest.layers[l], l);
    if (head) break;
    const PreparedNetwork::Gate& gate = actor.gates[l + 1];
    graph.apply("Mul", {graph.matrix(fmt::format("scale_{}", l), gate.scale)});
    graph.apply("Add", {graph.matrix(fmt::format("shift_{}", l), gate.shift)});
    graph.apply("Tanh", {});
  }
  graph.apply("Gather",
              {graph.places("actuators", {views.actuators().begin(), views.actuators().end()})},
              Attribute{"axis", 1});
  graph.apply("Squeeze", {graph.places("of_outputs", {2})});
  add_action_map(graph, policy);
  graph.output("target", {std::ssize(views.actuators())});
  return graph.model("modular policy, for robot " + robot.id);
}

}  // namespace

std::string policy_to_onnx(const PolicyFile& file, const std::optional<Robot>& robot) {
  if (const auto* modular = std::get_if<ModularPolicy>(&file.controller))
    return modular_to_onnx(*modular, file, robot.value_or(file.robot));
  if (robot)
    throw error(Failure::usage,
                "--robot is for modular policies, which any body can wear; this one is of robot {}",
                file.robot.id);
  const auto* policy = std::get_if<Policy>(&file.controller);
  if (policy == nullptr)
    throw Error(Failure::data, "only a network can be written as ONNX; this policy is open loop");
  if (policy->base || !policy->clock.empty())
    throw Error(
        Failure::data,
        "this policy also depends on the time, by its clock, gait or sequence; ONNX is written of "
        "networks that act on the observation alone");
  Graph graph;
  graph.input("observation", {policy->observation_length()});
  add_normalizer(graph, policy->normalizer);
  add_network(graph, policy->actor);
  add_action_map(graph, *policy);
  graph.output("target", {policy->action_length()});
  return graph.model("policy of robot " + file.robot.id);
}

}  // namespace evo
