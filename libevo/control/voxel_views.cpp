#include "libevo/control/voxel_views.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "libevo/body/extent.h"
#include "libevo/sim/model.h"

namespace evo {
namespace {

constexpr int materials = 5;  // of a voxel that is not empty

// A share of what the benchmark's bodies, 5 x 5, have at most.
float share_of_five(int count) { return static_cast<float>(count) / 5.0F; }

// [V x fixed_length], as the header lists them.
Matrix fixed_views(const Body& body) {
  const Extent frame = extent(body);
  const int voxels = count_voxels(body);
  std::array<int, materials> counts{};
  const auto material = [](Voxel voxel) { return static_cast<int>(voxel) - 1; };
  for (const Voxel voxel : body.cells)
    if (voxel != Voxel::empty) ++counts[static_cast<std::size_t>(material(voxel))];

  Matrix views = Matrix::Zero(voxels, VoxelViews::fixed_length);
  Eigen::Index v = 0;
  for (int row = 0; row < body.rows; ++row)
    for (int col = 0; col < body.cols; ++col) {
      if (body.at(row, col) == Voxel::empty) continue;
      Eigen::Index next = 0;
      for (int r = row - 1; r <= row + 1; ++r)
        for (int c = col - 1; c <= col + 1; ++c, next += materials) {
          const bool inside = r >= 0 && r < body.rows && c >= 0 && c < body.cols;
          if (inside && body.at(r, c) != Voxel::empty)
            views(v, next + material(body.at(r, c))) = 1.0F;
        }
      views(v, next++) = 0.5F * static_cast<float>(2 * col - frame.left - frame.right);
      views(v, next++) = 0.5F * static_cast<float>(frame.top + frame.bottom - 2 * row);
      for (const int count : counts)
        views(v, next++) = static_cast<float>(count) / static_cast<float>(voxels);
      views(v, next++) = share_of_five(voxels) / 5.0F;
      views(v, next++) = share_of_five(frame.cols());
      views(v, next++) = share_of_five(frame.rows());
      ++v;
    }
  return views;
}

// All objects but the robot, which is the first.
Terrain ground_of(const Arena& arena) {
  std::vector<int> objects(arena.model().objects().size() - 1);
  std::iota(objects.begin(), objects.end(), 1);
  std::vector<int> drawn;
  for (const int object : objects) {
    const Placement& placement = arena.task().objects[static_cast<std::size_t>(object - 1)];
    if (!placement.offset_x.empty() || !placement.offset_y.empty()) drawn.push_back(object);
  }
  return {arena.model(), objects, drawn};
}

}  // namespace

VoxelViews::VoxelViews(const Arena& arena)
    : points_(arena.model().objects().front().points),
      voxel_length_(arena.task().physics.voxel_length),
      ground_(ground_of(arena)),
      fixed_(fixed_views(arena.robot())) {
  const Model& model = arena.model();
  const ModelObject& robot = model.objects().front();
  for (int c = robot.first_cell; c < robot.first_cell + robot.cells; ++c) {
    const ModelCell& cell = model.cells()[static_cast<std::size_t>(c)];
    if (is_actuator(cell.type)) actuators_.push_back(static_cast<int>(cells_.size()));
    cells_.push_back(cell.points);
  }

  const std::string points = part_name(observation::RelativePositions{robot_name});
  for (const ObservationSlice& slice : arena.layout()) {
    if (slice.name == points) continue;
    task_.push_back(slice);
    task_length_ += slice.length;
  }
}

void VoxelViews::look(const VecEnv& env, int environment, std::span<double> local,
                      std::span<double> task) const {
  const auto count = static_cast<std::size_t>(points_);
  const auto positions = env.positions(environment).first(count);
  const auto velocities = env.velocities(environment).first(count);
  const Vec2 centre = mean(positions);
  const Vec2 drift = mean(velocities);
  // Looked for from above each point: one that touches the ground is a little below it.
  constexpr double sunk = 0.5;
  std::vector<double> heights(count);
  for (std::size_t p = 0; p < count; ++p) {
    const Vec2 from{positions[p].x / voxel_length_, positions[p].y / voxel_length_ + sunk};
    ground_.clearance(Terrain::Side::below, from, 1.0 + sunk, env.positions(environment),
                      {&heights[p], 1});
    heights[p] = heights[p] / voxel_length_ - sunk;
  }
  std::size_t next = 0;
  for (const std::array<int, 4>& cell : cells_) {
    const auto corner = [&](std::size_t k) { return static_cast<std::size_t>(cell[k]); };
    for (std::size_t k = 0; k < 4; ++k) {
      local[next++] = (positions[corner(k)].x - centre.x) / voxel_length_;
      local[next++] = (positions[corner(k)].y - centre.y) / voxel_length_;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      local[next++] = velocities[corner(k)].x - drift.x;
      local[next++] = velocities[corner(k)].y - drift.y;
    }
    const auto stretch = [&](std::size_t i, std::size_t j, double rest) {
      const Vec2& a = positions[corner(i)];
      const Vec2& b = positions[corner(j)];
      const double dx = b.x - a.x;
      const double dy = b.y - a.y;
      local[next++] = std::sqrt(dx * dx + dy * dy) / (rest * voxel_length_) - 1.0;
    };
    stretch(0, 1, 1.0);
    stretch(2, 3, 1.0);
    stretch(0, 2, 1.0);
    stretch(1, 3, 1.0);
    stretch(0, 3, std::numbers::sqrt2);
    stretch(2, 1, std::numbers::sqrt2);
    for (std::size_t k = 0; k < 4; ++k) local[next++] = heights[corner(k)];
  }
  const std::span<const double> observation =
      env.observations().subspan(env.observation_offset(environment));
  next = 0;
  for (const ObservationSlice& slice : task_)
    for (int i = 0; i < slice.length; ++i)
      task[next++] = observation[static_cast<std::size_t>(slice.offset + i)];
}

}  // namespace evo
