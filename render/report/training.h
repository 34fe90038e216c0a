// What is known of how one robot was trained: its policy file and its log.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/training/policy.h"

namespace evo::report {

// A number the trainer logged, against environment steps.
struct LogSeries {
  std::string name;  // "entropy"
  std::vector<std::pair<double, double>> points;
};

struct Training {
  std::vector<CurvePoint> curve;
  std::optional<FinalScore> final_score;
  std::int64_t best_step = 0;
  std::int64_t steps = 0;
  std::string created_by;  // tool, version, commit
  std::vector<LogSeries> log;
};

// From a policy that was read.
Training training_of(const PolicyFile& policy);

// Adds entropy, KL and explained variance from a log of evo-train, thinned to
// what can be told apart in a small chart. A log that is not there adds nothing.
void add_log(const std::filesystem::path& file, Training& training);

}  // namespace evo::report
