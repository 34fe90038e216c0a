#include "render/report/training.h"

#include <cstdlib>
#include <map>
#include <sstream>

#include "formats/io/files.h"
#include "formats/io/number.h"
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

// A line an update: "name value<tab>name value<tab>..".
void add_log(const std::filesystem::path& file, Training& training) {
  if (!std::filesystem::is_regular_file(file)) return;
  const std::map<std::string, std::string> wanted{
      {"losses/entropy", "entropy"},
      {"losses/approx_kl", "KL divergence"},
      {"losses/explained_variance", "explained variance"}};
  std::map<std::string, std::vector<std::pair<double, double>>> series;
  std::istringstream lines(read_file(file));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::map<std::string, double> values;
    for (std::string field; std::getline(fields, field, '\t');)
      if (const std::size_t space = field.find(' '); space != std::string::npos)
        values[field.substr(0, space)] =
            number_in<double>(std::string_view(field).substr(space + 1)).value_or(0.0);
    const auto step = values.find("charts/global_step");
    if (step == values.end()) continue;
    for (const auto& [key, name] : wanted)
      if (const auto value = values.find(key); value != values.end())
        series[name].emplace_back(step->second, value->second);
  }
  for (const auto& [key, name] : wanted)
    if (!series[name].empty()) training.log.push_back({name, spread(series[name], most_points)});
}

}  // namespace evo::report
