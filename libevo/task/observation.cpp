// Observation parts: for each its length, its words in the layout, and what it
// writes. See docs/tasks.md, "Orientation" and "Floor and ceiling".
#include <fmt/format.h>

#include "libevo/task/binder.h"

namespace evo {
namespace {

using compiled::Part;
using compiled::View;
using compiled::ViewSlopes;

// ---- motion and shape -------------------------------------------------------------

int length(const observation::Velocity&, int /*points*/) { return 2; }
std::string arguments(const observation::Velocity& part) { return part.of; }
Part bind_one(const observation::Velocity& part, Binder& bind) {
  const PointRange points = bind.points(part.of);
  return {[points](const View& view, std::span<double> out) {
            const Vec2 v = mean(points.of(view.now.velocities));
            out[0] = v.x;
            out[1] = v.y;
          },
          [points](const View&, std::span<const double> by, ViewSlopes& slopes) {
            pull_back_mean({by[0], by[1]}, points.of(slopes.velocities));
          }};
}

int length(const observation::Orientation&, int) { return 1; }
std::string arguments(const observation::Orientation& part) { return part.of; }
Part bind_one(const observation::Orientation& part, Binder& bind) {
  const std::size_t angle = bind.orientation(part.of);
  return {[angle](const View& view, std::span<double> out) { out[0] = view.quantities[angle]; },
          [angle](const View&, std::span<const double> by, ViewSlopes& slopes) {
            slopes.quantities[angle] += by[0];
          }};
}

int length(const observation::RelativePositions&, int points) { return 2 * points; }
std::string arguments(const observation::RelativePositions& part) { return part.of; }
Part bind_one(const observation::RelativePositions& part, Binder& bind) {
  const PointRange range = bind.points(part.of);
  const std::size_t centre = bind.centre(part.of);
  return {[range, centre, voxel = bind.voxel_length()](const View& view, std::span<double> out) {
            const auto points = range.of(view.now.positions);
            const double x = view.quantities[centre + raw_x];
            const double y = view.quantities[centre + raw_y];
            for (std::size_t i = 0; i < points.size(); ++i) {
              out[i] = points[i].x / voxel * voxel - x;
              out[points.size() + i] = points[i].y / voxel * voxel - y;
            }
          },
          [range, centre](const View&, std::span<const double> by, ViewSlopes& slopes) {
            const auto by_points = range.of(slopes.positions);
            const std::size_t n = by_points.size();
            for (std::size_t i = 0; i < n; ++i) {
              by_points[i].x += by[i];
              by_points[i].y += by[n + i];
              slopes.quantities[centre + raw_x] -= by[i];
              slopes.quantities[centre + raw_y] -= by[n + i];
            }
          }};
}

int length(const observation::Offset&, int) { return 2; }
std::string arguments(const observation::Offset& part) {
  return fmt::format("{} from {}", part.of, part.from);
}
Part bind_one(const observation::Offset& part, Binder& bind) {
  const std::size_t of = bind.centre(part.of);
  const std::size_t from = bind.centre(part.from);
  return {[of, from](const View& view, std::span<double> out) {
            for (const std::size_t axis : {raw_x, raw_y})
              out[axis] = view.quantities[of + axis] - view.quantities[from + axis];
          },
          [of, from](const View&, std::span<const double> by, ViewSlopes& slopes) {
            for (const std::size_t axis : {raw_x, raw_y}) {
              slopes.quantities[of + axis] += by[axis];
              slopes.quantities[from + axis] -= by[axis];
            }
          }};
}

// ---- clearance from terrain ---------------------------------------------------------

template <typename Clearance>
Part bind_clearance(const Clearance& part, Terrain::Side side, Binder& bind) {
  const std::size_t terrain = bind.terrain(part.over);
  const std::size_t robot = bind.centre(robot_name);
  const auto centre = [robot](const View& view) {
    return Vec2{view.quantities[robot + voxel_x], view.quantities[robot + voxel_y]};
  };
  return {
      [=, range = part.range](const View& view, std::span<double> out) {
        view.terrains[terrain].clearance(side, centre(view), range, view.now.positions, out);
      },
      [=, range = part.range](const View& view, std::span<const double> by, ViewSlopes& slopes) {
        slopes.quantities[robot + voxel_y] += view.terrains[terrain].pull_back(
            side, centre(view), range, view.now.positions, by, slopes.positions);
      }};
}

int length(const observation::Floor& part, int) { return 2 * part.width + 1; }
std::string arguments(const observation::Floor& part) { return fmt::format("{}", part.width); }
Part bind_one(const observation::Floor& part, Binder& bind) {
  return bind_clearance(part, Terrain::Side::below, bind);
}

int length(const observation::Ceiling& part, int) { return 2 * part.width + 1; }
std::string arguments(const observation::Ceiling& part) { return fmt::format("{}", part.width); }
Part bind_one(const observation::Ceiling& part, Binder& bind) {
  return bind_clearance(part, Terrain::Side::above, bind);
}

// ---- goals ----------------------------------------------------------------------------

int length(const observation::GoalIndex&, int) { return 1; }
std::string arguments(const observation::GoalIndex&) { return ""; }
Part bind_one(const observation::GoalIndex& part, Binder& bind) {
  bind.need_goals(part.name);
  return {[](const View& view, std::span<double> out) { out[0] = view.episode.goal; }, {}};
}

int length(const observation::GoalPosition&, int) { return 1; }
std::string arguments(const observation::GoalPosition&) { return ""; }
Part bind_one(const observation::GoalPosition& part, Binder& bind) {
  bind.need_goals(part.name);
  return {[voxel = bind.voxel_length()](const View& view, std::span<double> out) {
            out[0] = current_goal(view.episode, voxel);
          },
          {}};
}

int length(const observation::GoalOffset&, int) { return 1; }
std::string arguments(const observation::GoalOffset&) { return ""; }
Part bind_one(const observation::GoalOffset& part, Binder& bind) {
  bind.need_goals(part.name);
  const std::size_t robot = bind.centre(robot_name, Axis::x);
  return {[robot, voxel = bind.voxel_length()](const View& view, std::span<double> out) {
            out[0] = current_goal(view.episode, voxel) - view.quantities[robot];
          },
          [robot](const View&, std::span<const double> by, ViewSlopes& slopes) {
            slopes.quantities[robot] -= by[0];
          }};
}

}  // namespace

// ---- any of them ------------------------------------------------------------------------

compiled::Part bind_part(const ObservationPart& part, Binder& bind) {
  return std::visit([&](const auto& p) { return bind_one(p, bind); }, part);
}

std::string part_name(const ObservationPart& part) {
  return std::visit(
      [](const auto& p) {
        const std::string in_brackets = arguments(p);
        return in_brackets.empty() ? std::string(p.name)
                                   : fmt::format("{}({})", p.name, in_brackets);
      },
      part);
}

int part_length(const ObservationPart& part, int points) {
  return std::visit([&](const auto& p) { return length(p, points); }, part);
}

std::string part_object(const ObservationPart& part) {
  return std::visit(
      [](const auto& p) -> std::string {
        if constexpr (requires { p.of; })
          return p.of;
        else
          return "";
      },
      part);
}

}  // namespace evo
