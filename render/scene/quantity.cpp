#include "render/scene/quantity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "formats/rollout/ending.h"
#include "libevo/base/error.h"
#include "render/scene/round_numbers.h"

namespace evo::render {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

double area(const ModelCell& cell, std::span<const Vec2> points) {
  const auto [tl, tr, bl, br] = cell.points;
  const auto at = [&](int k) { return points[static_cast<std::size_t>(k)]; };
  const Vec2 one{at(tr).x - at(bl).x, at(tr).y - at(bl).y};
  const Vec2 two{at(tl).x - at(br).x, at(tl).y - at(br).y};
  return 0.5 * (one.x * two.y - one.y * two.x);
}

// ---- springs ----------------------------------------------------------------------------

// As the simulator has them (docs/physics.md, "Springs" and "Actuation"). Lengths in voxels.
struct Spring {
  int a = 0;
  int b = 0;
  double stiffness = 0;        // raw
  double rest = 1;             // undriven
  std::vector<int> actuators;  // that drive it
  std::vector<int> cells;      // one, or the two that share it
};

const SpringStiffness& stiffness_of(Voxel type, const Physics& physics) {
  if (type == Voxel::soft) return physics.soft;
  if (is_actuator(type)) return physics.actuator;
  return physics.rigid;
}

bool lies_along(const ModelCell& cell, int a, int b, Voxel actuator) {
  const auto [tl, tr, bl, br] = cell.points;
  const auto is = [&](int p, int q) { return (a == p && b == q) || (a == q && b == p); };
  return actuator == Voxel::horizontal ? is(tl, tr) || is(bl, br) : is(tl, bl) || is(tr, br);
}

// Factors of the springs of each cell, 1 where the robot says nothing.
std::vector<double> factors_of(const Rollout& rollout, const Mesh& mesh) {
  std::vector<double> factors(mesh.cells.size(), 1.0);
  if (!rollout.robot || rollout.robot->body.stiffness.empty()) return factors;
  const Body& body = rollout.robot->body;
  const ModelObject& robot = mesh.objects.front();
  auto cell = static_cast<std::size_t>(robot.first_cell);
  const std::size_t end = cell + static_cast<std::size_t>(robot.cells);
  for (std::size_t k = 0; k < body.cells.size() && cell < end; ++k)
    if (body.cells[k] != Voxel::empty) factors[cell++] = body.stiffness[k];
  return factors;
}

std::vector<Spring> springs_of(const Mesh& mesh, const Physics& physics,
                               const std::vector<double>& factors) {
  std::vector<int> actuator(mesh.cells.size(), -1);
  const std::vector<int> actuators = actuators_of(mesh);
  for (std::size_t k = 0; k < actuators.size(); ++k)
    actuator[static_cast<std::size_t>(actuators[k])] = static_cast<int>(k);
  std::vector<Spring> springs;
  for (const Mesh::Edge& edge : mesh.edges) {
    Spring spring{edge.a, edge.b, physics.rigid.edge, 1, {}, {edge.cell}};
    if (edge.other >= 0) spring.cells.push_back(edge.other);
    std::sort(spring.cells.begin(), spring.cells.end());
    for (const int c : spring.cells) {
      const ModelCell& cell = mesh.cells[static_cast<std::size_t>(c)];
      // The later of two cells that are not rigid decides.
      if (cell.type == Voxel::soft || is_actuator(cell.type))
        spring.stiffness = stiffness_of(cell.type, physics).edge;
      if (is_actuator(cell.type) && lies_along(cell, edge.a, edge.b, cell.type))
        spring.actuators.push_back(actuator[static_cast<std::size_t>(c)]);
    }
    double sum = 0;
    for (const int c : spring.cells) sum += factors[static_cast<std::size_t>(c)];
    spring.stiffness *= sum / static_cast<double>(spring.cells.size());
    std::erase(spring.actuators, -1);
    springs.push_back(std::move(spring));
  }
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const ModelCell& cell = mesh.cells[c];
    const double stiffness = stiffness_of(cell.type, physics).diagonal * factors[c];
    const auto [tl, tr, bl, br] = cell.points;
    for (const auto& [a, b] : {std::pair{tr, bl}, std::pair{tl, br}})
      springs.push_back({a, b, stiffness, std::numbers::sqrt2, {}, {static_cast<int>(c)}});
  }
  return springs;
}

// ---- over an episode ------------------------------------------------------------------------

std::span<const double> actions(const RolloutEpisode& episode, std::size_t count, int step) {
  return std::span(episode.actions).subspan(static_cast<std::size_t>(step) * count, count);
}

void check_actions(const RolloutEpisode& episode, std::size_t actuators) {
  const auto needed = static_cast<std::size_t>(episode.steps()) * actuators;
  if (episode.actions.size() != needed)
    throw error(Failure::data,
                "the episode has {} numbers in its actions, but {} steps of {} actuators need {}, "
                "so commanded lengths and stress are not known",
                episode.actions.size(), episode.steps(), actuators, needed);
}

void fill_strain(const Mesh& mesh, std::span<const Vec2> points, std::span<float> values) {
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.cells[c].type != Voxel::fixed)
      values[c] = static_cast<float>(area(mesh.cells[c], points) - 1);
}

class Stress {
 public:
  Stress(const Rollout& rollout, const Mesh& mesh)
      : mesh_(mesh),
        physics_(physics_of(rollout)),
        springs_(springs_of(mesh, physics_, factors_of(rollout, mesh))) {
    for (const Spring& spring : springs_) rest_.push_back(spring.rest);
    weight_ = mesh.objects.front().points * physics_.gravity;
    if (weight_ <= 0)
      throw Error(Failure::data, "without gravity there is no weight to measure stress with");
  }

  // Rest lengths follow their targets, a share of the way in every substep.
  void follow(std::span<const double> targets) {
    const double left = std::pow(1 - physics_.actuation_rate, physics_.substeps);
    for (std::size_t k = 0; k < springs_.size(); ++k) {
      if (springs_[k].actuators.empty()) continue;
      double goal = 0;
      for (const int each : springs_[k].actuators) goal += targets[static_cast<std::size_t>(each)];
      goal = goal / static_cast<double>(springs_[k].actuators.size()) * springs_[k].rest;
      rest_[k] = goal + (rest_[k] - goal) * left;
    }
  }

  void fill(std::span<const Vec2> points, std::span<float> values) const {
    for (std::size_t c = 0; c < mesh_.cells.size(); ++c)
      if (mesh_.cells[c].type != Voxel::fixed) values[c] = 0;
    for (std::size_t k = 0; k < springs_.size(); ++k) {
      const Spring& spring = springs_[k];
      const double length = distance(points[static_cast<std::size_t>(spring.a)],
                                     points[static_cast<std::size_t>(spring.b)]);
      const double pull = spring.stiffness * physics_.voxel_length * (length - rest_[k]) / weight_;
      for (const int c : spring.cells) {
        const double size =
            std::max(0.05, std::abs(area(mesh_.cells[static_cast<std::size_t>(c)], points)));
        values[static_cast<std::size_t>(c)] += static_cast<float>(
            pull * length / (2 * size) / static_cast<double>(spring.cells.size()));
      }
    }
  }

 private:
  const Mesh& mesh_;
  Physics physics_;
  std::vector<Spring> springs_;
  std::vector<double> rest_;  // now
  double weight_ = 0;
};

// The largest of most values; few that stick out must not make all others pale.
double usual_extreme(const std::vector<float>& values) {
  constexpr double share = 0.98;
  std::vector<float> sizes;
  for (const float value : values)
    if (!std::isnan(value)) sizes.push_back(std::abs(value));
  if (sizes.empty()) return 0;
  const auto at =
      sizes.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), at, sizes.end());
  return static_cast<double>(*at);
}

}  // namespace

ValueScale command_scale() { return {"commanded length", 0.6, 1.0, 1.6}; }

Physics physics_of(const Rollout& rollout) {
  if (rollout.physics_yaml.empty())
    throw Error(Failure::data,
                "the rollout does not carry its physics (attribute physics_yaml), "
                "so forces are not known; record it with evo-eval --rollout");
  Physics physics = recorded_physics(rollout);
  physics.substeps *= hold_of(rollout);
  return physics;
}

std::vector<int> actuators_of(const Mesh& mesh) {
  std::vector<int> cells;
  const ModelObject& robot = mesh.objects.front();
  for (int c = robot.first_cell; c < robot.first_cell + robot.cells; ++c)
    if (is_actuator(mesh.cells[static_cast<std::size_t>(c)].type)) cells.push_back(c);
  return cells;
}

Quantity::Quantity(Tint what, const Rollout& rollout, const RolloutEpisode& episode,
                   const Mesh& mesh, std::span<const Vec2> points)
    : cells_(mesh.cells.size()) {
  const int steps = episode.steps();
  const auto per_step = static_cast<std::size_t>(rollout.points);
  const std::vector<int> actuators = actuators_of(mesh);
  values_.assign((static_cast<std::size_t>(steps) + 1) * cells_, none);
  if (what == Tint::stiffness) {
    const std::vector<double> factors = factors_of(rollout, mesh);
    const ModelObject& robot = mesh.objects.front();
    for (std::size_t k = 0; k < values_.size(); ++k) {
      const auto cell = static_cast<int>(k % cells_);
      if (cell >= robot.first_cell && cell < robot.first_cell + robot.cells)
        values_[k] = static_cast<float>(std::log10(factors[k % cells_]));
    }
    scale_ = {"stiffness (factor)", -1, 0, 1, true};
    return;
  }
  if (what != Tint::strain) check_actions(episode, actuators.size());
  std::optional<Stress> stress;
  if (what == Tint::stress) stress.emplace(rollout, mesh);
  for (int t = 0; t <= steps; ++t) {
    const auto now = std::span(values_).subspan(static_cast<std::size_t>(t) * cells_, cells_);
    const auto at = points.subspan(static_cast<std::size_t>(t) * per_step, per_step);
    if (what == Tint::strain) fill_strain(mesh, at, now);
    if (stress && t > 0) stress->follow(actions(episode, actuators.size(), t - 1));
    if (stress) stress->fill(at, now);
    for (std::size_t k = 0; what == Tint::commanded && k < actuators.size(); ++k)
      now[static_cast<std::size_t>(actuators[k])] =
          t == 0 ? 1.0F : static_cast<float>(actions(episode, actuators.size(), t - 1)[k]);
  }
  if (what == Tint::commanded) {
    scale_ = command_scale();
    return;
  }
  constexpr double least = 0.01;
  const double most = round_number_from(std::max(least, usual_extreme(values_)));
  scale_ = {what == Tint::strain ? "strain (area)" : "stress (weights per voxel)", -most, 0, most};
}

Vec2 outside_force(std::span<const Vec2> centres, int step, const Physics& physics) {
  constexpr int around = 2;  // steps before and after; single ones tremble
  const int last = static_cast<int>(centres.size()) - 1;
  const int from = std::max(1, step - around);
  const int to = std::min(last - 1, step + around);
  if (to < from || physics.gravity <= 0) return {};
  const auto at = [&](int t) { return centres[static_cast<std::size_t>(t)]; };
  const double seconds = physics.substep * physics.substeps;  // raw time of a step
  const double count = to - from + 1;
  // The means of the accelerations and of the velocities from `from` to `to`.
  const auto mean = [&](auto of) {
    const double first = of(at(from)) - of(at(from - 1));
    const double end = of(at(to + 1)) - of(at(to));
    const double acceleration = (end - first) / count / (seconds * seconds);
    const double velocity = (of(at(to + 1)) - of(at(from - 1))) / (count + 1) / seconds;
    return physics.voxel_length * (acceleration + physics.drag * velocity) / physics.gravity;
  };
  return {mean([](Vec2 p) { return p.x; }), 1 + mean([](Vec2 p) { return p.y; })};
}

}  // namespace evo::render
