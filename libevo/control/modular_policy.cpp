#include "libevo/control/modular_policy.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <span>

#include "libevo/base/error.h"

namespace evo {
namespace {

// Calls use(numbers) for each run of parameters, in the order of parameter_blocks().
template <typename Net, typename Use>
void each_block(Net& network, Use use) {
  use(network.local);
  use(network.task);
  use(network.fixed);
  use(network.bias);
  for (auto& layer : network.rest.layers) {
    use(layer.weight);
    use(layer.bias);
  }
  for (auto& gate : network.gates) {
    use(gate.scale);
    use(gate.shift);
  }
}

template <typename Span, typename Parameters>
std::vector<Span> blocks_of(Parameters& parameters) {
  std::vector<Span> blocks;
  const auto add = [&](auto& numbers) {
    blocks.emplace_back(numbers.data(), static_cast<std::size_t>(numbers.size()));
  };
  each_block(parameters.actor, add);
  each_block(parameters.critic, add);
  add(parameters.log_std);
  return blocks;
}

ModularNetwork zeros_like(const ModularNetwork& network) {
  ModularNetwork zeros = network;
  each_block(zeros, [](auto& numbers) { numbers.setZero(); });
  return zeros;
}

Eigen::Index width(const ModularNetwork& network) { return network.bias.size(); }

// Units of its hidden layer l.
Eigen::Index hidden_width(const ModularNetwork& network, std::size_t l) {
  return l == 0 ? width(network) : network.rest.layers[l - 1].bias.size();
}

// Hidden layers after the first read `reads` times the layer below.
ModularNetwork orthogonal_layers(int task_inputs, const std::vector<int>& widths, int reads,
                                 double hidden_gain, double head_gain, Stream& stream) {
  const int inputs = VoxelViews::local_length + task_inputs + VoxelViews::fixed_length;
  ModularNetwork network;
  const Network first = orthogonal_network(inputs, {}, widths.front(), 1.0, hidden_gain, stream);
  const Layer& layer = first.layers.front();
  network.local = layer.weight.leftCols(VoxelViews::local_length);
  network.task = layer.weight.middleCols(VoxelViews::local_length, task_inputs);
  network.fixed = layer.weight.rightCols(VoxelViews::fixed_length);
  network.bias = layer.bias;
  for (std::size_t l = 1; l <= widths.size(); ++l) {
    const bool head = l == widths.size();
    Network next = orthogonal_network((head ? 1 : reads) * widths[l - 1], {}, head ? 1 : widths[l],
                                      1.0, head ? head_gain : hidden_gain, stream);
    network.rest.layers.push_back(std::move(next.layers.front()));
  }
  return network;
}

// Gates of its first `layers` hidden layers, of zeros.
void add_gates(ModularNetwork& network, std::size_t layers) {
  for (std::size_t l = 0; l < layers; ++l) {
    const Matrix zero = Matrix::Zero(hidden_width(network, l), VoxelViews::fixed_length);
    network.gates.push_back({zero, l == 0 ? Matrix() : zero});
  }
}

// ---- rows ---------------------------------------------------------------------------

// The rows of a pass: each sample's voxels.
void lay_rows(const Bodies& bodies, const VoxelSamples& batch, ModularPass& pass) {
  pass.samples.clear();
  pass.voxels.clear();
  pass.heads.clear();
  pass.head_voxels.clear();
  pass.first.assign(1, 0);
  for (std::size_t m = 0; m < batch.bodies.size(); ++m) {
    const int body = batch.bodies[m];
    const VoxelViews& views = bodies[body];
    const Eigen::Index first = bodies.first(body);
    for (const int v : views.actuators()) {
      pass.heads.push_back(pass.first.back() + v);
      pass.head_voxels.push_back(first + v);
    }
    for (int v = 0; v < views.voxels(); ++v) pass.voxels.push_back(first + v);
    pass.samples.resize(pass.voxels.size(), static_cast<Eigen::Index>(m));
    pass.first.push_back(std::ssize(pass.voxels));
  }
}

// ---- gates ----------------------------------------------------------------------------

// The voxel, of all bodies', of each row of a layer: of all rows of a pass or of its heads.
std::span<const Eigen::Index> voxels_of(const ModularPass& pass, bool heads) {
  return heads ? pass.head_voxels : pass.voxels;
}

// What y was is kept in `sums`.
void apply_gate(const Matrix& scale, const Matrix& shift, const ModularPass& pass, bool heads,
                Matrix& sums, Matrix& y) {
  sums = y;
  const std::span<const Eigen::Index> voxels = voxels_of(pass, heads);
  for (Eigen::Index r = 0; r < y.rows(); ++r) {
    const Eigen::Index voxel = voxels[static_cast<std::size_t>(r)];
    y.row(r) = y.row(r).cwiseProduct(scale.row(voxel)) + shift.row(voxel);
  }
}

// The way back: what `slope`, dL/d(result), means for the sums replaces it, and for scale and
// shift is added to their slopes.
void backward_gate(const Matrix& scale, const ModularPass& pass, bool heads, const Matrix& sums,
                   Matrix& scale_slopes, Matrix& shift_slopes, Matrix& slope) {
  const std::span<const Eigen::Index> voxels = voxels_of(pass, heads);
  for (Eigen::Index r = 0; r < slope.rows(); ++r) {
    const Eigen::Index voxel = voxels[static_cast<std::size_t>(r)];
    shift_slopes.row(voxel) += slope.row(r);
    scale_slopes.row(voxel) += slope.row(r).cwiseProduct(sums.row(r));
    slope.row(r) = slope.row(r).cwiseProduct(scale.row(voxel));
  }
}

// slope := slope (1 - y^2): through y = tanh(x) back to x.
void times_tanh_slope(const Matrix& y, Matrix& slope) {
  slope.array() *= 1.0F - y.array().square();
}

// ---- the first layer ------------------------------------------------------------------

void forward_first(const ModularNetwork& network, const PreparedNetwork& prepared,
                   const VoxelSamples& batch, ModularPass& pass, Matrix& y) {
  pass.task_part.resize(batch.task.rows(), width(network));
  pass.task_part.rowwise() = network.bias.transpose();
  add_product(batch.task, prepared.task, pass.task_part);
  y.resize(batch.local.rows(), width(network));
  for (Eigen::Index r = 0; r < y.rows(); ++r)
    y.row(r) = pass.task_part.row(pass.samples[static_cast<std::size_t>(r)]);
  add_product(batch.local, prepared.local, y);
  pass.sums.resize(network.gates.size());
  pass.gate_slopes.resize(network.gates.size());
  apply_gate(prepared.gates.front().scale, prepared.fixed, pass, false, pass.sums[0], y);
  tanh_in_place(y);
}

// `slope` is dL/d(what the tanh gets).
void backward_first(const PreparedNetwork& prepared, const VoxelSamples& batch, Matrix& slope,
                    ModularPass& pass, ModularNetwork& gradient) {
  backward_gate(prepared.gates.front().scale, pass, false, pass.sums.front(),
                pass.gate_slopes.front().scale, pass.fixed_slopes, slope);
  add_product_transposed_left(slope, batch.local, gradient.local);
  pass.task_slopes.setZero(batch.task.rows(), slope.cols());
  for (Eigen::Index r = 0; r < slope.rows(); ++r)
    pass.task_slopes.row(pass.samples[static_cast<std::size_t>(r)]) += slope.row(r);
  add_product_transposed_left(pass.task_slopes, batch.task, gradient.task);
  for (Eigen::Index m = 0; m < pass.task_slopes.rows(); ++m)
    gradient.bias += pass.task_slopes.row(m).transpose();
}

// ---- between voxels ---------------------------------------------------------------------

// Whether layer l of the actor's `rest` is the last hidden one, which only acting voxels need.
bool of_heads(const ModularPolicy& policy, std::size_t l) {
  return l + 2 == policy.actor.rest.layers.size();
}

// What hidden layer l of `rest` reads of its own voxel.
const Matrix& own_of(const ModularPolicy& policy, const ModularPass& pass, std::size_t l) {
  return of_heads(policy, l) ? pass.head_inputs : pass.outputs[l];
}

// Sample of row r of a layer.
Eigen::Index sample_of(const ModularPass& pass, bool heads, Eigen::Index r) {
  const Eigen::Index row = heads ? pass.heads[static_cast<std::size_t>(r)] : r;
  return pass.samples[static_cast<std::size_t>(row)];
}

// Calls use(sample, row, share): the sample's mean has `share` of the row of a layer below.
template <typename Use>
void each_share(const ModularPass& pass, Use use) {
  for (std::size_t m = 0; m + 1 < pass.first.size(); ++m) {
    const float share = 1.0F / static_cast<float>(pass.first[m + 1] - pass.first[m]);
    for (Eigen::Index r = pass.first[m]; r < pass.first[m + 1]; ++r)
      use(static_cast<Eigen::Index>(m), r, share);
  }
}

void rows_of(const Matrix& from, const std::vector<Eigen::Index>& rows, Matrix& to) {
  to.resize(std::ssize(rows), from.cols());
  for (std::size_t i = 0; i < rows.size(); ++i)
    to.row(static_cast<Eigen::Index>(i)) = from.row(rows[i]);
}

// y += W [own, mean of all], hidden layer l of the actor's `rest`.
void add_hidden(const ModularPolicy& policy, const PreparedNetwork& prepared, std::size_t l,
                ModularPass& pass, Matrix& y) {
  const Matrix& weight = prepared.rest[l];
  const Matrix& below = pass.outputs[l];
  const Eigen::Index h = below.cols();
  add_product(own_of(policy, pass, l), weight.topRows(h), y);
  Matrix& others = pass.others[l];
  others.setZero(std::ssize(pass.first) - 1, h);
  each_share(pass, [&](Eigen::Index sample, Eigen::Index row, float share) {
    others.row(sample) += share * below.row(row);
  });
  pass.part.setZero(others.rows(), y.cols());
  add_product(others, weight.bottomRows(h), pass.part);
  for (Eigen::Index r = 0; r < y.rows(); ++r)
    y.row(r) += pass.part.row(sample_of(pass, of_heads(policy, l), r));
}

// The way back: the gradient of layer l's weight, and to `below` [rows of the layer below x h]
// what its slope means for them.
void backward_hidden(const ModularPolicy& policy, std::size_t l, const Matrix& slope,
                     ModularPass& pass, Layer& gradient, Matrix& below) {
  const bool heads = of_heads(policy, l);
  const Layer& layer = policy.actor.rest.layers[l];
  const Eigen::Index h = pass.outputs[l].cols();
  // own
  add_product_transposed_left(slope, own_of(policy, pass, l), gradient.weight.leftCols(h));
  Matrix& own = heads ? pass.below : below;
  own.setZero(slope.rows(), h);
  add_product(slope, layer.weight.leftCols(h), own);
  if (heads) {
    below.setZero(std::ssize(pass.voxels), h);
    for (std::size_t i = 0; i < pass.heads.size(); ++i)
      below.row(pass.heads[i]) = own.row(static_cast<Eigen::Index>(i));
  }
  // others
  const Matrix& others = pass.others[l];
  pass.others_slope.setZero(others.rows(), slope.cols());
  for (Eigen::Index r = 0; r < slope.rows(); ++r)
    pass.others_slope.row(sample_of(pass, heads, r)) += slope.row(r);
  add_product_transposed_left(pass.others_slope, others, gradient.weight.rightCols(h));
  pass.part.setZero(others.rows(), h);
  add_product(pass.others_slope, layer.weight.rightCols(h), pass.part);
  each_share(pass, [&](Eigen::Index sample, Eigen::Index row, float share) {
    below.row(row) += share * pass.part.row(sample);
  });
}

}  // namespace

// ---- parameters ---------------------------------------------------------------------------

std::optional<std::string> defect(const ModularPolicy& policy) {
  const auto task = policy.task.mean.size() + 2 * std::ssize(policy.clock);
  // Hidden layers of `rest` read `reads` times the layer below; the first `gated` have gates.
  const auto problem = [&](const ModularNetwork& network, Eigen::Index reads,
                           std::size_t gated) -> std::optional<std::string> {
    const Eigen::Index h = network.bias.size();
    if (network.local.rows() != h || network.task.rows() != h || network.fixed.rows() != h)
      return "its first layer has parts of different heights";
    if (network.local.cols() != VoxelViews::local_length || network.task.cols() != task ||
        network.fixed.cols() != VoxelViews::fixed_length)
      return "its first layer does not fit a voxel's view";
    Eigen::Index outputs = h;
    for (std::size_t l = 0; l < network.rest.layers.size(); ++l) {
      const Layer& layer = network.rest.layers[l];
      const bool head = l + 1 == network.rest.layers.size();
      if (layer.weight.cols() != (head ? outputs : reads * outputs) ||
          layer.weight.rows() != layer.bias.size())
        return fmt::format("layer {} does not fit the one before", l);
      outputs = layer.bias.size();
    }
    if (network.rest.layers.empty() || outputs != 1) return "its last layer has not one output";
    if (network.gates.size() != gated)
      return fmt::format("{} gates for {} layers", network.gates.size(), gated);
    for (std::size_t l = 0; l < gated; ++l) {
      const auto fits = [&](const Matrix& m) {
        return m.rows() == hidden_width(network, l) && m.cols() == VoxelViews::fixed_length;
      };
      if (!fits(network.gates[l].scale) ||
          (l == 0 ? network.gates[l].shift.size() != 0 : !fits(network.gates[l].shift)))
        return fmt::format("gate {} does not fit its layer", l);
    }
    return std::nullopt;
  };
  if (policy.actor.rest.layers.size() < 2) return "actor: it has fewer than two hidden layers";
  if (auto of_actor = problem(policy.actor, 2, policy.actor.rest.layers.size()))
    return "actor: " + *of_actor;
  if (auto of_critic = problem(policy.critic, 1, 1)) return "critic: " + *of_critic;
  if (policy.log_std.size() != 1) return "log_std: one number is expected";
  return std::nullopt;
}

std::vector<std::span<float>> parameter_blocks(ModularPolicy& policy) {
  return blocks_of<std::span<float>>(policy);
}
std::vector<std::span<const float>> parameter_blocks(const ModularPolicy& policy) {
  return blocks_of<std::span<const float>>(policy);
}
std::vector<std::span<float>> parameter_blocks(ModularGradients& gradients) {
  return blocks_of<std::span<float>>(gradients);
}

std::size_t parameter_count(const ModularPolicy& policy) {
  std::size_t count = 0;
  for (const auto& block : parameter_blocks(policy)) count += block.size();
  return count;
}

ModularGradients zero_gradients(const ModularPolicy& policy) {
  return {zeros_like(policy.actor), zeros_like(policy.critic), Vector::Zero(policy.log_std.size())};
}

ModularNetwork orthogonal_actor(int task_inputs, const std::vector<int>& widths, double hidden_gain,
                                double head_gain, Stream& stream) {
  ModularNetwork network =
      orthogonal_layers(task_inputs, widths, 2, hidden_gain, head_gain, stream);
  add_gates(network, widths.size());
  return network;
}

ModularNetwork orthogonal_critic(int task_inputs, const std::vector<int>& widths,
                                 double hidden_gain, double head_gain, Stream& stream) {
  ModularNetwork network =
      orthogonal_layers(task_inputs, widths, 1, hidden_gain, head_gain, stream);
  add_gates(network, 1);
  return network;
}

// ---- bodies ---------------------------------------------------------------------------------

Bodies::Bodies(std::span<const Arena* const> arenas) {
  Eigen::Index rows = 0;
  for (const Arena* arena : arenas) {
    views_.emplace_back(*arena);
    first_.push_back(rows);
    rows += views_.back().voxels();
    if (views_.back().task_length() != task_length())
      throw error(Failure::data,
                  "a controller for several robots needs one task; here are {} and {}",
                  arenas.front()->task().name, arena->task().name);
  }
  for (const VoxelViews& views : views_)
    for (Eigen::Index v = 0; v < views.fixed().rows(); ++v) fixed_.add_row(views.fixed().row(v));
}

// ---- passes -----------------------------------------------------------------------------------

void prepare(const ModularNetwork& network, const Bodies& bodies, PreparedNetwork& prepared) {
  prepared.local = network.local.transpose();
  prepared.task = network.task.transpose();
  prepared.rest.resize(network.rest.layers.size());
  for (std::size_t l = 0; l < prepared.rest.size(); ++l)
    prepared.rest[l] = network.rest.layers[l].weight.transpose();
  const auto of_fixed = [&](const Matrix& weight, float start, Matrix& part) {
    part.setConstant(bodies.fixed().rows(), weight.rows(), start);
    add_product(bodies.fixed(), weight.transpose(), part);
  };
  of_fixed(network.fixed, 0.0F, prepared.fixed);
  prepared.gates.resize(network.gates.size());
  for (std::size_t l = 0; l < network.gates.size(); ++l) {
    of_fixed(network.gates[l].scale, 1.0F, prepared.gates[l].scale);
    if (l > 0) of_fixed(network.gates[l].shift, 0.0F, prepared.gates[l].shift);
  }
}

void forward_actor(const ModularPolicy& policy, const Bodies& bodies,
                   const PreparedNetwork& prepared, const VoxelSamples& batch, ModularPass& pass,
                   std::span<float> means) {
  const std::vector<Layer>& layers = policy.actor.rest.layers;
  lay_rows(bodies, batch, pass);
  pass.outputs.resize(layers.size() + 1);
  pass.others.resize(layers.size());
  forward_first(policy.actor, prepared, batch, pass, pass.outputs.front());
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const bool heads = of_heads(policy, l);
    if (heads) rows_of(pass.outputs[l], pass.heads, pass.head_inputs);
    const Matrix& own = own_of(policy, pass, l);
    Matrix& y = pass.outputs[l + 1];
    y.resize(own.rows(), layers[l].bias.size());
    y.rowwise() = layers[l].bias.transpose();
    if (l + 1 == layers.size()) {
      add_product(own, prepared.rest[l], y);
      break;
    }
    add_hidden(policy, prepared, l, pass, y);
    const PreparedNetwork::Gate& gate = prepared.gates[l + 1];
    apply_gate(gate.scale, gate.shift, pass, heads, pass.sums[l + 1], y);
    tanh_in_place(y);
  }
  const Matrix& heads = pass.outputs.back();  // a row of each action
  std::copy_n(heads.data(), heads.size(), means.begin());
}

void forward_actor(const ModularPolicy& policy, const Bodies& bodies,
                   const PreparedNetwork& prepared, const VoxelBatch& batch, ModularPass& pass,
                   std::vector<float>& means) {
  std::size_t actions = 0;
  for (const int body : batch.bodies) actions += bodies[body].actuators().size();
  means.resize(actions);
  each_chunk(bodies, batch, [&](const VoxelSamples& samples, std::size_t, std::size_t action) {
    forward_actor(policy, bodies, prepared, samples, pass, std::span(means).subspan(action));
  });
}

void begin_backward(const ModularNetwork& network, const Bodies& bodies, ModularPass& pass) {
  const Eigen::Index voxels = bodies.fixed().rows();
  pass.fixed_slopes.setZero(voxels, width(network));
  pass.gate_slopes.resize(network.gates.size());
  for (std::size_t l = 0; l < network.gates.size(); ++l) {
    pass.gate_slopes[l].scale.setZero(voxels, network.gates[l].scale.rows());
    pass.gate_slopes[l].shift.setZero(voxels, network.gates[l].shift.rows());
  }
}

void end_backward(const Bodies& bodies, const ModularPass& pass, ModularNetwork& gradient) {
  const auto add = [&](const Matrix& slopes, Matrix& weight) {
    Matrix transposed = Matrix::Zero(weight.cols(), weight.rows());
    add_product_transposed_left(bodies.fixed(), slopes, transposed);
    weight += transposed.transpose();
  };
  add(pass.fixed_slopes, gradient.fixed);
  for (std::size_t l = 0; l < gradient.gates.size(); ++l) {
    add(pass.gate_slopes[l].scale, gradient.gates[l].scale);
    if (l > 0) add(pass.gate_slopes[l].shift, gradient.gates[l].shift);
  }
}

void backward_actor(const ModularPolicy& policy, const PreparedNetwork& prepared,
                    const VoxelSamples& batch, std::span<const float> slopes, ModularPass& pass,
                    ModularNetwork& gradient) {
  const std::vector<Layer>& layers = policy.actor.rest.layers;
  pass.slopes.resize(layers.size() + 1);  // dL/d(what the tanh of each layer gets)
  pass.slopes.back() = Eigen::Map<const Matrix>(slopes.data(), pass.outputs.back().rows(), 1);
  for (std::size_t l = layers.size(); l-- > 0;) {
    const bool last = l + 1 == layers.size();
    Matrix& slope = pass.slopes[l + 1];
    Matrix& below = pass.slopes[l];
    if (!last)
      backward_gate(prepared.gates[l + 1].scale, pass, of_heads(policy, l), pass.sums[l + 1],
                    pass.gate_slopes[l + 1].scale, pass.gate_slopes[l + 1].shift, slope);
    for (Eigen::Index r = 0; r < slope.rows(); ++r)
      gradient.rest.layers[l].bias += slope.row(r).transpose();
    if (last) {
      add_product_transposed_left(slope, pass.outputs[l], gradient.rest.layers[l].weight);
      below.setZero(slope.rows(), pass.outputs[l].cols());
      add_product(slope, layers[l].weight, below);
    } else {
      backward_hidden(policy, l, slope, pass, gradient.rest.layers[l], below);
    }
    times_tanh_slope(pass.outputs[l], below);
  }
  backward_first(prepared, batch, pass.slopes.front(), pass, gradient);
}

void forward_critic(const ModularPolicy& policy, const Bodies& bodies,
                    const PreparedNetwork& prepared, const VoxelSamples& batch, ModularPass& pass,
                    std::span<float> values) {
  const std::vector<Layer>& layers = policy.critic.rest.layers;
  lay_rows(bodies, batch, pass);
  pass.outputs.resize(layers.size() + 1);
  Matrix& first = pass.outputs.front();
  forward_first(policy.critic, prepared, batch, pass, first);
  pass.pooled.setZero(batch.task.rows(), first.cols());
  for (Eigen::Index m = 0; m < pass.pooled.rows(); ++m) {
    const Eigen::Index begin = pass.first[static_cast<std::size_t>(m)];
    const Eigen::Index end = pass.first[static_cast<std::size_t>(m) + 1];
    for (Eigen::Index r = begin; r < end; ++r) pass.pooled.row(m) += first.row(r);
    pass.pooled.row(m) *= 1.0F / static_cast<float>(end - begin);
  }
  for (std::size_t l = 0; l < layers.size(); ++l) {
    Matrix& y = pass.outputs[l + 1];
    y.resize(pass.pooled.rows(), layers[l].bias.size());
    y.rowwise() = layers[l].bias.transpose();
    add_product(l == 0 ? pass.pooled : pass.outputs[l], prepared.rest[l], y);
    if (l + 1 < layers.size()) tanh_in_place(y);
  }
  std::copy_n(pass.outputs.back().data(), pass.outputs.back().size(), values.begin());
}

void forward_critic(const ModularPolicy& policy, const Bodies& bodies,
                    const PreparedNetwork& prepared, const VoxelBatch& batch, ModularPass& pass,
                    Vector& values) {
  values.resize(std::ssize(batch.bodies));
  each_chunk(bodies, batch, [&](const VoxelSamples& samples, std::size_t first, std::size_t) {
    forward_critic(policy, bodies, prepared, samples, pass,
                   std::span(values.data(), batch.bodies.size()).subspan(first));
  });
}

void backward_critic(const ModularPolicy& policy, const PreparedNetwork& prepared,
                     const VoxelSamples& batch, std::span<const float> slopes, ModularPass& pass,
                     ModularNetwork& gradient) {
  const std::vector<Layer>& layers = policy.critic.rest.layers;
  pass.slopes.resize(layers.size() + 1);
  pass.slopes.back() = Eigen::Map<const Matrix>(slopes.data(), pass.pooled.rows(), 1);
  for (std::size_t l = layers.size(); l-- > 0;) {
    const Matrix& slope = pass.slopes[l + 1];
    const Matrix& input = l == 0 ? pass.pooled : pass.outputs[l];
    Matrix& below = l == 0 ? pass.below : pass.slopes[l];  // first: dL/d(pooled)
    for (Eigen::Index m = 0; m < slope.rows(); ++m)
      gradient.rest.layers[l].bias += slope.row(m).transpose();
    add_product_transposed_left(slope, input, gradient.rest.layers[l].weight);
    below.setZero(slope.rows(), input.cols());
    add_product(slope, layers[l].weight, below);
    if (l > 0) times_tanh_slope(input, below);
  }
  Matrix& first = pass.slopes.front();
  first.resize(pass.outputs.front().rows(), pass.below.cols());
  for (Eigen::Index m = 0; m < pass.pooled.rows(); ++m) {
    const Eigen::Index begin = pass.first[static_cast<std::size_t>(m)];
    const Eigen::Index end = pass.first[static_cast<std::size_t>(m) + 1];
    const float share = 1.0F / static_cast<float>(end - begin);
    for (Eigen::Index r = begin; r < end; ++r) first.row(r) = share * pass.below.row(m);
  }
  times_tanh_slope(pass.outputs.front(), first);
  backward_first(prepared, batch, first, pass, gradient);
}

// ---- acting -----------------------------------------------------------------------------------

double target_of(const ModularPolicy& policy, double output) {
  return target_of(policy.action_map, policy.low, policy.high, policy.action_offset, output);
}

ModularActor::ModularActor(const ModularPolicy& policy, const Arena& arena)
    : policy_(&policy), bodies_([&] {
        const Arena* const one = &arena;
        return Bodies({&one, 1});
      }()) {
  if (bodies_.task_length() != policy.task_length())
    throw error(Failure::data,
                "the controller sees {} numbers of its task, {} shows {}: it was trained on "
                "another task",
                policy.task_length(), arena.task().name, bodies_.task_length());
  prepare(policy.actor, bodies_, prepared_);
}

void ModularActor::act(const VecEnv& env, int first, std::span<const int> steps,
                       std::span<double> targets) {
  const std::size_t environments = steps.size();
  const VoxelViews& views = bodies_[0];
  const std::size_t local = static_cast<std::size_t>(views.voxels() * VoxelViews::local_length);
  const auto task = static_cast<std::size_t>(views.task_length());
  local_.resize(environments * local);
  task_.resize(environments * task);
  for (std::size_t e = 0; e < environments; ++e)
    views.look(env, first + static_cast<int>(e), std::span(local_).subspan(e * local, local),
               std::span(task_).subspan(e * task, task));
  batch_.bodies.assign(environments, 0);
  normalize(policy_->local, local_, batch_.local);
  network_inputs(policy_->task, policy_->clock, task_, steps, batch_.task);
  forward_actor(*policy_, bodies_, prepared_, batch_, pass_, means_);
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] = target_of(*policy_, static_cast<double>(means_[i]));
}

}  // namespace evo
