#include "render/report/training.h"

#include <map>
#include <sstream>

#include "formats/io/files.h"
#include "formats/training/training_log.h"
#include "render/report/choice.h"

namespace evo::report {
namespace {

constexpr std::size_t most_points = 60;  // of a curve

}  // namespace

Training training_of(const PolicyFile& policy) {
  Training training;
  training.curve = spread(policy.curve, most_points);
  training.final_score = policy.final_score;
  training.best_step = policy.best_step;
  training.steps = policy.steps;
  training.created_by = policy.created_by;
  return training;
}

void add_log(const std::filesystem::path& file, Training& training) {
  if (!std::filesystem::is_regular_file(file)) return;
  const std::map<std::string, std::string> wanted{
      {"losses/entropy", "entropy"},
      {"losses/approx_kl", "KL divergence"},
      {"losses/explained_variance", "explained variance"}};
  std::map<std::string, std::vector<std::pair<double, double>>> series;
  std::istringstream lines(read_file(file));
  for (std::string line; std::getline(lines, line);)
    if (const auto step = logged(line, "charts/global_step"))
      for (const auto& [key, name] : wanted)
        if (const auto value = logged(line, key)) series[name].emplace_back(*step, *value);
  for (const auto& [key, name] : wanted)
    if (!series[name].empty()) training.log.push_back({name, spread(series[name], most_points)});
}

}  // namespace evo::report
