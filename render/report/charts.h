// What a run's figures show: on the page, and as files (figures.h).
#pragma once

#include <string>
#include <vector>

#include "render/figures/chart.h"
#include "render/report/run.h"

namespace evo::report {

// Figures that belong together; one alone has title and text of its own.
struct FigureGroup {
  std::string id;
  std::string title;
  std::string about;
  std::vector<render::Figure> figures;
};

// The figures of a run with a champion, in the order of its page; those that would say nothing are
// left out:
//   curve        the best so far, and every robot
//   archive      of a run that keeps one: its elites, and coverage and QD score by robots
//   generations  best and median; the median of those that were new: survivors, the better half,
//                thin out as a run grows, and would make it jump
//   controller   how the one of all robots learnt
//   tree, learning, body: every robot by its parents, its training, numbers of its body
//   maps, voxels: where evolution looked, and what goes with fitness
// With many robots the tree has those with children, and learning curves are of some.
// Throws Error(data) for axes of an archive that are none.
std::vector<FigureGroup> figures(const Run& run);

// Best so far of several runs on one task. Runs that differ in nothing but their seed give one
// curve, their median with its range (quartiles of many), and each a pale one.
render::Figure comparison_figure(const std::string& task, const std::vector<const Run*>& runs);

}  // namespace evo::report
