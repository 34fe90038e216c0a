#include "render/scene/clip.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/rollout/ending.h"
#include "libevo/base/error.h"
#include "libevo/base/join.h"
#include "libevo/task/contacts.h"
#include "render/scene/camera.h"

namespace evo::render {
namespace {

// What the rollout has of it. Throws Error(data, usage) where it has none.
const RolloutEpisode& recorded(const Episode& episode) {
  const auto& all = episode.rollout->episodes;
  if (all.empty()) throw Error(Failure::data, "the rollout has no episodes, so nothing to draw");
  if (episode.index < 0 || static_cast<std::size_t>(episode.index) >= all.size())
    throw error(Failure::usage, "there is no episode {}: the rollout has episodes 0 to {}",
                episode.index, all.size() - 1);
  return all[static_cast<std::size_t>(episode.index)];
}

void check_world(const Rollout& rollout) {
  const auto& [objects, cells] = rollout.world;
  if (cells.empty())
    throw Error(Failure::data,
                "the rollout does not say which points make which voxels (datasets cell_object, "
                "cell_type and cell_points of its group 'world'), so it cannot be drawn; record it "
                "with evo-eval --rollout");
  int points = 0;
  int first_cell = 0;
  for (const ModelObject& object : objects) {
    if (object.first_point != points || object.first_cell != first_cell)
      throw error(Failure::data,
                  "object '{}' of the rollout's world does not follow the one before", object.name);
    points += object.points;
    first_cell += object.cells;
  }
  if (points != rollout.points || static_cast<std::size_t>(first_cell) != cells.size())
    throw error(Failure::data,
                "the objects of the rollout's world have {} points and {} cells, the rollout {} "
                "and {}",
                points, first_cell, rollout.points, cells.size());
}

void check_positions(const Rollout& rollout, const RolloutEpisode& episode) {
  const auto per_step = static_cast<std::size_t>(rollout.points);
  const std::size_t expected = (episode.rewards.size() + 1) * per_step;
  if (episode.positions.size() != expected)
    throw error(Failure::data, "the episode has {} positions, {} steps of {} points need {}",
                episode.positions.size(), episode.rewards.size(), per_step, expected);
  constexpr double farthest = 1e6;  // raw length
  for (std::size_t k = 0; k < episode.positions.size(); ++k) {
    const Vec2& p = episode.positions[k];
    if (!(std::abs(p.x) < farthest && std::abs(p.y) < farthest))
      throw error(Failure::data, "point {} is at ({}, {}) in step {}, which cannot be drawn",
                  k % per_step, p.x, p.y, k / per_step);
  }
}

// Raw length of a voxel: cells start undeformed.
double voxel_length(const Rollout& rollout, const RolloutEpisode& episode) {
  double sum = 0;
  for (const ModelCell& cell : rollout.world.cells) {
    sum += distance(episode.positions[static_cast<std::size_t>(cell.points[0])],
                    episode.positions[static_cast<std::size_t>(cell.points[1])]);
  }
  const double length = sum / static_cast<double>(rollout.world.cells.size());
  if (length <= 0) throw Error(Failure::data, "the voxels of the rollout have no size");
  // Start positions may be jittered by a little; worlds are made on round numbers.
  constexpr double round_to = 1e-3;
  const double rounded = std::round(length / round_to) * round_to;
  return rounded > 0 && std::abs(rounded - length) < 0.01 * length ? rounded : length;
}

// What the task wants to be kept in view, or nothing.
std::vector<std::string> task_follow(const Rollout& rollout) {
  std::vector<std::string> names;
  const auto follow = task_value(rollout, "follow");
  if (follow && follow->is_sequence())
    for (const Node& name : follow->items()) names.push_back(name.string());
  return names;
}

std::vector<ModelObject> followed(const Rollout& rollout, const Mesh& mesh, const Camera& camera) {
  if (camera.mode == CameraMode::world) return mesh.objects;
  const std::vector<std::string> names =
      camera.objects.empty() ? task_follow(rollout) : camera.objects;
  std::vector<ModelObject> objects;
  for (const std::string& name : names) {
    const int object = mesh.object_index(name);
    if (object < 0) {
      std::vector<std::string> known;
      for (const ModelObject& each : mesh.objects) known.push_back(each.name);
      throw error(Failure::usage, "the camera cannot follow '{}': the objects are {}{}", name,
                  joined(known, ", "), did_you_mean(name, known));
    }
    objects.push_back(mesh.objects[static_cast<std::size_t>(object)]);
  }
  if (objects.empty()) objects = {mesh.objects.front()};  // the robot comes first in world order
  return objects;
}

Vec2 between(Vec2 a, Vec2 b, double share) { return a + (b - a) * share; }

// An arrow of a velocity ends where its point would be after that.
constexpr double velocity_seconds = 0.12;
// Length of the arrow of a force as large as the robot's weight, voxels.
constexpr double force_length = 2.5;

struct Moment {
  int step;      // the last whole step
  double share;  // of the way to the next
};

Moment split(double step, int steps) {
  const double clamped = std::clamp(step, 0.0, static_cast<double>(steps));
  const int whole = std::min(static_cast<int>(clamped), std::max(0, steps - 1));
  return {whole, clamped - whole};
}

// The last step that is over by then.
int finished(double step, int steps) {
  const auto [whole, share] = split(step, steps);
  return whole + (share >= 1.0 ? 1 : 0);
}

// `value` as wide as `widest`, so that the numbers of a video stand still.
std::string padded(int value, int widest) {
  constexpr const char* figure_space = "\u2007";
  std::string text = std::to_string(value);
  const std::size_t digits = text.size();
  for (std::size_t k = digits; k < std::to_string(widest).size(); ++k) text.insert(0, figure_space);
  return text;
}

std::string short_id(const std::string& id) { return id.substr(0, 12); }

}  // namespace

Clip::Clip(const Episode& episode, const RenderOptions& options, double aspect)
    : episode_(episode),
      overlays_(options.overlays),
      steps_per_second_(evo::steps_per_second(*episode.rollout)) {
  const Rollout& rollout = *episode.rollout;
  const RolloutEpisode& data = recorded(episode);
  check_world(rollout);
  check_positions(rollout, data);
  mesh_ = make_mesh(rollout.world);
  steps_ = data.steps();
  const double voxel = voxel_length(rollout, data);
  points_.reserve(data.positions.size());
  for (const Vec2& p : data.positions) points_.push_back(p / voxel);
  for (int t = 0; t <= steps_; ++t) centres_.push_back(mean(points(t, mesh_.objects.front())));
  goals_ = goals_by_step(rollout, data, centres_);
  heights_ = rewards_height(rollout);
  if (rewards_turning(rollout)) count_turns();
  if (const Ending end = ending(rollout, data); steps_ > 0 && end.kind != Ending::Kind::cut)
    ending_ = end.text;
  const Tint tint = overlays_.tint;
  if (tint != Tint::none && tint != Tint::actuation)
    value_scale_ = quantity_.emplace(tint, rollout, data, mesh_, points_).scale();
  if (overlays_.contacts) {
    physics_ = physics_of(rollout);
    for (const ModelObject& object : mesh_.objects) {
      std::vector<Vec2>& centres = object_centres_.emplace_back();
      for (int t = 0; !object.is_static && t <= steps_; ++t)
        centres.push_back(mean(points(t, object)));
    }
  }
  returns_.push_back(0);
  for (const double reward : data.rewards) returns_.push_back(returns_.back() + reward);
  views_ = camera_path(boxes(options.camera), options.camera, aspect);
}

Bounds Clip::extent(int step, const ModelObject& object) const {
  Bounds extent;
  for (const Vec2& p : points(step, object)) extent.add(p);
  return extent;
}

std::vector<Bounds> Clip::boxes(const Camera& camera) const {
  std::vector<Bounds> boxes(static_cast<std::size_t>(steps_) + 1);
  for (const ModelObject& object : followed(*episode_.rollout, mesh_, camera))
    for (int t = 0; t <= steps_; ++t)
      for (const Vec2& p : points(t, object)) boxes[static_cast<std::size_t>(t)].add(p);
  return boxes;
}

const Vec2* Clip::at(int step) const {
  return points_.data() +
         static_cast<std::ptrdiff_t>(step) * static_cast<std::ptrdiff_t>(episode_.rollout->points);
}

Scene Clip::scene(double step) const {
  const auto [whole, share] = split(step, steps_);
  const int next = std::min(whole + 1, steps_);
  Scene scene;
  scene.mesh = &mesh_;
  scene.points.reserve(static_cast<std::size_t>(episode_.rollout->points));
  for (int k = 0; k < episode_.rollout->points; ++k)
    scene.points.push_back(between(at(whole)[k], at(next)[k], share));
  scene.view = view_at(views_, step);
  scene.grid = overlays_.grid;
  scene.white = !overlays_.background;
  scene.edges = overlays_.edges;
  scene.voxels = overlays_.voxels;
  scene.fine_grid = overlays_.fine_grid;
  scene.tint = overlays_.tint == Tint::actuation;
  scene.heights = heights_;
  scene.values = values(whole + share);
  scene.value_scale = value_scale_;
  if (!goals_.empty()) {
    const auto now = static_cast<std::size_t>(finished(step, steps_));
    scene.goal = {{goals_[now].x, ground(goals_[now].x)}, goals_[now].x - centres_[now].x};
  }
  if (overlays_.trail) add_trail(whole + share, scene);
  if (overlays_.velocities) add_arrows(whole + share, scene);
  if (overlays_.contacts) add_contacts(whole + share, scene);
  return scene;
}

void Clip::add_trail(double step, Scene& scene) const {
  const auto [whole, share] = split(step, steps_);
  scene.trail.assign(centres_.begin(), centres_.begin() + whole + 1);
  if (share > 0)
    scene.trail.push_back(between(centres_[static_cast<std::size_t>(whole)],
                                  centres_[static_cast<std::size_t>(whole) + 1], share));
}

double Clip::ground(double x) const {
  double height = 0;
  for (const ModelObject& object : mesh_.objects) {
    if (!object.is_static) continue;
    for (int k = object.first_cell; k < object.first_cell + object.cells; ++k)
      for (const int point : mesh_.cells[static_cast<std::size_t>(k)].points)
        if (std::abs(at(0)[point].x - x) <= 1) height = std::max(height, at(0)[point].y);
  }
  return height;
}

// A difference of positions needs no unit of time and is what the eye sees.
Vec2 Clip::velocity(int step, int point) const {
  const int before = std::max(0, step - 1);
  const int after = std::min(steps_, before + 1);
  return (at(after)[point] - at(before)[point]) * steps_per_second_;
}

std::vector<float> Clip::values(double step) const {
  if (!quantity_) return {};
  const auto [whole, share] = split(step, steps_);
  const auto a = quantity_->values(whole);
  const auto b = quantity_->values(std::min(whole + 1, steps_));
  std::vector<float> values;
  for (std::size_t k = 0; k < a.size(); ++k)
    values.push_back(a[k] + (b[k] - a[k]) * static_cast<float>(share));
  return values;
}

std::span<const double> Clip::commands(int step) const {
  const RolloutEpisode& episode =
      episode_.rollout->episodes[static_cast<std::size_t>(episode_.index)];
  const auto count = static_cast<std::size_t>(std::max(0, episode_.rollout->action_length));
  if (episode.actions.size() != count * static_cast<std::size_t>(steps_)) return {};
  return std::span(episode.actions).subspan(static_cast<std::size_t>(step) * count, count);
}

// The force of the ground on the robot and on what it holds, from the middle of where
// they meet it.
void Clip::add_contacts(double step, Scene& scene) const {
  const auto [whole, share] = split(step, steps_);
  scene.force_length = force_length;
  Contacts contacts = contacts_of(mesh_.objects, mesh_.cells, scene.points);
  if (!contacts.ground.empty()) {
    Vec2 foot;
    for (const Vec2& p : contacts.ground) foot += p / static_cast<double>(contacts.ground.size());
    contacts.held.push_back(0);
    Vec2 force;
    for (const std::size_t k : contacts.held) {
      const auto centres = std::span(object_centres_[k]);
      const Vec2 own =
          between(outside_force(centres, whole, *physics_),
                  outside_force(centres, std::min(whole + 1, steps_), *physics_), share);
      const double weights = static_cast<double>(mesh_.objects[k].points) /
                             static_cast<double>(mesh_.objects.front().points);
      force += own * weights;
    }
    scene.arrows.push_back({foot, foot + force * force_length, true});
  }
  scene.touches = std::move(contacts.points);
}

void Clip::add_arrows(double step, Scene& scene) const {
  scene.velocity_length = velocity_seconds;
  const auto [whole, share] = split(step, steps_);
  for (const ModelObject& object : mesh_.objects) {
    if (object.is_static) continue;
    for (int k = object.first_point; k < object.first_point + object.points; ++k) {
      const Vec2 v = between(velocity(whole, k), velocity(whole + 1, k), share);
      const Vec2 from = scene.points[static_cast<std::size_t>(k)];
      scene.arrows.push_back({from, from + v * velocity_seconds});
    }
  }
}

// By the rotation that fits best from step to step, all points about their centre.
void Clip::count_turns() {
  const ModelObject& robot = mesh_.objects.front();
  double angle = 0;
  turns_.push_back(0);
  for (int t = 0; t < steps_; ++t) {
    const auto before = points(t, robot);
    const auto after = points(t + 1, robot);
    double cosine = 0;
    double sine = 0;
    for (std::size_t k = 0; k < before.size(); ++k) {
      const Vec2 p = before[k] - centre(t);
      const Vec2 q = after[k] - centre(t + 1);
      cosine += dot(p, q);
      sine += cross(p, q);
    }
    angle += std::atan2(sine, cosine);
    turns_.push_back(angle / (2 * std::numbers::pi));
  }
}

std::string Clip::turns(double step) const {
  if (turns_.empty()) return {};
  return fmt::format("{:.1f} turns", turns_[static_cast<std::size_t>(finished(step, steps_))]);
}

std::string signed_score(double value) {
  return fmt::format("{}{:.3f}", value < 0 ? "\u2212" : "+", std::abs(value));
}

double Clip::score(double step) const {
  return returns_[static_cast<std::size_t>(finished(step, steps_))];
}

Caption Clip::caption(double step) const {
  const int shown = finished(step, steps_);
  Caption caption;
  caption.title = episode_.rollout->task;
  caption.detail = !episode_.label.empty()   ? episode_.label
                   : episode_.rollout->robot ? short_id(episode_.rollout->robot->id)
                                             : std::string();
  caption.brief = episode_.label.empty() ? caption.title : episode_.label;
  if (steps_ == 0) return caption;  // a world at rest
  caption.moment =
      fmt::format("step {} / {}   {:.2f} s", padded(shown, steps_), steps_, seconds(shown));
  caption.score = "return " + signed_score(score(step));
  if (shown == steps_) caption.ending = ending_;
  caption.goal = turns(step);
  if (!goals_.empty()) {
    const auto now = static_cast<std::size_t>(shown);
    const double away = goals_[now].x - centres_[now].x;
    caption.goal = fmt::format("{} {} reached", goals_[now].reached,
                               goals_[now].reached == 1 ? "goal" : "goals");
    if (shown < steps_)
      caption.goal += fmt::format(", next {:.1f} voxels to the {}", std::abs(away),
                                  away < 0 ? "left" : "right");
  }
  return caption;
}

ViewRect view_at(const std::vector<ViewRect>& path, double step) {
  const auto [whole, share] = split(step, static_cast<int>(path.size()) - 1);
  const ViewRect& a = path[static_cast<std::size_t>(whole)];
  const ViewRect& b = path[std::min(static_cast<std::size_t>(whole) + 1, path.size() - 1)];
  const Vec2 centre = between({a.centre_x, a.centre_y}, {b.centre_x, b.centre_y}, share);
  const Vec2 extent = between({a.width, a.height}, {b.width, b.height}, share);
  return {centre.x, centre.y, extent.x, extent.y};
}

std::vector<double> timeline(const RenderOptions& options, int steps, double rate) {
  const int last = std::min(options.to.value_or(steps), steps);
  if (options.from > last)
    throw error(Failure::usage,
                "--steps: there are none from {} to {}: the episode has steps 0 to {}",
                options.from, last, steps);
  const double stride = options.speed * rate / options.fps;
  constexpr double close = 1e-9;
  std::vector<double> shown;
  for (std::size_t k = 0;; ++k) {
    const double step = options.from + static_cast<double>(k) * stride;
    if (step > last - close) break;
    shown.push_back(step);
  }
  shown.push_back(last);
  return shown;
}

}  // namespace evo::render
