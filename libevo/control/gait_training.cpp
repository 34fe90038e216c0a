#include "libevo/control/gait_training.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

// A point of either stage is scaled so that a step of 1 matters about the same
// in every coordinate.
constexpr double amplitude_scale = 0.3;  // share of the rest length
constexpr double initial_amplitude = 0.4;
constexpr double middle_scale = 0.15;  // share of the rest length
constexpr double phase_scale = 2.0;    // radian
constexpr double vector_scale = 1.0;   // of wave vectors, radian a cell
constexpr double period_scale = 0.7;   // of the period's logarithm
// Step sizes at the start of the stages.
constexpr double wave_sigma = 1.0;
constexpr double actuator_sigma = 0.15;

// Coordinates of a wave.
enum Wave { across, up, amplitude_h, amplitude_v, middle_h, middle_v, lag, pace, wave_length };

}  // namespace

std::int64_t generation_cost(const TrainingJob& job) {
  return std::int64_t{job.settings.population} * job.settings.evaluation_episodes *
         job.arena().task().episode_steps;
}

GaitTraining::GaitTraining(const TrainingJob& job)
    : settings_(job.settings),
      wave_generations_(std::max<std::int64_t>(
          1,
          static_cast<std::int64_t>(settings_.wave_share *
                                    static_cast<double>(settings_.steps / generation_cost(job))))),
      random_(job.seed, "train/search", job.robot_id),
      strategy_(std::vector<double>(wave_length, 0.0), wave_sigma, settings_.population),
      start_(inherited_gait(job)) {
  if (generation_cost(job) > settings_.steps)
    throw error(Failure::usage,
                "training: {} steps are less than one generation of {} episodes of {} steps",
                settings_.steps, std::int64_t{settings_.population} * settings_.evaluation_episodes,
                job.arena().task().episode_steps);
  const Body& robot = job.arena().robot();
  for (int row = 0; row < robot.rows; ++row)
    for (int col = 0; col < robot.cols; ++col)
      if (is_actuator(robot.at(row, col)))
        actuators_.push_back({col - 0.5 * (robot.cols - 1), 0.5 * (robot.rows - 1) - row,
                              robot.at(row, col) == Voxel::vertical});
  if (start_) begin_second_stage(*start_);
}

bool GaitTraining::done(const TrainingJob& job, const TrainResult& result) const {
  return result.steps + generation_cost(job) > job.settings.steps;
}

// The best of a generation is an evaluation.
GaitTraining::Generation GaitTraining::advance(const TrainingJob& job, TrainResult& result,
                                               Metrics& metrics) {
  const std::vector<SineController> gaits = ask();
  const OpenLoopEvaluation tried = evaluate_each(job.arena(), gaits, job.evaluation());
  result.steps += tried.steps;
  const auto best = std::max_element(tried.means.begin(), tried.means.end());
  const SineController& gait = gaits[static_cast<std::size_t>(best - tried.means.begin())];
  result.evaluated(*best, gait);
  tell(tried.means);
  metrics.push_back({"charts/episodic_return", mean(tried.means)});
  metrics.push_back({"charts/sigma", strategy_.sigma()});
  report_evaluation(result, metrics);
  return {*best, gait};
}

// ---- points ---------------------------------------------------------------------------

double GaitTraining::period(double x) const {
  const double middle = math::sqrt(settings_.shortest_period * settings_.longest_period);
  return std::clamp(middle * math::exp(period_scale * x), settings_.shortest_period,
                    settings_.longest_period);
}

SineController GaitTraining::decode_wave(const std::vector<double>& x) const {
  SineController gait;
  gait.period = period(x[pace]);
  for (const Actuator& a : actuators_) {
    gait.amplitude.push_back(initial_amplitude +
                             amplitude_scale * x[a.vertical ? amplitude_v : amplitude_h]);
    gait.shift.push_back(middle_scale * x[a.vertical ? middle_v : middle_h]);
    gait.phase.push_back(vector_scale * (x[across] * a.x + x[up] * a.y) +
                         (a.vertical ? phase_scale * x[lag] : 0.0));
  }
  return gait;
}

SineController GaitTraining::decode(const std::vector<double>& x) const {
  const std::size_t n = actuators_.size();
  SineController gait;
  gait.period = period(x[3 * n]);
  for (std::size_t i = 0; i < n; ++i) {
    gait.amplitude.push_back(initial_amplitude + amplitude_scale * x[i]);
    gait.phase.push_back(phase_scale * x[n + i]);
    gait.shift.push_back(middle_scale * x[2 * n + i]);
  }
  return gait;
}

void GaitTraining::begin_second_stage(const SineController& from) {
  std::vector<double> mean;
  for (const double a : from.amplitude) mean.push_back((a - initial_amplitude) / amplitude_scale);
  for (const double p : from.phase) mean.push_back(p / phase_scale);
  for (std::size_t i = 0; i < from.amplitude.size(); ++i) {
    const double shift = from.shift.empty() ? 0.0 : from.shift[i];
    mean.push_back((from.middle + shift - SineController{}.middle) / middle_scale);
  }
  const double middle = math::sqrt(settings_.shortest_period * settings_.longest_period);
  mean.push_back(math::log(from.period / middle) / period_scale);
  strategy_ = EvolutionStrategy(std::move(mean), actuator_sigma, settings_.population);
  second_stage_ = true;
}

std::vector<SineController> GaitTraining::ask() {
  if (!second_stage_ && generation_ >= wave_generations_) begin_second_stage(decode_wave(best_));
  points_ = strategy_.ask(random_);
  if (start_ && generation_ == 0) points_.front() = strategy_.mean();
  std::vector<SineController> gaits;
  for (const auto& x : points_) gaits.push_back(second_stage_ ? decode(x) : decode_wave(x));
  if (start_ && generation_ == 0) gaits.front() = *start_;  // to the last bit
  return gaits;
}

void GaitTraining::tell(std::span<const double> returns) {
  strategy_.tell(points_, returns);
  const auto best = std::max_element(returns.begin(), returns.end());
  if (!second_stage_ && (best_.empty() || *best > best_return_)) {
    best_ = points_[static_cast<std::size_t>(best - returns.begin())];
    best_return_ = *best;
  }
  ++generation_;
}

void GaitTraining::serialize(const Archive& archive) {
  archive.stream("search/random", random_);
  bool second_stage = second_stage_;
  archive.numbers<std::uint64_t>("search/generation", generation_, second_stage);
  archive.array("search/best", best_);
  archive.numbers<double>("search/best_return", best_return_);
  if (second_stage && !second_stage_) {
    if (best_.size() != wave_length)
      throw Error(Failure::data, "checkpoint: 'search/best' is no wave");
    begin_second_stage(decode_wave(best_));
  }
  strategy_.serialize(archive.part("search/strategy"));
}

}  // namespace evo
