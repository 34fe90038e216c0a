#include "formats/foreign/onnx.h"

#include <variant>

// The generated code does not compile without warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <onnx/onnx_pb.h>
#pragma GCC diagnostic pop

#include "libevo/base/error.h"

namespace evo {
namespace {

constexpr std::int64_t ir_version = 7;
constexpr std::int64_t operator_set = 13;

// Adds nodes one behind the other; values are named by the node that makes them.
class Graph {
 public:
  explicit Graph(const std::string& name) {
    model_.set_ir_version(ir_version);
    model_.set_producer_name("evo");
    model_.add_opset_import()->set_version(operator_set);
    graph_ = model_.mutable_graph();
    graph_->set_name(name);
  }

  void input(const std::string& name, std::int64_t width) {
    describe(graph_->add_input(), name, width);
    last_ = name;
  }
  // The value made last is the result, under this name.
  void output(const std::string& name, std::int64_t width) {
    apply("Identity", {});
    graph_->mutable_node()->rbegin()->set_output(0, name);
    describe(graph_->add_output(), name, width);
  }

  std::string constant(const std::string& name, const std::vector<std::int64_t>& shape,
                       const double* values, std::size_t count) {
    onnx::TensorProto& tensor = add_tensor(name, shape, onnx::TensorProto::DOUBLE);
    tensor.mutable_double_data()->Add(values, values + count);
    return name;
  }
  std::string constant(const std::string& name, const std::vector<std::int64_t>& shape,
                       const float* values, std::size_t count) {
    onnx::TensorProto& tensor = add_tensor(name, shape, onnx::TensorProto::FLOAT);
    tensor.mutable_float_data()->Add(values, values + count);
    return name;
  }
  std::string number(const std::string& name, double value) {
    return constant(name, {}, &value, 1);
  }

  // operation(last value, operands...)
  onnx::NodeProto& apply(const std::string& operation, const std::vector<std::string>& operands) {
    onnx::NodeProto* node = graph_->add_node();
    node->set_op_type(operation);
    node->add_input(last_);
    for (const std::string& operand : operands) node->add_input(operand);
    last_ = fmt::format("{}_{}", operation, graph_->node_size());
    node->add_output(last_);
    return *node;
  }
  void cast(onnx::TensorProto::DataType type) {
    set(apply("Cast", {}), "to", static_cast<std::int64_t>(type));
  }
  // last W^T + b
  void affine(const std::string& weight, const std::string& bias) {
    set(apply("Gemm", {weight, bias}), "transB", 1);
  }

  std::string serialized() const { return model_.SerializeAsString(); }

 private:
  onnx::TensorProto& add_tensor(const std::string& name, const std::vector<std::int64_t>& shape,
                                onnx::TensorProto::DataType type) {
    onnx::TensorProto* tensor = graph_->add_initializer();
    tensor->set_name(name);
    tensor->set_data_type(type);
    for (const std::int64_t n : shape) tensor->add_dims(n);
    return *tensor;
  }

  static void set(onnx::NodeProto& node, const std::string& name, std::int64_t value) {
    onnx::AttributeProto* attribute = node.add_attribute();
    attribute->set_name(name);
    attribute->set_type(onnx::AttributeProto::INT);
    attribute->set_i(value);
  }

  static void describe(onnx::ValueInfoProto* value, const std::string& name, std::int64_t width) {
    value->set_name(name);
    auto* tensor = value->mutable_type()->mutable_tensor_type();
    tensor->set_elem_type(onnx::TensorProto::DOUBLE);
    tensor->mutable_shape()->add_dim()->set_dim_param("N");
    tensor->mutable_shape()->add_dim()->set_dim_value(width);
  }

  onnx::ModelProto model_;
  onnx::GraphProto* graph_;
  std::string last_;
};

void add_normalizer(Graph& graph, const Normalizer& normalizer) {
  const Eigen::VectorXd deviation = (normalizer.variance.array() + normalizer.epsilon).sqrt();
  const auto size = static_cast<std::size_t>(deviation.size());
  if (normalizer.count != 0.0) {
    graph.apply("Sub", {graph.constant("mean", {deviation.size()}, normalizer.mean.data(), size)});
    graph.apply("Div", {graph.constant("deviation", {deviation.size()}, deviation.data(), size)});
  }
  graph.apply("Clip",
              {graph.number("lowest", -normalizer.clip), graph.number("highest", normalizer.clip)});
  graph.cast(onnx::TensorProto::FLOAT);
}

void add_network(Graph& graph, const Network& network) {
  for (std::size_t l = 0; l < network.layers.size(); ++l) {
    const Layer& layer = network.layers[l];
    const auto count = [](const auto& x) { return static_cast<std::size_t>(x.size()); };
    const std::string weight =
        graph.constant(fmt::format("weight_{}", l), {layer.weight.rows(), layer.weight.cols()},
                       layer.weight.data(), count(layer.weight));
    const std::string bias = graph.constant(fmt::format("bias_{}", l), {layer.bias.size()},
                                            layer.bias.data(), count(layer.bias));
    graph.affine(weight, bias);
    if (l + 1 < network.layers.size()) graph.apply("Tanh", {});
  }
}

void add_action_map(Graph& graph, const Policy& policy) {
  if (policy.action_map == ActionMap::squash) {
    graph.apply("Tanh", {});
    graph.cast(onnx::TensorProto::DOUBLE);
    graph.apply("Mul", {graph.number("half", 0.5 * (policy.high - policy.low))});
    graph.apply("Add", {graph.number("middle", 0.5 * (policy.high + policy.low))});
    return;
  }
  graph.cast(onnx::TensorProto::DOUBLE);
  graph.apply("Add", {graph.number("offset", policy.action_offset)});
  graph.apply("Clip", {graph.number("low", policy.low), graph.number("high", policy.high)});
}

}  // namespace

std::string policy_to_onnx(const PolicyFile& file) {
  const auto* policy = std::get_if<Policy>(&file.controller);
  if (policy == nullptr)
    throw Error(Failure::data, "only a network can be written as ONNX; this policy is open loop");
  if (policy->gait || !policy->clock.empty())
    throw Error(Failure::data,
                "this policy also depends on the time, by its clock or gait; ONNX is written of "
                "networks that act on the observation alone");
  Graph graph("policy of robot " + file.robot.id);
  graph.input("observation", policy->observation_length());
  add_normalizer(graph, policy->normalizer);
  add_network(graph, policy->actor);
  add_action_map(graph, *policy);
  graph.output("target", policy->action_length());
  return graph.serialized();
}

}  // namespace evo
