// A run folder (spec: formats, "Run folder") as far as it has come, in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/report/film.h"
#include "formats/robot.h"
#include "libevo/control/trainer.h"

namespace evo::report {

// One line of run.yaml. Folders are cut off values that are paths, so that a page
// says nothing about the machine it was made on.
struct Setting {
  std::string name;
  std::string value;
};

// A trained robot, where it was scored first.
struct Entry {
  Robot robot;
  int generation = 0;
  std::optional<double> fitness;  // nothing: its training failed
  std::string failure;            // why, if it did
};

struct Generation {
  int number = 0;
  std::vector<std::size_t> members;  // in Run::robots, by slot; survivors are there again
  std::size_t planned = 0;           // robots of the population, trained or not
};

struct Video {
  std::string media_type;  // "video/mp4", "image/gif", ...
  std::string bytes;
};

struct Run {
  std::string label;  // the folder's name
  std::vector<Setting> settings;
  std::vector<Entry> robots;  // in the order they were trained
  std::map<std::string, std::size_t> by_id;
  std::vector<Generation> generations;

  // The fittest robot, the first of equals, and what there is of it.
  std::optional<std::size_t> champion;
  std::vector<CurvePoint> curve;  // of its training
  std::optional<FinalScore> final_score;
  std::optional<Film> film;
  std::optional<Video> video;
  double video_left_out = 0.0;  // bytes of a video that is larger than allowed

  // A setting's value; empty where run.yaml has none.
  std::string setting(const std::string& name) const;
  // The number of robots this run is to train, if run.yaml says so.
  std::optional<std::size_t> evaluations() const;
  // Robots whose training failed.
  std::size_t failures() const;
};

// Finished or not. A video of more than `largest_video` bytes is left out.
// Throws Error(no_input) for a folder that is not there, Error(data) for one that
// is no run or has a damaged file.
Run read_run(const std::filesystem::path& folder, double largest_video);

// Gives runs whose folders have the same name that of the folder above, too, and
// numbers where that is not enough.
void tell_apart(std::vector<Run>& runs, const std::vector<std::filesystem::path>& folders);

// "train=profiles/fast.yaml" as "train=fast.yaml".
std::string without_folders(const std::string& text);

}  // namespace evo::report
