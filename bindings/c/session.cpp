#include "bindings/c/session.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/task/physics_profile.h"
#include "libevo/base/digest.h"
#include "libevo/base/error.h"
#include "libevo/base/random.h"

namespace evo {

namespace {

constexpr std::size_t most_environments = 65536;
constexpr std::size_t seal_length = 64;  // of a saved state, hexadecimal digits
constexpr int state_version = 1;         // of what VecEnv saves

void check_ranges(const TaskSpec& task, const Draws& draws) {
  for (const DrawnInteger& drawn : task.draws) {
    const auto found = draws.integers.find(drawn.name);
    if (found == draws.integers.end()) continue;  // refused by VecEnv
    if (found->second < drawn.low || found->second > drawn.high)
      throw error(Failure::usage, "draws: '{}' is {}, task {} draws it from {} to {}", drawn.name,
                  found->second, task.name, drawn.low, drawn.high);
  }
}

}  // namespace

void check_jitter(double jitter) {
  if (!(jitter >= 0.0 && jitter < 0.5))
    throw error(Failure::usage, "jitter must be between 0 and 0.5 voxels, not {}", jitter);
}

const char* to_string(EnvironmentStatus status) {
  static constexpr std::array names{"ok", "unreset", "unstable"};
  return names.at(static_cast<std::size_t>(status));
}

Session::Session(const TaskSpec& task, std::vector<Robot> robots, int per_robot, std::uint64_t seed,
                 int threads)
    : task_(task),
      physics_(physics_profiles().to_yaml(task.physics)),
      robots_(std::move(robots)),
      per_robot_(per_robot),
      pool_(threads) {
  const auto count = static_cast<std::size_t>(per_robot);
  if (per_robot < 1 || robots_.size() * count > most_environments)
    throw error(Failure::usage,
                "{} environments for each of {} robots: there may be 1 to {} in all", per_robot,
                robots_.size(), most_environments);
  std::vector<const Arena*> arenas;
  for (const Robot& robot : robots_) {
    try {
      arenas_.push_back(std::make_unique<Arena>(task_, robot.body));
    } catch (const Error& failure) {
      throw failure.at("robot " + robot.id);
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      arenas.push_back(arenas_.back().get());
      progress_.push_back({EnvironmentStatus::unreset, seed, i});
      action_values_ += static_cast<std::size_t>(arenas_.back()->action_length());
    }
  }
  envs_ = std::make_unique<VecEnv>(arenas);
  active_.resize(progress_.size());
}

const Robot& Session::robot(int environment) const {
  return robots_[static_cast<std::size_t>(environment / per_robot_)];
}

void Session::check_environment(std::int64_t environment) const {
  if (environment < 0 || environment >= environments())
    throw error(Failure::usage, "there is no environment {}: they are 0 to {}", environment,
                environments() - 1);
}

void Session::reset(const ResetRequest& request) {
  for (const int e : request.environments) check_environment(e);
  if (request.draws) check_ranges(task_, *request.draws);
  check_jitter(request.jitter);

  for (const int e : request.environments) {
    const auto index = static_cast<std::size_t>(e);
    Progress next = progress_[index];
    if (request.seed) {
      next.seed = *request.seed;
      next.next_episode = static_cast<std::uint64_t>(e % per_robot_);
    }
    if (request.episode) next.next_episode = *request.episode;
    const std::uint64_t k = next.next_episode;
    // As evo-eval starts episode k of this seed.
    envs_->reset(e, {request.draws ? *request.draws : envs_->arena(e).draw(next.seed, k),
                     request.jitter, derive_seed(next.seed, "jitter", k)});
    next.status = EnvironmentStatus::ok;
    next.next_episode = k + static_cast<std::uint64_t>(per_robot_);
    progress_[index] = next;
  }
}

void Session::step(std::span<const double> actions, std::span<const std::uint8_t> active) {
  for (std::size_t e = 0; e < progress_.size(); ++e) {
    active_[e] = active.empty() || active[e] != 0 ? 1 : 0;
    if (active_[e] == 0) continue;
    if (progress_[e].status == EnvironmentStatus::unreset)
      throw error(Failure::usage, "environment {} needs a reset before its first step", e);
    const auto environment = static_cast<int>(e);
    const std::span<const double> row =
        actions.subspan(envs_->action_offset(environment),
                        static_cast<std::size_t>(envs_->arena(environment).action_length()));
    for (std::size_t i = 0; i < row.size(); ++i)
      if (!std::isfinite(row[i]))
        throw error(Failure::usage, "action {} of environment {} is not a finite number", i, e);
    if (progress_[e].status == EnvironmentStatus::unstable) active_[e] = 0;
  }
  envs_->step(actions, active_, &pool_);
  for (std::size_t e = 0; e < progress_.size(); ++e)
    if (active_[e] != 0 && envs_->status(static_cast<int>(e)) == LaneStatus::unstable)
      progress_[e].status = EnvironmentStatus::unstable;
}

std::string Session::seal(int environment, std::span<const std::uint8_t> state) const {
  std::string sealed = fmt::format("{} {} {}\n{}\n{}\n", state_version, robot(environment).id,
                                   task_.name, task_.source, physics_);
  sealed.append(reinterpret_cast<const char*>(state.data()), state.size());
  return sha256_hex(sealed);
}

std::vector<std::uint8_t> Session::save(int environment) const {
  check_environment(environment);
  if (status(environment) != EnvironmentStatus::ok)
    throw error(Failure::usage, "environment {} is {}: there is no state to save", environment,
                to_string(status(environment)));
  const std::vector<std::uint8_t> state = envs_->save(environment);
  const std::string seal_of_it = seal(environment, state);
  std::vector<std::uint8_t> sealed(seal_of_it.begin(), seal_of_it.end());
  sealed.insert(sealed.end(), state.begin(), state.end());
  return sealed;
}

void Session::restore(std::span<const Restored> states) {
  for (const auto& [environment, state] : states) {
    check_environment(environment);
    const auto body = state.subspan(std::min(seal_length, state.size()));
    const std::string found(state.begin(), state.end() - static_cast<std::ptrdiff_t>(body.size()));
    if (found != seal(environment, body))
      throw error(Failure::data,
                  "the state for environment {} is damaged, or of another robot, task or version",
                  environment);
  }
  for (const auto& [environment, state] : states) {
    envs_->load(environment, state.subspan(seal_length));
    progress_[static_cast<std::size_t>(environment)].status = EnvironmentStatus::ok;
  }
}

void Session::translate(int environment, std::size_t object, Vec2 by) {
  check_environment(environment);
  if (status(environment) != EnvironmentStatus::ok)
    throw error(Failure::usage, "environment {} is {}: there is nothing to move", environment,
                to_string(status(environment)));
  envs_->translate(environment, object, by);
}

double Session::reward(int environment) const {
  if (status(environment) != EnvironmentStatus::ok) return 0.0;
  return envs_->rewards()[static_cast<std::size_t>(environment)];
}
EnvironmentStatus Session::status(int environment) const {
  return progress_[static_cast<std::size_t>(environment)].status;
}

}  // namespace evo
