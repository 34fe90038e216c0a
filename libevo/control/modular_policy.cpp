#include "libevo/control/modular_policy.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "libevo/base/error.h"

namespace evo {
namespace {

template <typename Dense>
bool same(const Dense& a, const Dense& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
}

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

// ---- rows ---------------------------------------------------------------------------

enum class Wanted { actuators, voxels };

// The rows of a pass: of each sample's voxels all, or those that act.
void select_rows(const Bodies& bodies, const VoxelSamples& batch, Wanted wanted,
                 ModularPass& pass) {
  pass.samples.clear();
  pass.voxels.clear();
  pass.head_voxels.clear();
  pass.first.assign(1, 0);
  pass.heads.clear();
  for (std::size_t m = 0; m < batch.bodies.size(); ++m) {
    const int body = batch.bodies[m];
    const VoxelViews& views = bodies[body];
    const Eigen::Index begin = std::ssize(pass.voxels);
    const Eigen::Index first = bodies.first(body);
    const auto sample = static_cast<Eigen::Index>(m);
    for (const int v : views.actuators()) {
      pass.heads.push_back(wanted == Wanted::voxels ? begin + v : std::ssize(pass.heads));
      pass.head_voxels.push_back(first + v);
    }
    if (wanted == Wanted::voxels)
      for (int v = 0; v < views.voxels(); ++v) pass.voxels.push_back(first + v);
    else
      for (const int v : views.actuators()) pass.voxels.push_back(first + v);
    pass.samples.resize(pass.voxels.size(), sample);
    pass.first.push_back(std::ssize(pass.voxels));
  }
  if (wanted == Wanted::voxels) return;
  pass.local.resize(std::ssize(pass.voxels), batch.local.cols());
  Eigen::Index from = 0;  // row of batch.local where the sample's voxels begin
  Eigen::Index to = 0;
  for (const int body : batch.bodies) {
    for (const int v : bodies[body].actuators()) pass.local.row(to++) = batch.local.row(from + v);
    from += bodies[body].voxels();
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
  scale_rows(voxels_of(pass, heads), scale, shift, y);
}

// ---- the first layer ------------------------------------------------------------------

void forward_first(const ModularNetwork& network, const PreparedNetwork& prepared,
                   const VoxelSamples& batch, const MatrixView& local, ModularPass& pass,
                   Matrix& y) {
  const bool gated = !network.gates.empty();
  pass.task_part.resize(batch.task.rows(), width(network));
  pass.task_part.rowwise() = network.bias.transpose();
  add_product(batch.task, prepared.task, pass.task_part);
  y.resize(local.rows(), width(network));
  for (Eigen::Index r = 0; r < y.rows(); ++r) {
    const auto i = static_cast<std::size_t>(r);
    if (gated)
      y.row(r) = pass.task_part.row(pass.samples[i]);
    else
      y.row(r) = pass.task_part.row(pass.samples[i]) + prepared.fixed.row(pass.voxels[i]);
  }
  add_product(local, prepared.local, y);
  pass.sums.resize(network.gates.size());
  pass.gate_slopes.resize(network.gates.size());
  if (gated) apply_gate(prepared.gates.front().scale, prepared.fixed, pass, false, pass.sums[0], y);
  tanh_in_place(y);
}

// `slope` is dL/d(what the tanh gets).
void backward_first(const PreparedNetwork& prepared, const VoxelSamples& batch,
                    const MatrixView& local, Matrix& slope, ModularPass& pass,
                    ModularNetwork& gradient) {
  if (prepared.gates.empty())
    for (Eigen::Index r = 0; r < slope.rows(); ++r)
      pass.fixed_slopes.row(pass.voxels[static_cast<std::size_t>(r)]) += slope.row(r);
  else
    scale_rows_back(pass.voxels, prepared.gates.front().scale, pass.sums.front(),
                    pass.gate_slopes.front().scale, pass.fixed_slopes, slope);
  add_product_transposed_left(slope, local, gradient.local);
  pass.task_slopes.setZero(batch.task.rows(), slope.cols());
  for (Eigen::Index r = 0; r < slope.rows(); ++r)
    pass.task_slopes.row(pass.samples[static_cast<std::size_t>(r)]) += slope.row(r);
  add_product_transposed_left(pass.task_slopes, batch.task, gradient.task);
  for (Eigen::Index m = 0; m < pass.task_slopes.rows(); ++m)
    gradient.bias += pass.task_slopes.row(m).transpose();
}

// ---- between voxels ---------------------------------------------------------------------

// Whether layer l of the actor's `rest` reads other voxels, too.
bool reads_others(const ModularPolicy& policy, std::size_t l) {
  return policy.exchange != Exchange::none && l + 1 < policy.actor.rest.layers.size();
}

// Whether layer l of the actor's `rest` is the first that only acting voxels need: no layer
// above it reads what others computed.
bool first_of_heads(const ModularPolicy& policy, std::size_t l) {
  return reads_others(policy, l) && l + 2 == policy.actor.rest.layers.size();
}

// What layer l reads of its own voxel.
const Matrix& own_of(const ModularPolicy& policy, const ModularPass& pass, std::size_t l) {
  return first_of_heads(policy, l) ? pass.own[l] : pass.outputs[l];
}

// Calls use(row, other, share): row of `others` that reads `share` of what row `other` of the
// layer below computed.
template <typename Use>
void each_other(const ModularPolicy& policy, const Bodies& bodies, const VoxelSamples& batch,
                const ModularPass& pass, bool heads, Use use) {
  if (policy.exchange == Exchange::body) {
    for (std::size_t m = 0; m < batch.bodies.size(); ++m) {
      const float share = 1.0F / static_cast<float>(pass.first[m + 1] - pass.first[m]);
      for (Eigen::Index r = pass.first[m]; r < pass.first[m + 1]; ++r)
        use(static_cast<Eigen::Index>(m), r, share);
    }
    return;
  }
  Eigen::Index row = 0;
  const auto read = [&](const VoxelViews& views, Eigen::Index begin, int voxel) {
    const auto neighbours = views.neighbours(voxel);
    for (const int other : neighbours)
      use(row, begin + other, 1.0F / static_cast<float>(neighbours.size()));
    ++row;
  };
  for (std::size_t m = 0; m < batch.bodies.size(); ++m) {
    const VoxelViews& views = bodies[batch.bodies[m]];
    if (heads)
      for (const int v : views.actuators()) read(views, pass.first[m], v);
    else
      for (int v = 0; v < views.voxels(); ++v) read(views, pass.first[m], v);
  }
}

// Row of `others` for row r of a layer's own.
Eigen::Index others_row(const ModularPolicy& policy, const ModularPass& pass, bool heads,
                        Eigen::Index r) {
  if (policy.exchange == Exchange::neighbours) return r;
  const Eigen::Index row = heads ? pass.heads[static_cast<std::size_t>(r)] : r;
  return pass.samples[static_cast<std::size_t>(row)];
}

void rows_of(const Matrix& from, const std::vector<Eigen::Index>& rows, Matrix& to) {
  to.resize(std::ssize(rows), from.cols());
  for (std::size_t i = 0; i < rows.size(); ++i)
    to.row(static_cast<Eigen::Index>(i)) = from.row(rows[i]);
}

// y += W [own, mean of others], layer l of the actor's `rest`.
void add_with_others(const ModularPolicy& policy, const Bodies& bodies,
                     const PreparedNetwork& prepared, const VoxelSamples& batch, std::size_t l,
                     ModularPass& pass, Matrix& y) {
  const bool heads = first_of_heads(policy, l);
  const Matrix& weight = prepared.rest[l];
  const Matrix& below = pass.outputs[l];
  const Eigen::Index h = below.cols();
  add_product(own_of(policy, pass, l), weight.topRows(h), y);
  Matrix& others = pass.others[l];
  const bool body = policy.exchange == Exchange::body;
  others.setZero(body ? std::ssize(batch.bodies) : y.rows(), h);
  each_other(policy, bodies, batch, pass, heads,
             [&](Eigen::Index row, Eigen::Index other, float share) {
               others.row(row) += share * below.row(other);
             });
  if (!body) {
    add_product(others, weight.bottomRows(h), y);
    return;
  }
  pass.part.setZero(others.rows(), y.cols());
  add_product(others, weight.bottomRows(h), pass.part);
  for (Eigen::Index r = 0; r < y.rows(); ++r)
    y.row(r) += pass.part.row(others_row(policy, pass, heads, r));
}

// The way back: the gradient of layer l's weight, and to `below` [rows of the layer below x h]
// what its slope means for them.
void backward_with_others(const ModularPolicy& policy, const Bodies& bodies,
                          const VoxelSamples& batch, std::size_t l, const Matrix& slope,
                          ModularPass& pass, Layer& gradient, Matrix& below) {
  const bool heads = first_of_heads(policy, l);
  const Layer& layer = policy.actor.rest.layers[l];
  const Eigen::Index h = pass.outputs[l].cols();
  const Matrix& others = pass.others[l];
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
  const Matrix* summed = &slope;
  if (policy.exchange == Exchange::body) {
    pass.others_slope.setZero(others.rows(), slope.cols());
    for (Eigen::Index r = 0; r < slope.rows(); ++r)
      pass.others_slope.row(others_row(policy, pass, heads, r)) += slope.row(r);
    summed = &pass.others_slope;
  }
  add_product_transposed_left(*summed, others, gradient.weight.rightCols(h));
  pass.part.setZero(others.rows(), h);
  add_product(*summed, layer.weight.rightCols(h), pass.part);
  each_other(policy, bodies, batch, pass, heads,
             [&](Eigen::Index row, Eigen::Index other, float share) {
               below.row(other) += share * pass.part.row(row);
             });
}

bool reads_voxels(const ModularPolicy& policy) { return reads_others(policy, 0); }

// Where the first layer of the actor reads what it is applied to.
const MatrixView actor_local(const ModularPolicy& policy, const VoxelSamples& batch,
                             const ModularPass& pass) {
  return reads_voxels(policy) ? batch.local : MatrixView(pass.local);
}

}  // namespace

// ---- parameters ---------------------------------------------------------------------------

bool Gate::operator==(const Gate& other) const {
  return same(scale, other.scale) && same(shift, other.shift);
}

bool ModularNetwork::operator==(const ModularNetwork& other) const {
  return same(local, other.local) && same(task, other.task) && same(fixed, other.fixed) &&
         same(bias, other.bias) && rest == other.rest && gates == other.gates;
}

bool ModularPolicy::operator==(const ModularPolicy& other) const {
  return exchange == other.exchange && actor == other.actor && critic == other.critic &&
         same(log_std, other.log_std) && local == other.local && task == other.task &&
         action_map == other.action_map && action_offset == other.action_offset &&
         low == other.low && high == other.high && clock == other.clock;
}

std::optional<std::string> defect(const ModularPolicy& policy) {
  const auto task = policy.task.mean.size() + 2 * std::ssize(policy.clock);
  const auto problem = [&](const ModularNetwork& network,
                           Exchange exchange) -> std::optional<std::string> {
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
      const Eigen::Index reads = exchange == Exchange::none || head ? outputs : 2 * outputs;
      if (layer.weight.cols() != reads || layer.weight.rows() != layer.bias.size())
        return fmt::format("layer {} does not fit the one before", l);
      outputs = layer.bias.size();
    }
    if (network.rest.layers.empty() || outputs != 1) return "its last layer has not one output";
    return std::nullopt;
  };
  const auto misfit = [&](const ModularNetwork& network,
                          std::size_t gated) -> std::optional<std::string> {
    if (network.gates.empty()) return std::nullopt;
    if (network.gates.size() != gated)
      return fmt::format("{} gates for {} layers", network.gates.size(), gated);
    for (std::size_t l = 0; l < gated; ++l) {
      const Eigen::Index h = l == 0 ? network.bias.size() : network.rest.layers[l - 1].bias.size();
      const auto fits = [&](const Matrix& m) {
        return m.rows() == h && m.cols() == VoxelViews::fixed_length;
      };
      if (!fits(network.gates[l].scale) ||
          (l == 0 ? network.gates[l].shift.size() != 0 : !fits(network.gates[l].shift)))
        return fmt::format("gate {} does not fit its layer", l);
    }
    return std::nullopt;
  };
  if (auto of_actor = problem(policy.actor, policy.exchange)) return "actor: " + *of_actor;
  if (auto of_critic = problem(policy.critic, Exchange::none)) return "critic: " + *of_critic;
  if (auto of_actor = misfit(policy.actor, policy.actor.rest.layers.size()))
    return "actor: " + *of_actor;
  if (auto of_critic = misfit(policy.critic, 1)) return "critic: " + *of_critic;
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

ModularNetwork orthogonal_modular_network(int task_inputs, const std::vector<int>& widths,
                                          Exchange exchange, double hidden_gain, double head_gain,
                                          Stream& stream) {
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
    const int reads = exchange == Exchange::none || head ? widths[l - 1] : 2 * widths[l - 1];
    Network next = orthogonal_network(reads, {}, head ? 1 : widths[l], 1.0,
                                      head ? head_gain : hidden_gain, stream);
    network.rest.layers.push_back(std::move(next.layers.front()));
  }
  return network;
}

void add_gates(ModularNetwork& network, std::size_t layers) {
  network.gates.clear();
  for (std::size_t l = 0; l < layers; ++l) {
    const Eigen::Index h = l == 0 ? network.bias.size() : network.rest.layers[l - 1].bias.size();
    const Matrix zero = Matrix::Zero(h, VoxelViews::fixed_length);
    network.gates.push_back({zero, l == 0 ? Matrix() : zero});
  }
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
  select_rows(bodies, batch, reads_voxels(policy) ? Wanted::voxels : Wanted::actuators, pass);
  pass.outputs.resize(layers.size() + 1);
  pass.own.resize(layers.size());
  pass.others.resize(layers.size());
  forward_first(policy.actor, prepared, batch, actor_local(policy, batch, pass), pass,
                pass.outputs.front());
  for (std::size_t l = 0; l < layers.size(); ++l) {
    if (first_of_heads(policy, l)) rows_of(pass.outputs[l], pass.heads, pass.own[l]);
    const Matrix& own = own_of(policy, pass, l);
    Matrix& y = pass.outputs[l + 1];
    y.resize(own.rows(), layers[l].bias.size());
    y.rowwise() = layers[l].bias.transpose();
    if (reads_others(policy, l))
      add_with_others(policy, bodies, prepared, batch, l, pass, y);
    else
      add_product(own, prepared.rest[l], y);
    if (l + 1 == layers.size()) break;
    if (!prepared.gates.empty()) {
      const PreparedNetwork::Gate& gate = prepared.gates[l + 1];
      apply_gate(gate.scale, gate.shift, pass, first_of_heads(policy, l), pass.sums[l + 1], y);
    }
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

void backward_actor(const ModularPolicy& policy, const Bodies& bodies,
                    const PreparedNetwork& prepared, const VoxelSamples& batch,
                    std::span<const float> slopes, ModularPass& pass, ModularNetwork& gradient) {
  const std::vector<Layer>& layers = policy.actor.rest.layers;
  pass.slopes.resize(layers.size() + 1);  // dL/d(what the tanh of each layer gets)
  pass.slopes.back() = Eigen::Map<const Matrix>(slopes.data(), pass.outputs.back().rows(), 1);
  for (std::size_t l = layers.size(); l-- > 0;) {
    Matrix& slope = pass.slopes[l + 1];
    Matrix& below = pass.slopes[l];
    if (!prepared.gates.empty() && l + 1 < layers.size())
      scale_rows_back(voxels_of(pass, first_of_heads(policy, l)), prepared.gates[l + 1].scale,
                      pass.sums[l + 1], pass.gate_slopes[l + 1].scale,
                      pass.gate_slopes[l + 1].shift, slope);
    for (Eigen::Index r = 0; r < slope.rows(); ++r)
      gradient.rest.layers[l].bias += slope.row(r).transpose();
    if (reads_others(policy, l)) {
      backward_with_others(policy, bodies, batch, l, slope, pass, gradient.rest.layers[l], below);
    } else {
      add_product_transposed_left(slope, pass.outputs[l], gradient.rest.layers[l].weight);
      below.setZero(slope.rows(), pass.outputs[l].cols());
      add_product(slope, layers[l].weight, below);
    }
    times_tanh_slope(pass.outputs[l], below);
  }
  backward_first(prepared, batch, actor_local(policy, batch, pass), pass.slopes.front(), pass,
                 gradient);
}

void forward_critic(const ModularPolicy& policy, const Bodies& bodies,
                    const PreparedNetwork& prepared, const VoxelSamples& batch, ModularPass& pass,
                    std::span<float> values) {
  const std::vector<Layer>& layers = policy.critic.rest.layers;
  select_rows(bodies, batch, Wanted::voxels, pass);
  pass.outputs.resize(layers.size() + 1);
  Matrix& first = pass.outputs.front();
  forward_first(policy.critic, prepared, batch, batch.local, pass, first);
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
  backward_first(prepared, batch, batch.local, first, pass, gradient);
}

// ---- acting -----------------------------------------------------------------------------------

void task_inputs(const ModularPolicy& policy, std::span<const double> task,
                 std::span<const int> steps, Matrix& inputs) {
  network_inputs(policy.task, policy.clock, task, steps, inputs);
}

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

void ModularActor::act(const VecEnv& env, std::span<const int> steps, std::span<double> targets) {
  const std::size_t environments = steps.size();
  const VoxelViews& views = bodies_[0];
  const std::size_t local = static_cast<std::size_t>(views.voxels() * VoxelViews::local_length);
  const auto task = static_cast<std::size_t>(views.task_length());
  local_.resize(environments * local);
  task_.resize(environments * task);
  for (std::size_t e = 0; e < environments; ++e)
    views.look(env, static_cast<int>(e), std::span(local_).subspan(e * local, local),
               std::span(task_).subspan(e * task, task));
  batch_.bodies.assign(environments, 0);
  normalize(policy_->local, local_, batch_.local);
  task_inputs(*policy_, task_, steps, batch_.task);
  forward_actor(*policy_, bodies_, prepared_, batch_, pass_, means_);
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] = target_of(*policy_, static_cast<double>(means_[i]));
}

}  // namespace evo
