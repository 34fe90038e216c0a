#include "formats/foreign/onnx.h"

#include <bit>
#include <span>
#include <string_view>
#include <variant>

#include "libevo/base/error.h"

namespace evo {
namespace {

constexpr std::int64_t ir_version = 7;
constexpr std::int64_t operator_set = 13;
enum ElementType : std::int64_t { float32 = 1, float64 = 11 };

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
  void input(const std::string& name, std::int64_t width) {
    inputs_.message(11, described(name, width));
    last_ = name;
  }
  // The value made last is the result, under this name.
  void output(const std::string& name, std::int64_t width) {
    apply("Identity", {}, {}, name);
    outputs_.message(12, described(name, width));
  }

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
  std::string number(const std::string& name, double value) {
    return constant(name, {}, std::span<const double>(&value, 1));
  }

  // operation(last value, operands...)
  void apply(const std::string& operation, const std::vector<std::string>& operands,
             std::optional<Attribute> attribute = {}, const std::string& name = "") {
    Message node;
    node.text(1, last_);
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
  void cast(ElementType type) { apply("Cast", {}, Attribute{"to", type}); }
  // last W^T + b
  void affine(const std::string& weight, const std::string& bias) {
    apply("Gemm", {weight, bias}, Attribute{"transB", 1});
  }

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
  // Doubles, [N, width].
  static Message described(const std::string& name, std::int64_t width) {
    const Message shape =
        Message().message(1, Message().text(2, "N")).message(1, Message().integer(1, width));
    const Message tensor = Message().integer(1, float64).message(2, shape);
    return Message().text(1, name).message(2, Message().message(1, tensor));
  }

  Message nodes_, constants_, inputs_, outputs_;
  std::string last_;
  int made_ = 0;
};

std::span<const double> values(const Eigen::VectorXd& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

void add_normalizer(Graph& graph, const Normalizer& normalizer) {
  const Eigen::VectorXd deviation = (normalizer.variance.array() + normalizer.epsilon).sqrt();
  if (normalizer.count != 0.0) {
    graph.apply("Sub", {graph.constant("mean", {deviation.size()}, values(normalizer.mean))});
    graph.apply("Div", {graph.constant("deviation", {deviation.size()}, values(deviation))});
  }
  graph.apply("Clip",
              {graph.number("lowest", -normalizer.clip), graph.number("highest", normalizer.clip)});
  graph.cast(float32);
}

void add_network(Graph& graph, const Network& network) {
  for (std::size_t l = 0; l < network.layers.size(); ++l) {
    const Layer& layer = network.layers[l];
    const auto all = [](const auto& x) {
      return std::span<const float>(x.data(), static_cast<std::size_t>(x.size()));
    };
    const std::string weight = graph.constant(
        fmt::format("weight_{}", l), {layer.weight.rows(), layer.weight.cols()}, all(layer.weight));
    const std::string bias =
        graph.constant(fmt::format("bias_{}", l), {layer.bias.size()}, all(layer.bias));
    graph.affine(weight, bias);
    if (l + 1 < network.layers.size()) graph.apply("Tanh", {});
  }
}

void add_action_map(Graph& graph, const Policy& policy) {
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

}  // namespace

std::string policy_to_onnx(const PolicyFile& file) {
  const auto* policy = std::get_if<Policy>(&file.controller);
  if (policy == nullptr)
    throw Error(Failure::data, std::holds_alternative<ModularPolicy>(file.controller)
                                   ? "a modular policy acts on the voxels of any body, not on an "
                                     "observation; ONNX is written of networks that do"
                                   : "only a network can be written as ONNX; this policy is open "
                                     "loop");
  if (policy->base || !policy->clock.empty())
    throw Error(
        Failure::data,
        "this policy also depends on the time, by its clock, gait or sequence; ONNX is written of "
        "networks that act on the observation alone");
  Graph graph;
  graph.input("observation", policy->observation_length());
  add_normalizer(graph, policy->normalizer);
  add_network(graph, policy->actor);
  add_action_map(graph, *policy);
  graph.output("target", policy->action_length());
  return graph.model("policy of robot " + file.robot.id);
}

}  // namespace evo
