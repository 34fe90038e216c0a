#include "bindings/c/voxels.h"

#include <algorithm>
#include <variant>

#include "libevo/base/error.h"
#include "libevo/base/overloaded.h"

namespace evo {
namespace {

// A voxel and one that it is linked to, both by their numbers, in order: each link twice.
std::vector<std::pair<std::int32_t, std::int32_t>> links_of(const Body& body) {
  std::vector<std::int32_t> numbers;  // of each cell's voxel
  std::int32_t next = 0;
  for (const Voxel cell : body.cells) numbers.push_back(cell == Voxel::empty ? -1 : next++);
  std::vector<std::pair<std::int32_t, std::int32_t>> links;
  for (const Link& link : body.links) {
    const std::int32_t a = numbers[static_cast<std::size_t>(link.a)];
    const std::int32_t b = numbers[static_cast<std::size_t>(link.b)];
    links.emplace_back(a, b);
    links.emplace_back(b, a);
  }
  std::sort(links.begin(), links.end());
  return links;
}

// Calls use(environment of the first, environments) for each robot.
template <typename Use>
void each_robot(const Session& session, Use use) {
  for (int e = 0; e < session.environments(); e += session.per_robot()) use(e, session.per_robot());
}

const Arena& arena_of(const Session& session, int environment) {
  return session.envs().arena(environment);
}

std::vector<const Arena*> arenas_of(const Session& session) {
  std::vector<const Arena*> arenas;
  each_robot(session, [&](int first, int) { arenas.push_back(&arena_of(session, first)); });
  return arenas;
}

void require(int known, int there, const char* what, const Session& session, int environment) {
  if (known != there)
    throw error(Failure::usage, "the policy has {} {}, robot {} has {}", known, what,
                session.robot(environment).id, there);
}

void act_network(const Policy& policy, const Session& session, std::span<double> targets) {
  each_robot(session, [&](int first, int count) {
    const Arena& arena = arena_of(session, first);
    require(policy.observation_length(), arena.observation_length(), "observations", session,
            first);
    require(policy.action_length(), arena.action_length(), "actions", session, first);
    std::vector<int> steps;
    for (int e = first; e < first + count; ++e) steps.push_back(session.envs().steps(e));
    const auto n = static_cast<std::size_t>(count);
    act(policy,
        session.envs().observations().subspan(
            session.envs().observation_offset(first),
            n * static_cast<std::size_t>(arena.observation_length())),
        steps,
        targets.subspan(session.envs().action_offset(first),
                        n * static_cast<std::size_t>(arena.action_length())));
  });
}

void act_modular(const ModularPolicy& policy, const SessionVoxels& voxels,
                 std::span<double> targets) {
  const Session& session = voxels.session();
  const Bodies& bodies = voxels.bodies();
  if (bodies.task_length() != policy.task_length())
    throw error(
        Failure::data,
        "the policy sees {} numbers of its task, {} shows {}: it was trained on another one",
        policy.task_length(), session.task().name, bodies.task_length());
  std::vector<double> local(voxels.local_values());
  std::vector<double> task(voxels.task_values());
  voxels.look(local, task);
  VoxelBatch batch;
  std::vector<int> steps;
  for (int e = 0; e < session.environments(); ++e) {
    batch.bodies.push_back(e / session.per_robot());
    steps.push_back(session.envs().steps(e));
  }
  normalize(policy.local, local, batch.local);
  network_inputs(policy.task, policy.clock, task, steps, batch.task);
  PreparedNetwork prepared;
  prepare(policy.actor, bodies, prepared);
  ModularPass pass;
  std::vector<float> means;
  forward_actor(policy, bodies, prepared, batch, pass, means);
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] = target_of(policy, static_cast<double>(means[i]));
}

int actuators(const SineController& sine) { return static_cast<int>(sine.amplitude.size()); }
int actuators(const ReplayController& sequence) { return sequence.actuators; }

template <typename OpenLoopController>
void act_open_loop(const OpenLoopController& controller, const Session& session,
                   std::span<double> targets) {
  for (int e = 0; e < session.environments(); ++e) {
    const int actions = arena_of(session, e).action_length();
    require(actuators(controller), actions, "actions", session, e);
    act(controller, session.envs().steps(e),
        targets.subspan(session.envs().action_offset(e), static_cast<std::size_t>(actions)));
  }
}

}  // namespace

SessionVoxels::SessionVoxels(const Session& session)
    : session_(&session), bodies_(arenas_of(session)) {
  each_robot(session, [&](int first, int count) {
    const VoxelViews& views = of(first);
    links_.push_back(links_of(arena_of(session, first).robot()));
    local_values_ += static_cast<std::size_t>(count * views.voxels() * VoxelViews::local_length);
    task_values_ += static_cast<std::size_t>(count * views.task_length());
  });
}

void SessionVoxels::look(std::span<double> local, std::span<double> task) const {
  std::size_t l = 0;
  std::size_t t = 0;
  for (int e = 0; e < session_->environments(); ++e) {
    const VoxelViews& views = of(e);
    const auto own = static_cast<std::size_t>(views.voxels() * VoxelViews::local_length);
    const auto shown = static_cast<std::size_t>(views.task_length());
    views.look(session_->envs(), e, local.subspan(l, own), task.subspan(t, shown));
    l += own;
    t += shown;
  }
}

void act(const TrainedController& controller, const SessionVoxels& voxels,
         std::span<double> targets) {
  const Session& session = voxels.session();
  std::visit(Overloaded{[&](const Policy& policy) { act_network(policy, session, targets); },
                        [&](const ModularPolicy& policy) { act_modular(policy, voxels, targets); },
                        [&](const auto& open_loop) { act_open_loop(open_loop, session, targets); }},
             controller);
}

}  // namespace evo
