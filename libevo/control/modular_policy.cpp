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
void select_rows(const Bodies& bodies, const VoxelBatch& batch, Wanted wanted, ModularPass& pass) {
  pass.rows.clear();
  pass.first.assign(1, 0);
  pass.heads.clear();
  std::size_t rows = 0;
  for (const int body : batch.bodies)
    rows += wanted == Wanted::voxels ? static_cast<std::size_t>(bodies[body].voxels())
                                     : bodies[body].actuators().size();
  pass.local.resize(static_cast<Eigen::Index>(rows), VoxelViews::local_length);
  Eigen::Index from = 0;  // row of batch.local where the sample's voxels begin
  for (std::size_t m = 0; m < batch.bodies.size(); ++m) {
    const int body = batch.bodies[m];
    const VoxelViews& views = bodies[body];
    const auto begin = static_cast<Eigen::Index>(pass.rows.size());
    const auto add = [&](int voxel) {
      pass.local.row(static_cast<Eigen::Index>(pass.rows.size())) = batch.local.row(from + voxel);
      pass.rows.push_back({static_cast<Eigen::Index>(m), bodies.first(body) + voxel});
    };
    if (wanted == Wanted::voxels) {
      for (int v = 0; v < views.voxels(); ++v) add(v);
      for (const int v : views.actuators()) pass.heads.push_back(begin + v);
    } else {
      for (const int v : views.actuators()) {
        pass.heads.push_back(static_cast<Eigen::Index>(pass.rows.size()));
        add(v);
      }
    }
    pass.first.push_back(static_cast<Eigen::Index>(pass.rows.size()));
    from += views.voxels();
  }
}

// ---- the first layer ------------------------------------------------------------------

void forward_first(const ModularNetwork& network, const Matrix& fixed, const VoxelBatch& batch,
                   ModularPass& pass, Matrix& y) {
  pass.task_part.resize(batch.task.rows(), width(network));
  pass.task_part.rowwise() = network.bias.transpose();
  add_product_transposed_right(batch.task, network.task, pass.task_part);
  y.resize(pass.local.rows(), width(network));
  for (Eigen::Index r = 0; r < y.rows(); ++r) {
    const ModularPass::Row& row = pass.rows[static_cast<std::size_t>(r)];
    y.row(r) = pass.task_part.row(row.sample) + fixed.row(row.fixed);
  }
  add_product_transposed_right(pass.local, network.local, y);
  tanh_in_place(y);
}

// `slope` is dL/d(what the tanh gets).
void backward_first(const Bodies& bodies, const VoxelBatch& batch, const Matrix& slope,
                    ModularPass& pass, ModularNetwork& gradient) {
  add_product_transposed_left(slope, pass.local, gradient.local);
  pass.task_slopes.setZero(batch.task.rows(), slope.cols());
  pass.fixed_slopes.setZero(bodies.fixed().rows(), slope.cols());
  for (Eigen::Index r = 0; r < slope.rows(); ++r) {
    const ModularPass::Row& row = pass.rows[static_cast<std::size_t>(r)];
    pass.task_slopes.row(row.sample) += slope.row(r);
    pass.fixed_slopes.row(row.fixed) += slope.row(r);
  }
  add_product_transposed_left(pass.task_slopes, batch.task, gradient.task);
  add_product_transposed_left(pass.fixed_slopes, bodies.fixed(), gradient.fixed);
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

// Calls use(row, other, share): row of `others` that reads `share` of what row `other` of the
// layer below computed.
template <typename Use>
void each_other(const ModularPolicy& policy, const Bodies& bodies, const VoxelBatch& batch,
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
  return pass.rows[static_cast<std::size_t>(heads ? pass.heads[static_cast<std::size_t>(r)] : r)]
      .sample;
}

void rows_of(const Matrix& from, const std::vector<Eigen::Index>& rows, Matrix& to) {
  to.resize(std::ssize(rows), from.cols());
  for (std::size_t i = 0; i < rows.size(); ++i)
    to.row(static_cast<Eigen::Index>(i)) = from.row(rows[i]);
}

// y += W [own, mean of others], layer l of the actor's `rest`.
void add_with_others(const ModularPolicy& policy, const Bodies& bodies, const VoxelBatch& batch,
                     std::size_t l, ModularPass& pass, Matrix& y) {
  const bool heads = first_of_heads(policy, l);
  const Layer& layer = policy.actor.rest.layers[l];
  const Matrix& below = pass.outputs[l];
  const Eigen::Index h = below.cols();
  pass.half_weight = layer.weight.leftCols(h);
  add_product_transposed_right(pass.own[l], pass.half_weight, y);
  Matrix& others = pass.others[l];
  const bool body = policy.exchange == Exchange::body;
  others.setZero(body ? std::ssize(batch.bodies) : pass.own[l].rows(), h);
  each_other(policy, bodies, batch, pass, heads,
             [&](Eigen::Index row, Eigen::Index other, float share) {
               others.row(row) += share * below.row(other);
             });
  pass.half_weight = layer.weight.rightCols(h);
  if (!body) {
    add_product_transposed_right(others, pass.half_weight, y);
    return;
  }
  pass.part.setZero(others.rows(), y.cols());
  add_product_transposed_right(others, pass.half_weight, pass.part);
  for (Eigen::Index r = 0; r < y.rows(); ++r)
    y.row(r) += pass.part.row(others_row(policy, pass, heads, r));
}

// The way back: the gradient of layer l's weight, and to `below` [rows of the layer below x h]
// what its slope means for them.
void backward_with_others(const ModularPolicy& policy, const Bodies& bodies,
                          const VoxelBatch& batch, std::size_t l, const Matrix& slope,
                          ModularPass& pass, Layer& gradient, Matrix& below) {
  const bool heads = first_of_heads(policy, l);
  const Layer& layer = policy.actor.rest.layers[l];
  const Eigen::Index h = pass.outputs[l].cols();
  const Matrix& others = pass.others[l];
  // own
  pass.part.setZero(layer.weight.rows(), h);
  add_product_transposed_left(slope, pass.own[l], pass.part);
  gradient.weight.leftCols(h) += pass.part;
  pass.half_weight = layer.weight.leftCols(h);
  Matrix& own = heads ? pass.below : below;
  own.setZero(slope.rows(), h);
  add_product(slope, pass.half_weight, own);
  if (heads) {
    below.setZero(std::ssize(pass.rows), h);
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
  pass.part.setZero(layer.weight.rows(), h);
  add_product_transposed_left(*summed, others, pass.part);
  gradient.weight.rightCols(h) += pass.part;
  pass.half_weight = layer.weight.rightCols(h);
  pass.part.setZero(others.rows(), h);
  add_product(*summed, pass.half_weight, pass.part);
  each_other(policy, bodies, batch, pass, heads,
             [&](Eigen::Index row, Eigen::Index other, float share) {
               below.row(other) += share * pass.part.row(row);
             });
}

void times_tanh_slope(const Matrix& y, Matrix& slope) {
  slope.array() *= 1.0F - y.array().square();
}

}  // namespace

// ---- parameters ---------------------------------------------------------------------------

bool ModularNetwork::operator==(const ModularNetwork& other) const {
  return same(local, other.local) && same(task, other.task) && same(fixed, other.fixed) &&
         same(bias, other.bias) && rest == other.rest;
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
  if (auto of_actor = problem(policy.actor, policy.exchange)) return "actor: " + *of_actor;
  if (auto of_critic = problem(policy.critic, Exchange::none)) return "critic: " + *of_critic;
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
  fixed_.resize(rows, VoxelViews::fixed_length);
  for (std::size_t b = 0; b < views_.size(); ++b)
    fixed_.middleRows(first_[b], views_[b].voxels()) = views_[b].fixed();
}

// ---- passes -----------------------------------------------------------------------------------

void fixed_part(const ModularNetwork& network, const Bodies& bodies, Matrix& part) {
  part.setZero(bodies.fixed().rows(), width(network));
  add_product_transposed_right(bodies.fixed(), network.fixed, part);
}

void forward_actor(const ModularPolicy& policy, const Bodies& bodies, const Matrix& fixed,
                   const VoxelBatch& batch, ModularPass& pass, std::vector<float>& means) {
  const std::vector<Layer>& layers = policy.actor.rest.layers;
  const bool exchanges = reads_others(policy, 0);
  select_rows(bodies, batch, exchanges ? Wanted::voxels : Wanted::actuators, pass);
  pass.outputs.resize(layers.size() + 1);
  pass.own.resize(layers.size());
  pass.others.resize(layers.size());
  forward_first(policy.actor, fixed, batch, pass, pass.outputs.front());
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const bool others = reads_others(policy, l);
    if (first_of_heads(policy, l))
      rows_of(pass.outputs[l], pass.heads, pass.own[l]);
    else if (others)
      pass.own[l] = pass.outputs[l];
    const Matrix& own = others ? pass.own[l] : pass.outputs[l];
    Matrix& y = pass.outputs[l + 1];
    y.resize(own.rows(), layers[l].bias.size());
    y.rowwise() = layers[l].bias.transpose();
    if (others)
      add_with_others(policy, bodies, batch, l, pass, y);
    else
      add_product_transposed_right(own, layers[l].weight, y);
    if (l + 1 < layers.size()) tanh_in_place(y);
  }
  const Matrix& heads = pass.outputs.back();  // a row of each action
  means.assign(heads.data(), heads.data() + heads.size());
}

void backward_actor(const ModularPolicy& policy, const Bodies& bodies, const VoxelBatch& batch,
                    std::span<const float> slopes, ModularPass& pass, ModularNetwork& gradient) {
  const std::vector<Layer>& layers = policy.actor.rest.layers;
  pass.slopes.resize(layers.size() + 1);  // dL/d(what the tanh of each layer gets)
  pass.slopes.back() = Eigen::Map<const Matrix>(slopes.data(), std::ssize(slopes), 1);
  for (std::size_t l = layers.size(); l-- > 0;) {
    const Matrix& slope = pass.slopes[l + 1];
    Matrix& below = pass.slopes[l];
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
  backward_first(bodies, batch, pass.slopes.front(), pass, gradient);
}

void forward_critic(const ModularPolicy& policy, const Bodies& bodies, const Matrix& fixed,
                    const VoxelBatch& batch, ModularPass& pass, Vector& values) {
  select_rows(bodies, batch, Wanted::voxels, pass);
  pass.outputs.resize(1);
  Matrix& y = pass.outputs.front();
  forward_first(policy.critic, fixed, batch, pass, y);
  pass.pooled.setZero(batch.task.rows(), y.cols());
  for (Eigen::Index m = 0; m < pass.pooled.rows(); ++m) {
    const Eigen::Index begin = pass.first[static_cast<std::size_t>(m)];
    const Eigen::Index end = pass.first[static_cast<std::size_t>(m) + 1];
    for (Eigen::Index r = begin; r < end; ++r) pass.pooled.row(m) += y.row(r);
    pass.pooled.row(m) *= 1.0F / static_cast<float>(end - begin);
  }
  forward(policy.critic.rest, pass.pooled, pass.rest);
  values = pass.rest.back().col(0);
}

void backward_critic(const ModularPolicy& policy, const Bodies& bodies, const VoxelBatch& batch,
                     const Vector& slopes, ModularPass& pass, ModularNetwork& gradient) {
  const Network& rest = policy.critic.rest;
  pass.slopes.resize(rest.layers.size());
  pass.slopes.back() = slopes;
  backward(rest, pass.pooled, pass.rest, pass.slopes, gradient.rest);
  pass.task_slopes.setZero(pass.pooled.rows(), pass.pooled.cols());  // dL/d(pooled)
  add_product(pass.slopes.front(), rest.layers.front().weight, pass.task_slopes);
  const Matrix& y = pass.outputs.front();
  pass.below.resize(y.rows(), y.cols());
  for (Eigen::Index m = 0; m < pass.pooled.rows(); ++m) {
    const Eigen::Index begin = pass.first[static_cast<std::size_t>(m)];
    const Eigen::Index end = pass.first[static_cast<std::size_t>(m) + 1];
    const float share = 1.0F / static_cast<float>(end - begin);
    for (Eigen::Index r = begin; r < end; ++r) pass.below.row(r) = share * pass.task_slopes.row(m);
  }
  times_tanh_slope(y, pass.below);
  backward_first(bodies, batch, pass.below, pass, gradient);
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
  fixed_part(policy.actor, bodies_, fixed_);
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
  forward_actor(*policy_, bodies_, fixed_, batch_, pass_, means_);
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] = target_of(*policy_, static_cast<double>(means_[i]));
}

}  // namespace evo
