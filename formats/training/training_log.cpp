#include "formats/training/training_log.h"

#include "formats/io/number.h"
#include "formats/io/text.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

constexpr const char* step_name = "charts/global_step";
constexpr const char* speed_name = "charts/SPS";
constexpr const char* evaluation_name = "eval/return";
constexpr const char* best_name = "eval/best";
constexpr std::string_view resumed_mark = "resumed";

}  // namespace

TrainingLog::TrainingLog(const std::filesystem::path& path) : out_(path, std::ios::app) {
  if (!out_) throw error(Failure::cannot_create, "{}: cannot be written", path.string());
}

void TrainingLog::begin(const std::string& tool, const std::string& task, bool resumed) {
  out_ << "# " << tool << ", " << task << (resumed ? ", " : "")
       << (resumed ? resumed_mark : std::string_view()) << std::endl;
}

void TrainingLog::line(const TrainingReport& report, double steps_per_second) {
  out_ << step_name << ' ' << report.step << '\t' << speed_name << ' '
       << fmt::format("{:.0f}", steps_per_second);
  for (const Metric& metric : report.metrics)
    out_ << '\t' << metric.name << ' ' << fmt::format("{:.6g}", metric.value);
  out_ << std::endl;
}

void TrainingLog::end(double seconds) {
  out_ << fmt::format("# trained in {:.2f} s\n", seconds) << std::flush;
}

std::optional<double> metric(const TrainingReport& report, const std::string& name) {
  for (const Metric& m : report.metrics)
    if (m.name == name) return m.value;
  return std::nullopt;
}

std::optional<double> logged(std::string_view line, std::string_view name) {
  for (const std::string_view pair : split(line, "\t"))
    if (pair.starts_with(name) && pair.size() > name.size() && pair[name.size()] == ' ')
      return number_in<double>(pair.substr(name.size() + 1));
  return std::nullopt;
}

LoggedTraining read_training_log(const std::filesystem::path& path) {
  LoggedTraining log;
  std::ifstream in(path);
  // A line being written has no end yet and is left for the next time.
  for (std::string line; std::getline(in, line) && !in.eof();) {
    if (line.starts_with('#')) {
      if (line.starts_with("# trained")) continue;
      if (!line.ends_with(resumed_mark)) log = {};
    } else if (const auto value = logged(line, evaluation_name)) {
      log.evaluations.push_back(*value);
      log.best = logged(line, best_name).value_or(*value);
      log.step = logged(line, step_name).value_or(0.0);
    }
  }
  return log;
}

}  // namespace evo
