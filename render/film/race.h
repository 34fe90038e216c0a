// Several episodes of one task in one world: robots with letters and outlines of one
// colour each, one camera for all of them, and who leads.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/painters/text.h"
#include "render/scene/clip.h"

namespace evo::render {

class Race {
 public:
  // A shorter episode stays at its end. Throws Error(usage) for fewer than two episodes,
  // more than letters, or several tasks.
  Race(const std::vector<Episode>& episodes, const RenderOptions& options);

  int steps() const { return static_cast<int>(views_.size()) - 1; }
  double steps_per_second() const { return clips_.front().steps_per_second(); }
  Drawing frame(double step, Typesetter& typesetter) const;

 private:
  struct Runner {
    std::string letter;
    Color color;
    std::string name;
    std::vector<double> returns;  // so far, by step
    std::optional<int> arrived;   // step at which it reached the finish
    int place = 0;                // at the end, from 1
    double so_far(double step) const;
  };
  void find_finish(const std::vector<Episode>& episodes);
  void rank();
  bool in_lanes(std::size_t runners) const;
  void draw_lane(std::size_t k, double step, const Rect& lane, Typesetter& typesetter,
                 Drawing& drawing) const;
  Rect ranking_plate(Typesetter& typesetter) const;
  void draw_ranking(double step, const Rect& plate, Drawing& drawing) const;

  RenderOptions options_;
  std::string task_;
  bool heights_ = false;  // count in the task
  std::vector<Runner> runners_;
  std::vector<Clip> clips_;       // of each runner
  std::vector<ViewRect> views_;   // of all of them, at every step
  std::optional<double> finish_;  // x, voxels, where the task has one
};

}  // namespace evo::render
