// Environments of evo/evo.h.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "bindings/c/handles.h"
#include "bindings/c/session.h"
#include "formats/rollout/episodes.h"
#include "formats/training/policy_json.h"
#include "libevo/control/actor.h"

using namespace evo::c;  // NOLINT(google-build-using-namespace)
using evo::Failure;

namespace {

// A voxel and one that it is linked to, for every voxel in turn, ascending: each link twice.
using VoxelLinks = std::vector<std::pair<std::int32_t, std::int32_t>>;

VoxelLinks links_of(const evo::Body& body) {
  std::vector<std::int32_t> numbers;  // of each cell's voxel
  std::int32_t next = 0;
  for (const evo::Voxel cell : body.cells)
    numbers.push_back(cell == evo::Voxel::empty ? -1 : next++);
  VoxelLinks links;
  for (const evo::Link& link : body.links) {
    const std::int32_t a = numbers[static_cast<std::size_t>(link.a)];
    const std::int32_t b = numbers[static_cast<std::size_t>(link.b)];
    links.emplace_back(a, b);
    links.emplace_back(b, a);
  }
  std::sort(links.begin(), links.end());
  return links;
}

struct Voxels {
  evo::VoxelViews views;
  VoxelLinks links;

  std::size_t local_values() const {
    return static_cast<std::size_t>(views.voxels() * evo::VoxelViews::local_length);
  }
  std::size_t task_values() const { return static_cast<std::size_t>(views.task_length()); }
};

}  // namespace

struct evo_envs {
  static constexpr const char* kind = "evo_envs";

  evo_envs(const evo::TaskSpec& task, std::vector<evo::Robot> robots, int per_robot, int threads)
      : owner(threads), session(task, std::move(robots), per_robot, 0, threads) {
    const auto count = static_cast<std::size_t>(session.environments());
    rewards.resize(count);
    status.resize(count);
    steps.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto e = static_cast<int>(i);
      observation_offsets.push_back(session.envs().observation_offset(e));
      action_offsets.push_back(session.envs().action_offset(e));
      point_offsets.push_back(session.envs().point_offset(e));
    }
    observation_offsets.push_back(session.envs().observations().size());
    action_offsets.push_back(session.action_values());
    point_offsets.push_back(session.envs().positions().size());
    refresh();
  }

  // What a session is asked one environment at a time.
  void refresh() {
    for (std::size_t i = 0; i < rewards.size(); ++i) {
      const auto e = static_cast<int>(i);
      rewards[i] = session.reward(e);
      status[i] = static_cast<std::uint8_t>(session.status(e));
      steps[i] = session.envs().steps(e);
    }
  }

  const evo::Arena& arena_of(std::size_t robot) const {
    return session.envs().arena(static_cast<int>(robot) * session.per_robot());
  }

  // What the voxels of each robot see.
  const std::vector<Voxels>& seen() {
    for (std::size_t r = voxels.size(); r < session.robots().size(); ++r)
      voxels.push_back({evo::VoxelViews(arena_of(r)), links_of(arena_of(r).robot())});
    return voxels;
  }

  void act(const evo_policy& policy, std::span<double> targets) {
    if (policy.file != acting) {
      std::vector<evo::Actor> made;
      for (std::size_t r = 0; r < session.robots().size(); ++r) {
        try {
          made.emplace_back(policy.file->controller, arena_of(r));
        } catch (const evo::Error& misfit) {
          throw misfit.at("robot " + session.robots()[r].id);
        }
      }
      actors = std::move(made);
      acting = policy.file;
    }
    const auto count = static_cast<std::size_t>(session.per_robot());
    for (std::size_t r = 0; r < actors.size(); ++r) {
      const std::size_t first = r * count;
      const std::size_t offset = action_offsets[first];
      actors[r].act(session.envs(), static_cast<int>(first), std::span(steps).subspan(first, count),
                    targets.subspan(offset, action_offsets[first + count] - offset));
    }
  }

  Owner owner;
  evo::Session session;
  std::vector<Voxels> voxels;                     // of each robot, once asked for
  std::shared_ptr<const evo::PolicyFile> acting;  // the last one
  std::vector<evo::Actor> actors;                 // of each robot
  std::vector<double> rewards;
  std::vector<std::uint8_t> status;
  std::vector<std::int32_t> steps;
  std::vector<std::size_t> observation_offsets;
  std::vector<std::size_t> action_offsets;
  std::vector<std::size_t> point_offsets;
  std::mutex busy;
};

namespace {

static_assert(EVO_ENV_UNSTABLE == static_cast<int>(evo::EnvironmentStatus::unstable));

// Changes environments, and what is shown of them.
template <typename Work>
int change_session(evo_envs* envs, const Work& work) {
  return change(envs, [&](evo_envs& all) {
    work(all.session);
    all.refresh();
  });
}

// The world of an environment.
const evo::Model& model_of(const evo_envs& envs, std::int32_t environment) {
  envs.session.check_environment(environment);
  return envs.session.envs().model(environment);
}

}  // namespace

int evo_envs_open(const evo_task* task, const evo_robots* robots, int32_t per_robot,
                  int32_t threads, evo_envs** envs) {
  return open(envs, [&] {
    const evo::TaskSpec& spec = object_of(task).spec;
    const std::vector<evo::Robot>& list = object_of(robots).list;
    if (list.empty()) throw evo::Error(Failure::usage, "environments need a robot; none is given");
    check_threads(threads);
    return std::make_unique<evo_envs>(spec, list, per_robot, threads);
  });
}

void evo_envs_free(evo_envs* envs) { close(envs); }

int evo_envs_arrays(const evo_envs* envs, evo_arrays* arrays, size_t size) {
  return guarded([&] {
    const evo_envs& all = object_of(envs);
    const evo::VecEnv& shown = all.session.envs();
    hand_over({all.rewards.size(), shown.observations().size(), all.session.action_values(),
               shown.positions().size(), all.observation_offsets.data(), all.action_offsets.data(),
               all.point_offsets.data(), shown.observations().data(), all.rewards.data(),
               shown.terminated().data(), shown.truncated().data(), all.status.data(),
               all.steps.data(), reinterpret_cast<const double*>(shown.positions().data()),
               reinterpret_cast<const double*>(shown.velocities().data())},
              arrays, size);
  });
}

int evo_envs_reset(evo_envs* envs, const int32_t* environments, size_t count,
                   const evo_start* start) {
  return change_session(envs, [&](evo::Session& session) {
    evo::ResetRequest request;
    if (environments == nullptr) {
      request.environments.resize(static_cast<std::size_t>(session.environments()));
      std::iota(request.environments.begin(), request.environments.end(), 0);
    } else {
      request.environments.assign(environments, environments + count);
    }
    if (start != nullptr) {
      if (start->has_seed != 0) request.seed = start->seed;
      if (start->has_episode != 0) request.episode = start->episode;
      if (start->draws != nullptr)
        request.draws = evo::read_draws(evo::Node::json(start->draws, "draws"), session.task());
      request.jitter = start->jitter;
    }
    session.reset(request);
  });
}

int evo_envs_step(evo_envs* envs, const double* actions, size_t values, const uint8_t* active,
                  size_t active_values) {
  return change_session(envs, [&](evo::Session& session) {
    check_count(values, session.action_values(), "actions");
    if (active != nullptr && active_values != static_cast<std::size_t>(session.environments()))
      throw evo::error(Failure::usage, "`active` has {} values for {} environments", active_values,
                       session.environments());
    if (values > 0) target(actions, "actions");
    session.step({actions, values}, active == nullptr ? std::span<const std::uint8_t>()
                                                      : std::span(active, active_values));
  });
}

int evo_envs_voxels(evo_envs* envs, int32_t environment, evo_voxels* voxels, size_t size) {
  return change(envs, [&](evo_envs& all) {
    all.session.check_environment(environment);
    const auto& [views, links] =
        all.seen()[static_cast<std::size_t>(environment / all.session.per_robot())];
    static_assert(sizeof links[0] == 2 * sizeof(std::int32_t));
    hand_over({static_cast<std::size_t>(views.voxels()), views.actuators().size(), links.size(),
               evo::VoxelViews::local_length, static_cast<std::size_t>(views.task_length()),
               evo::VoxelViews::fixed_length, views.fixed().data(), views.actuators().data(),
               reinterpret_cast<const std::int32_t*>(links.data())},
              voxels, size);
  });
}

int evo_envs_look(evo_envs* envs, double* local, size_t local_values, double* task,
                  size_t task_values) {
  return change(envs, [&](evo_envs& all) {
    const std::vector<Voxels>& voxels = all.seen();
    const auto count = static_cast<std::size_t>(all.session.per_robot());
    std::size_t locals = 0;
    std::size_t tasks = 0;
    for (const Voxels& robot : voxels) {
      locals += count * robot.local_values();
      tasks += count * robot.task_values();
    }
    if (local_values != locals || task_values != tasks)
      throw evo::error(Failure::usage, "{} local and {} task values are expected, not {} and {}",
                       locals, tasks, local_values, task_values);
    target(local, "local");
    if (task_values > 0) target(task, "task");
    for (std::size_t e = 0; e < count * voxels.size(); ++e) {
      const Voxels& robot = voxels[e / count];
      robot.views.look(all.session.envs(), static_cast<int>(e), {local, robot.local_values()},
                       {task, robot.task_values()});
      local += robot.local_values();
      task += robot.task_values();
    }
  });
}

int evo_envs_act(evo_envs* envs, const evo_policy* policy, double* actions, size_t values) {
  return change(envs, [&](evo_envs& all) {
    check_count(values, all.session.action_values(), "actions");
    if (values > 0) target(actions, "actions");
    all.act(object_of(policy), {actions, values});
  });
}

int evo_envs_save(const evo_envs* envs, int32_t environment, void** bytes, size_t* count) {
  return guarded([&] {
    const std::vector<std::uint8_t> state = object_of(envs).session.save(environment);
    give({reinterpret_cast<const char*>(state.data()), state.size()}, bytes, count);
  });
}

int evo_envs_restore(evo_envs* envs, int32_t environment, const void* bytes, size_t count) {
  return change_session(envs, [&](evo::Session& session) {
    const auto* const state = static_cast<const std::uint8_t*>(bytes);
    if (count > 0) target(state, "bytes");
    const evo::Session::Restored one{environment, {state, count}};
    session.restore({&one, 1});
  });
}

int evo_envs_translate(evo_envs* envs, int32_t environment, size_t object, double x, double y) {
  return change_session(envs, [&](evo::Session& session) {
    check_translation(object_at(model_of(*envs, environment), object), x, y);
    session.translate(environment, object, {x, y});
  });
}

int evo_envs_object_count(const evo_envs* envs, int32_t environment, size_t* count) {
  return guarded(
      [&] { target(count, "count") = model_of(object_of(envs), environment).objects().size(); });
}

int evo_envs_object(const evo_envs* envs, int32_t environment, size_t index, evo_object* object,
                    size_t size) {
  return guarded([&] {
    const evo::ModelObject& found = object_at(model_of(object_of(envs), environment), index);
    hand_over({found.name.c_str(), static_cast<std::size_t>(found.first_point),
               static_cast<std::size_t>(found.points)},
              object, size);
  });
}

int evo_envs_orientation(const evo_envs* envs, int32_t environment, size_t object,
                         const double* positions, double* angles, size_t count) {
  return guarded([&] {
    const evo_envs& all = object_of(envs);
    const evo::Model& model = model_of(all, environment);
    orientations(model, object_at(model, object), positions,
                 all.session.envs().positions(environment), angles, count);
  });
}

int evo_envs_observed(const evo_envs* envs, int32_t environment, char** json) {
  return guarded([&] {
    const evo::Session& session = object_of(envs).session;
    session.check_environment(environment);
    give(evo::layout_to_json(session.envs().arena(environment).layout()).dump(), json, "json");
  });
}

int evo_envs_render(const evo_envs* envs, int32_t environment, const double* positions,
                    const evo_view* view, size_t size, uint8_t* pixels, size_t bytes) {
  return guarded([&] {
    const evo::Session& session = object_of(envs).session;
    session.check_environment(environment);
    if (session.status(environment) != evo::EnvironmentStatus::ok)
      throw evo::error(Failure::usage, "environment {} is {}: reset it first", environment,
                       evo::to_string(session.status(environment)));
    const evo::Model& model = session.envs().model(environment);
    const auto now = session.envs().positions().subspan(session.envs().point_offset(environment),
                                                        static_cast<std::size_t>(model.points()));
    draw(model, now, positions, &session.task(), view, size, pixels, bytes);
  });
}
