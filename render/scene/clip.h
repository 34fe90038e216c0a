// An episode made ready for drawing: shapes, camera and captions at any step.
#pragma once

#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <vector>

#include "formats/rollout/rollout.h"
#include "libevo/task/bounds.h"
#include "libevo/task/measure.h"
#include "render/scene/goals.h"
#include "render/scene/quantity.h"
#include "render/scene/scene.h"

namespace evo::render {

// What to show: an episode of a rollout that outlives this.
struct Episode {
  const Rollout* rollout = nullptr;
  int index = 0;
  std::string label;  // of its panel, when several are shown; else the robot's id
};

// Everything about the text of a frame.
struct Caption {
  std::string title;   // the task
  std::string detail;  // the robot, or the label
  std::string brief;   // the one of both to show where there is room for one
  std::string moment;  // step and time
  std::string score;   // return so far
  std::string goal;    // goals reached, and how far the next one is; turns that count
  std::string ending;  // why the episode is over, once it is
};

// "+1.250", "−0.004": as wide for either sign.
std::string signed_score(double value);

class Clip {
 public:
  // `aspect`: width to height of the picture. Throws Error(usage) for an episode
  // out of range or an unknown object to follow, Error(data) for a rollout that
  // cannot be drawn, saying what it lacks.
  Clip(const Episode& episode, const RenderOptions& options, double aspect);

  int steps() const { return steps_; }
  double seconds(double steps) const { return steps / steps_per_second_; }
  double steps_per_second() const { return steps_per_second_; }
  // Between two steps, shapes are in between, too. Steps outside of the episode
  // show its nearest end.
  Scene scene(double step) const;
  Caption caption(double step) const;
  double score(double step) const;  // return so far
  // "2.3 turns" that the robot has made by then, where the task rewards turning; else empty.
  std::string turns(double step) const;
  // Commanded lengths of all actuators in a step from 0; empty where the file has none.
  std::span<const double> commands(int step) const;
  // The episode's last step ended it, rather than the recording.
  bool over() const { return !ending_.empty(); }
  // Values of cells, as Scene has them; empty unless `tint` asks for them.
  std::vector<float> values(double step) const;
  // Their colours; those of the episode alone at first.
  const ValueScale& value_scale() const { return value_scale_; }
  void value_scale(const ValueScale& scale) { value_scale_ = scale; }

  const Mesh& mesh() const { return mesh_; }
  // Places of all points, of an object's, or of the first one's centre, at a whole step; voxels.
  std::span<const Vec2> points(int step) const {
    return {at(step), static_cast<std::size_t>(episode_.rollout->points)};
  }
  std::span<const Vec2> points(int step, const ModelObject& object) const {
    return PointRange{object.first_point, object.points}.of(points(step));
  }
  Bounds extent(int step, const ModelObject& object) const;
  // Around what a camera keeps in view, at every step. Throws Error(usage) for an unknown object.
  std::vector<Bounds> boxes(const Camera& camera) const;
  Vec2 centre(int step) const { return centres_[static_cast<std::size_t>(step)]; }

 private:
  const Vec2* at(int step) const;
  void count_turns();
  void add_trail(double step, Scene& scene) const;
  void add_arrows(double step, Scene& scene) const;
  void add_contacts(double step, Scene& scene) const;
  double ground(double x) const;             // height of what stands still there
  Vec2 velocity(int step, int point) const;  // voxels per second of video

  Episode episode_;
  Overlays overlays_;
  Mesh mesh_;
  int steps_ = 0;
  double steps_per_second_;    // at speed 1
  std::vector<Vec2> points_;   // [(steps+1) x points], voxels
  std::vector<Vec2> centres_;  // of the first object
  std::vector<double> returns_;
  std::vector<ViewRect> views_;
  std::vector<GoalOfStep> goals_;  // at every step, if there are any
  std::vector<double> turns_;      // at every step, if they count
  bool heights_ = false;           // count in the task
  std::string ending_;             // empty for a recording that was cut
  std::optional<Quantity> quantity_;
  ValueScale value_scale_;
  std::optional<Physics> physics_;  // for forces, and centres of all objects that move
  std::vector<std::vector<Vec2>> object_centres_;
};

// One colour is the same value in all of them.
template <std::ranges::forward_range Clips>
void share_value_scale(Clips&& clips) {
  ValueScale shared = (*std::ranges::begin(clips)).value_scale();
  for (const Clip& clip : clips) shared = widest(shared, clip.value_scale());
  for (Clip& clip : clips) clip.value_scale(shared);
}

// Between two steps, the view is in between, too.
ViewRect view_at(const std::vector<ViewRect>& path, double step);

// The steps that the frames of a video show of an episode of `steps` steps, `rate` per second
// at speed 1; the last one is always among them. Throws Error(usage) for an empty range.
std::vector<double> timeline(const RenderOptions& options, int steps, double rate);

}  // namespace evo::render
