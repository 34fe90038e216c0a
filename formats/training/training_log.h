// The text log of a training, ID.log: what its learner says of itself at every
// evaluation, with wall-clock figures, which are kept out of the policy file so
// that the same training is the same file.
//
//   # evo-train 0.1.0, Walker-v0
//   charts/global_step 10240<TAB>charts/SPS 45000<TAB>eval/return 0.31<TAB>...
//
// Lines of names and numbers; lines with # are remarks for people. Every start of
// the training adds a remark, one that continues from a checkpoint ends in
// "resumed".
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libevo/control/trainer.h"

namespace evo {

class TrainingLog {
 public:
  // Appends. Throws Error(cannot_create).
  explicit TrainingLog(const std::filesystem::path& path);

  void begin(const std::string& tool, const std::string& task, bool resumed);
  void line(const TrainingReport& report, double steps_per_second);
  void end(double seconds);

 private:
  std::ofstream out_;
};

// The value of a metric of a report, where it has it.
std::optional<double> metric(const TrainingReport& report, const std::string& name);

// What a line of a log says of `name`.
std::optional<double> logged(std::string_view line, std::string_view name);

// The last training in a log, as far as it has come.
struct LoggedTraining {
  double step = 0.0;                // environment steps
  std::vector<double> evaluations;  // in order
  double best = 0.0;                // of them
};

// Where the log is missing, nothing is done yet.
LoggedTraining read_training_log(const std::filesystem::path& path);

}  // namespace evo
