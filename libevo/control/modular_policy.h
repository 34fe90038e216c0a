// A controller that any body can wear: one small network, the same for every voxel, reads
// the voxel's own view (voxel_views.h) and puts out the target of that voxel, as in Talamini
// et al. 2019 and Mertan and Cheney 2023 (docs/modular.md, "The network"; in files
// docs/formats/policy.md). Single precision; the same bits everywhere, as in matrix.h.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libevo/control/policy.h"
#include "libevo/control/voxel_views.h"

namespace evo {

// A hidden layer whose units sum up x puts out tanh(x (1 + scale f) + shift f), f the fixed part.
struct Gate {
  Matrix scale;  // [H x VoxelViews::fixed_length]
  Matrix shift;  // as large; of the first layer none, since that is its `fixed`
  bool operator==(const Gate&) const = default;
};

// y = tanh((local l' + task t' + bias) (1 + scale f') + fixed f') for the parts l, t, f of a
// voxel's view; then the layers of `rest`, tanh after all but the last.
struct ModularNetwork {
  Matrix local;  // [H x VoxelViews::local_length]
  Matrix task;   // [H x (task + 2 periods)]
  Matrix fixed;  // [H x VoxelViews::fixed_length]
  Vector bias;   // [H]
  Network rest;
  // For every hidden layer that a voxel has: the critic's is the first alone.
  std::vector<Gate> gates;
  bool operator==(const ModularNetwork&) const = default;
};

struct ModularPolicy {
  // Two hidden layers or more. The last layer has one output, the hidden ones of `rest` read
  // [own y, mean of all voxels' y].
  ModularNetwork actor;
  // `rest` reads the mean of y over all voxels of the body.
  ModularNetwork critic;
  Vector log_std;    // [1]
  Normalizer local;  // over voxels
  Normalizer task;   // over environments, without the clock
  ActionMap action_map = ActionMap::offset;
  double action_offset = 1.0;
  double low = 0.6;
  double high = 1.6;
  std::vector<double> clock;  // as in Policy

  int task_length() const { return static_cast<int>(task.mean.size()); }
  bool operator==(const ModularPolicy&) const = default;
};

// What is wrong with the shapes of its networks, in words, or nothing.
std::optional<std::string> defect(const ModularPolicy& policy);

struct ModularGradients {
  ModularNetwork actor;
  ModularNetwork critic;
  Vector log_std;
};

// All parameters as runs of floats, in one fixed order: actor, critic (local, task, fixed,
// bias, weight and bias of every layer of `rest`, scale and shift of every gate), log_std. Of
// gradients likewise.
std::vector<std::span<float>> parameter_blocks(ModularPolicy& policy);
std::vector<std::span<const float>> parameter_blocks(const ModularPolicy& policy);
std::vector<std::span<float>> parameter_blocks(ModularGradients& gradients);
std::size_t parameter_count(const ModularPolicy& policy);
ModularGradients zero_gradients(const ModularPolicy& policy);

// Orthogonal layers, the first one over the whole view, of `widths` hidden layers and one output,
// and gates of zeros, which change nothing yet.
ModularNetwork orthogonal_actor(int task_inputs, const std::vector<int>& widths, double hidden_gain,
                                double head_gain, Stream& stream);
ModularNetwork orthogonal_critic(int task_inputs, const std::vector<int>& widths,
                                 double hidden_gain, double head_gain, Stream& stream);

// The bodies that a batch is of.
class Bodies {
 public:
  // `arenas` are of one task. Throws Error(data) where one of them shows other parts of the world.
  explicit Bodies(std::span<const Arena* const> arenas);

  int size() const { return static_cast<int>(views_.size()); }
  const VoxelViews& operator[](int body) const { return views_[static_cast<std::size_t>(body)]; }
  int task_length() const { return views_.front().task_length(); }
  // Row of a body's first voxel among the voxels of all.
  Eigen::Index first(int body) const { return first_[static_cast<std::size_t>(body)]; }
  const SparseMatrix& fixed() const { return fixed_; }  // [voxels of all x fixed_length]

 private:
  std::vector<VoxelViews> views_;
  std::vector<Eigen::Index> first_;
  SparseMatrix fixed_;
};

// Samples of any bodies, as networks see them.
struct VoxelBatch {
  std::vector<int> bodies;  // [M]
  Matrix local;             // [R x local_length], the voxels of each sample in turn
  Matrix task;              // [M x (task + 2 periods)]
};

// Some samples of a batch, one after the other.
struct VoxelSamples {
  std::span<const int> bodies;
  MatrixView local;
  MatrixView task;
};

// Calls use(samples, first sample, first action) for a batch's samples, so few at a time that
// what a pass leaves behind stays in the processor's cache.
template <typename Use>
void each_chunk(const Bodies& bodies, const VoxelBatch& batch, Use use) {
  constexpr Eigen::Index enough = 256;  // voxels
  const std::size_t samples = batch.bodies.size();
  Eigen::Index row = 0;
  std::size_t action = 0;
  for (std::size_t begin = 0, end = 0; begin < samples; begin = end) {
    Eigen::Index rows = 0;
    std::size_t actions = 0;
    for (; end < samples && rows < enough; ++end) {
      const VoxelViews& views = bodies[batch.bodies[end]];
      rows += views.voxels();
      actions += views.actuators().size();
    }
    const auto count = static_cast<Eigen::Index>(end - begin);
    use(VoxelSamples{std::span(batch.bodies).subspan(begin, end - begin),
                     batch.local.middleRows(row, rows),
                     batch.task.middleRows(static_cast<Eigen::Index>(begin), count)},
        begin, action);
    row += rows;
    action += actions;
  }
}

// What a network's parameters come to for some bodies, made anew when parameters change.
struct PreparedNetwork {
  // What the fixed part of all views means to a layer [voxels of all x H].
  struct Gate {
    Matrix scale;  // with the 1
    Matrix shift;
  };
  Matrix fixed;  // to the first
  std::vector<Gate> gates;
  // Transposed weights, which products read where they lie.
  Matrix local;
  Matrix task;
  std::vector<Matrix> rest;
};
void prepare(const ModularNetwork& network, const Bodies& bodies, PreparedNetwork& prepared);

// What a pass through a network left behind, kept from call to call.
struct ModularPass {
  // Each row is a voxel of a sample: which sample's it is, and which voxel of all bodies'.
  std::vector<Eigen::Index> samples;
  std::vector<Eigen::Index> voxels;
  std::vector<Eigen::Index> first;  // [M + 1] row of each sample's
  std::vector<Eigen::Index> heads;  // the row of each action
  std::vector<Eigen::Index> head_voxels;
  Matrix task_part;  // [M x H]
  // Actor: the last hidden layer is computed for the voxels that act alone and reads these rows.
  Matrix head_inputs;
  std::vector<Matrix> others;  // [M x H] the mean over a body's voxels that a layer of `rest` reads
  Matrix part;                 // what comes of the part of others
  Matrix pooled;               // [M x H] (critic)
  std::vector<Matrix> sums;    // of the units of gated layers
  std::vector<Matrix> outputs;  // of the first layer and of those of `rest`
  // backward
  // Sums over passes, [voxels of all x H].
  Matrix fixed_slopes;
  std::vector<PreparedNetwork::Gate> gate_slopes;
  std::vector<Matrix> slopes;
  Matrix below;
  Matrix task_slopes;
  Matrix others_slope;
};

// The mean of every action of every sample, in the order of samples and of actions.
void forward_actor(const ModularPolicy& policy, const Bodies& bodies,
                   const PreparedNetwork& prepared, const VoxelSamples& batch, ModularPass& pass,
                   std::span<float> means);
// The value of every sample.
void forward_critic(const ModularPolicy& policy, const Bodies& bodies,
                    const PreparedNetwork& prepared, const VoxelSamples& batch, ModularPass& pass,
                    std::span<float> values);
// All samples of a batch.
void forward_actor(const ModularPolicy& policy, const Bodies& bodies,
                   const PreparedNetwork& prepared, const VoxelBatch& batch, ModularPass& pass,
                   std::vector<float>& means);
void forward_critic(const ModularPolicy& policy, const Bodies& bodies,
                    const PreparedNetwork& prepared, const VoxelBatch& batch, ModularPass& pass,
                    Vector& values);

// Add to `gradient` what dL/d(means) or dL/d(values) means for the network's parameters; `pass`
// comes from the pass forward with the same samples. What reads the fixed part has its gradient
// from end_backward(), for all passes since begin_backward() together.
void begin_backward(const ModularNetwork& network, const Bodies& bodies, ModularPass& pass);
void backward_actor(const ModularPolicy& policy, const PreparedNetwork& prepared,
                    const VoxelSamples& batch, std::span<const float> slopes, ModularPass& pass,
                    ModularNetwork& gradient);
void backward_critic(const ModularPolicy& policy, const PreparedNetwork& prepared,
                     const VoxelSamples& batch, std::span<const float> slopes, ModularPass& pass,
                     ModularNetwork& gradient);
void end_backward(const Bodies& bodies, const ModularPass& pass, ModularNetwork& gradient);

double target_of(const ModularPolicy& policy, double output);

// The deterministic controller on one robot, for any number of environments of its arena.
class ModularActor {
 public:
  // `policy` must outlive this. Throws Error(data) where the arena's task shows another
  // number of values than the policy was trained on.
  ModularActor(const ModularPolicy& policy, const Arena& arena);
  // Targets [E x A] of E environments of `env`, from `first` on, at `steps` [E] of their episodes.
  void act(const VecEnv& env, int first, std::span<const int> steps, std::span<double> targets);

 private:
  const ModularPolicy* policy_;
  Bodies bodies_;
  PreparedNetwork prepared_;
  VoxelBatch batch_;
  ModularPass pass_;
  std::vector<double> local_;
  std::vector<double> task_;
  std::vector<float> means_;
};

}  // namespace evo
