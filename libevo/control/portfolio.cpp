#include "libevo/control/portfolio.h"

#include <algorithm>
#include <string>

#include "libevo/base/error.h"
#include "libevo/control/wave_search.h"

namespace evo {
namespace {

constexpr double nothing_yet = -std::numeric_limits<double>::infinity();

std::int64_t part(double share, std::int64_t steps) {
  return static_cast<std::int64_t>(share * static_cast<double>(steps));
}

TrainingJob search_part(TrainingJob job) {
  job.settings.steps = part(job.settings.gait_share, job.settings.steps);
  return job;
}

std::string network_name(std::size_t which) { return "network_" + std::to_string(which); }

}  // namespace

void PortfolioTraining::check(const TrainingSettings& s) {
  PpoTraining::check(s);
  if (s.gait_share + 2.0 * s.trial_share > 1.0)
    throw error(Failure::usage,
                "training: gait_share {} and two trials of trial_share {} are more than the whole",
                s.gait_share, s.trial_share);
  if (s.action_map != ActionMap::offset)
    throw Error(Failure::usage,
                "training: a portfolio needs action_map offset, to add actions to a gait");
}

PortfolioTraining::PortfolioTraining(const TrainingJob& job)
    : search_job_(std::make_unique<TrainingJob>(search_part(job))),
      network_job_(std::make_unique<TrainingJob>(job)),
      trial_steps_(part(job.settings.trial_share, job.settings.steps) / job.settings.batch() *
                   job.settings.batch()) {
  best_.fill(nothing_yet);
  if (job.inheritance || trial_steps_ == 0 ||
      generation_cost(*search_job_) > search_job_->settings.steps) {
    networks_[alone].emplace(*network_job_);
    stage_ = going_on;
  } else {
    search_.emplace(*search_job_);
  }
}

bool PortfolioTraining::done(const TrainingJob&, const Findings& findings) const {
  return stage_ == going_on && networks_[going_]->done(*network_job_, findings);
}

void PortfolioTraining::advance(const TrainingJob&, Findings& findings, Metrics& metrics) {
  switch (stage_) {
    case searching:
      search_->advance(*search_job_, findings, metrics);
      if (search_->done(*search_job_, findings)) end_search(findings);
      break;
    case first_trial:
      train(alone, findings, metrics);
      if (steps_[alone] >= trial_steps_) {
        networks_[on_gait].emplace(*network_job_, gait_);
        stage_ = second_trial;
      }
      break;
    case second_trial:
      train(on_gait, findings, metrics);
      if (steps_[on_gait] >= trial_steps_) {
        going_ = best_[on_gait] > std::max(gait_return_, best_[alone]) ? on_gait : alone;
        networks_[1 - going_].reset();
        stage_ = going_on;
      }
      break;
    default:
      train(going_, findings, metrics);
  }
}

// Both networks may take what is left but for the other's trial.
void PortfolioTraining::end_search(const Findings& findings) {
  gait_ = std::get<SineController>(*findings.best);
  gait_return_ = *findings.fitness;
  search_.reset();
  others_ = findings.steps + trial_steps_;
  network_job_->settings.steps -= others_;
  networks_[alone].emplace(*network_job_);
  stage_ = first_trial;
}

void PortfolioTraining::train(std::size_t which, Findings& findings, Metrics& metrics) {
  const std::size_t known = findings.curve.size();
  const std::int64_t before = findings.steps;
  networks_[which]->advance(*network_job_, findings, metrics);
  steps_[which] += findings.steps - before;
  for (std::size_t i = known; i < findings.curve.size(); ++i)
    best_[which] = std::max(best_[which], findings.curve[i].evaluation);
}

void PortfolioTraining::save(Checkpoint& checkpoint) const {
  checkpoint.put<std::uint64_t>(
      "portfolio/stage",
      {stage_, going_, static_cast<std::uint64_t>(others_),
       static_cast<std::uint64_t>(steps_[alone]), static_cast<std::uint64_t>(steps_[on_gait])});
  checkpoint.put<double>("portfolio/best", {best_[alone], best_[on_gait], gait_return_});
  if (gait_) save_sine(checkpoint, "portfolio/gait", *gait_);
  if (search_) search_->save(checkpoint);
  for (std::size_t which : {alone, on_gait}) {
    if (!networks_[which]) continue;
    Checkpoint network;
    networks_[which]->save(network);
    checkpoint.put(network_name(which), network);
  }
}

void PortfolioTraining::load(const Checkpoint& checkpoint) {
  const auto& stage = checkpoint.get<std::uint64_t>("portfolio/stage", 5);
  const auto& best = checkpoint.get<double>("portfolio/best", 3);
  if (stage[0] > going_on || stage[1] > on_gait)
    throw Error(Failure::data, "checkpoint: 'portfolio/stage' names no stage");
  stage_ = stage[0];
  going_ = stage[1];
  others_ = static_cast<std::int64_t>(stage[2]);
  network_job_->settings.steps -= others_;
  steps_ = {static_cast<std::int64_t>(stage[3]), static_cast<std::int64_t>(stage[4])};
  best_ = {best[0], best[1]};
  gait_return_ = best[2];
  if (checkpoint.has("portfolio/gait/period")) gait_ = load_sine(checkpoint, "portfolio/gait");
  if (stage_ == searching && search_)
    search_->load(checkpoint);
  else
    search_.reset();
  for (std::size_t which : {alone, on_gait}) {
    networks_[which].reset();
    const Checkpoint network = checkpoint.part(network_name(which));
    if (network.arrays.empty()) continue;
    networks_[which].emplace(*network_job_, which == on_gait ? gait_ : std::nullopt);
    networks_[which]->load(network);
  }
  const bool whole = stage_ == searching      ? search_.has_value()
                     : stage_ == first_trial  ? gait_ && networks_[alone]
                     : stage_ == second_trial ? networks_[alone] && networks_[on_gait]
                                              : networks_[going_].has_value();
  if (!whole) throw Error(Failure::data, "checkpoint: the portfolio's stage lacks its parts");
}

}  // namespace evo
