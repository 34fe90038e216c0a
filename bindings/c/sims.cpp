// Worlds built in code, and their simulations, of evo/evo.h.
#include <algorithm>
#include <cmath>

#include "bindings/c/handles.h"
#include "bindings/c/session.h"
#include "formats/io/json.h"
#include "formats/robot/evogym.h"
#include "formats/rollout/episodes.h"
#include "formats/task/physics_profile.h"
#include "libevo/base/bytes.h"
#include "libevo/base/digest.h"
#include "libevo/base/parallel.h"
#include "libevo/sim/adjoint.h"
#include "libevo/sim/batch.h"

using namespace evo::c;  // NOLINT(google-build-using-namespace)
using evo::Failure;

struct evo_world {
  static constexpr const char* kind = "evo_world";
  evo::World world;
};

namespace {

constexpr int most_sims = 65536;

// Where an object's are among all actuators.
struct ActuatorRange {
  std::size_t first = 0;
  std::size_t count = 0;
};

std::vector<evo::Object>::iterator find_object(evo::World& world, const std::string& name) {
  const auto found = std::find_if(world.objects.begin(), world.objects.end(),
                                  [&](const evo::Object& object) { return object.name == name; });
  if (found == world.objects.end()) {
    std::vector<std::string> names;
    for (const evo::Object& object : world.objects) names.push_back(object.name);
    throw evo::error(Failure::usage, "the world has no object '{}'{}", name,
                     evo::did_you_mean(name, names));
  }
  return found;
}

constexpr std::int32_t largest_coordinate = 100'000;  // cells, as in files

void check_position(std::int32_t x, std::int32_t y) {
  if (x < 0 || y < 0 || x > largest_coordinate || y > largest_coordinate)
    throw evo::error(Failure::usage, "cell ({}, {}) is outside of the world: both are from 0 to {}",
                     x, y, largest_coordinate);
}

evo::Body body_of(const std::uint8_t* voxels, std::int32_t rows, std::int32_t columns,
                  const std::int32_t* links, std::size_t link_count) {
  target(voxels, "voxels");
  if (rows < 1 || columns < 1 || rows > evo::largest_side || columns > evo::largest_side)
    throw evo::error(Failure::usage, "a matrix of {} rows and {} columns: 1 to {} are allowed",
                     rows, columns, evo::largest_side);
  std::vector<evo::Voxel> cells;
  const std::size_t count = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  for (std::size_t i = 0; i < count; ++i) {
    if (voxels[i] > EVO_FIXED)
      throw evo::error(Failure::usage, "voxel {} is {}: 0 to {} are allowed", i, voxels[i],
                       static_cast<int>(EVO_FIXED));
    cells.push_back(static_cast<evo::Voxel>(voxels[i]));
  }
  evo::Body body(rows, columns, std::move(cells));
  if (links != nullptr) {
    body.links.clear();
    for (std::size_t k = 0; k < link_count; ++k)
      body.links.push_back(
          {std::min(links[2 * k], links[2 * k + 1]), std::max(links[2 * k], links[2 * k + 1])});
    std::sort(body.links.begin(), body.links.end());
    body.links.erase(std::unique(body.links.begin(), body.links.end()), body.links.end());
    if (const auto fault = evo::link_defect(body)) throw evo::Error(Failure::usage, *fault);
  }
  return body;
}

}  // namespace

// ---- simulations ------------------------------------------------------------------------

struct evo_sims {
  static constexpr const char* kind = "evo_sims";

  evo_sims(const evo::World& world, const evo::Physics& physics, std::size_t count, int threads)
      : owner(threads),
        model(world, physics),
        batch(count),
        pool(threads),
        status(count),
        moving(count) {
    const auto own = static_cast<std::size_t>(model.points());
    positions.resize(count * own);
    velocities.resize(count * own);
    actuators.resize(model.objects().size());
    for (std::size_t i = 0; i < actuators.size(); ++i) {
      const evo::ModelObject& object = model.objects()[i];
      const auto first = model.cells().begin() + object.first_cell;
      actuators[i].first = i == 0 ? 0 : actuators[i - 1].first + actuators[i - 1].count;
      actuators[i].count = static_cast<std::size_t>(
          std::count_if(first, first + object.cells,
                        [](const evo::ModelCell& cell) { return evo::is_actuator(cell.type); }));
    }
    for (std::size_t sim = 0; sim < count; ++sim) place(sim);
    physics_yaml = evo::physics_profiles().to_yaml(physics);
    seal = evo::sha256_hex(evo::evogym_world_to_json(world) + physics_yaml);
  }

  std::size_t count() const { return status.size(); }
  std::size_t targets() const {
    return actuators.empty() ? 0 : actuators.back().first + actuators.back().count;
  }

  std::size_t checked(std::int64_t sim) const {
    if (sim < 0 || static_cast<std::size_t>(sim) >= count())
      throw evo::error(Failure::usage, "there is no simulation {}: they are 0 to {}", sim,
                       count() - 1);
    return static_cast<std::size_t>(sim);
  }

  std::span<evo::Vec2> points(std::vector<evo::Vec2>& of, std::size_t sim) const {
    const auto own = static_cast<std::size_t>(model.points());
    return std::span(of).subspan(sim * own, own);
  }

  void place(std::size_t sim) {
    batch.place(sim, model);
    std::ranges::copy(model.initial_positions(), points(positions, sim).begin());
    std::ranges::fill(points(velocities, sim), evo::Vec2{});
    status[sim] = EVO_SIM_OK;
  }

  void show(std::size_t sim) {
    batch.read_moving(sim, points(positions, sim), points(velocities, sim));
    status[sim] = static_cast<std::uint8_t>(batch.status(sim));
  }

  Owner owner;
  evo::Model model;
  evo::Batch batch;
  evo::ThreadPool pool;
  std::vector<std::uint8_t> status;
  std::vector<evo::Vec2> positions;
  std::vector<evo::Vec2> velocities;
  std::vector<ActuatorRange> actuators;  // of each object
  std::vector<std::uint8_t> moving;      // in the step being taken
  std::string physics_yaml;
  std::string seal;              // of world and physics
  double onset = -1.0;           // of tapes; below 0: steps are not kept
  std::vector<evo::Tape> tapes;  // of steps, the last one not yet gone back through last
  std::mutex busy;
};

namespace {

static_assert(EVO_SIM_FOLDED == static_cast<int>(evo::LaneStatus::self_folding) &&
              EVO_SIM_UNSTABLE == static_cast<int>(evo::LaneStatus::unstable));

// A state and the seal of what it belongs to, so that damage is seen.
std::string sealed(const evo_sims& sims, std::span<const std::uint8_t> state) {
  const std::string text(state.begin(), state.end());
  return evo::sha256_hex(sims.seal + text) + text;
}

// Changes the state of a simulation from outside.
template <typename Change>
int move(evo_sims* sims, std::int32_t sim, const Change& change_state) {
  return change(sims, [&](evo_sims& all) {
    const std::size_t i = all.checked(sim);
    if (all.status[i] == EVO_SIM_UNSTABLE)
      throw evo::error(Failure::usage, "simulation {} is unstable: all that is left is a reset",
                       sim);
    evo::State state = all.batch.state(i);
    change_state(all.model, state);
    all.batch.set_state(i, state);
    all.show(i);
  });
}

// A caller's own episode.
evo::Rollout rollout_of(const evo::PolicyFile& policy, const evo_sims& sims,
                        const evo_episode& given) {
  const auto points = static_cast<std::size_t>(sims.model.points());
  const std::size_t steps = given.steps;
  if (steps == 0 || given.observation_values % (steps + 1) != 0 || given.action_values % steps != 0)
    throw evo::error(Failure::usage,
                     "{} observations and {} actions do not part into {} steps and a start",
                     given.observation_values, given.action_values, steps);
  const auto values = [](const double* array, std::size_t count, const char* name) {
    target(array, name);
    return std::vector<double>(array, array + count);
  };
  evo::Rollout rollout;
  rollout.task = policy.task;
  rollout.task_yaml = text_of(given.task_yaml, "task_yaml");
  rollout.physics_yaml = sims.physics_yaml;
  rollout.robot = policy.robot;
  rollout.seed = policy.seed;
  rollout.created_by = evo::created_by();
  rollout.observation_length = static_cast<int>(given.observation_values / (steps + 1));
  rollout.action_length = static_cast<int>(given.action_values / steps);
  rollout.points = sims.model.points();
  rollout.world = {sims.model.objects(), sims.model.cells()};
  evo::RolloutEpisode& episode = rollout.episodes.emplace_back();
  episode.seed = policy.seed;
  episode.observations = values(given.observations, given.observation_values, "observations");
  episode.actions = values(given.actions, given.action_values, "actions");
  episode.rewards = values(given.rewards, steps, "rewards");
  episode.terminations.resize(steps);
  episode.truncations.resize(steps);
  episode.terminations.back() = given.terminated;
  episode.truncations.back() = given.truncated;
  const auto positions = points_of(&target(given.positions, "positions"), (steps + 1) * points);
  episode.positions.assign(positions.begin(), positions.end());
  return rollout;
}

}  // namespace

int evo_policy_record(const evo_policy* policy, const evo_sims* sims, const evo_episode* episode,
                      size_t size, const char* file) {
  return guarded([&] {
    const evo::PolicyFile& played = *object_of(policy).file;
    if ((sims == nullptr) != (episode == nullptr))
      throw evo::Error(Failure::usage, "of `sims` and `episode` one is NULL");
    evo::write_rollout(text_of(file, "file"),
                       sims == nullptr ? evo::play(played, "", evo::created_by())
                                       : rollout_of(played, object_of(sims), taken(episode, size)));
  });
}

int evo_sims_open(const evo_world* world, const char* physics, int32_t sims, int32_t threads,
                  evo_sims** opened) {
  return open(opened, [&] {
    const evo::World& built = object_of(world).world;
    if (built.objects.empty()) throw evo::Error(Failure::usage, "the world has no objects");
    if (sims < 1 || sims > most_sims)
      throw evo::error(Failure::usage, "there may be 1 to {} simulations, not {}", most_sims, sims);
    check_threads(threads);
    const evo::Physics constants =
        physics == nullptr ? evo::Physics() : evo::physics_profiles().load(physics, data_folders());
    return std::make_unique<evo_sims>(built, constants, static_cast<std::size_t>(sims), threads);
  });
}

void evo_sims_free(evo_sims* sims) { close(sims); }

int evo_sims_arrays(const evo_sims* sims, evo_sim_arrays* arrays, size_t size) {
  return guarded([&] {
    const evo_sims& all = object_of(sims);
    hand_over(
        {all.count(), static_cast<std::size_t>(all.model.points()), all.targets(),
         reinterpret_cast<const double*>(all.positions.data()),
         reinterpret_cast<const double*>(all.velocities.data()), all.status.data(),
         all.model.physics().min_target, all.model.physics().max_target, all.model.cells().size()},
        arrays, size);
  });
}

int evo_sims_reset(evo_sims* sims, int32_t sim) {
  return change(sims, [&](evo_sims& all) {
    if (sim != -1) return all.place(all.checked(sim));
    for (std::size_t i = 0; i < all.count(); ++i) all.place(i);
  });
}

int evo_sims_step(evo_sims* sims, const double* targets, size_t values, const uint8_t* active,
                  size_t active_values) {
  return change(sims, [&](evo_sims& all) {
    if (values != all.count() * all.targets())
      throw evo::error(Failure::usage, "{} targets are expected ({} simulations of {}), not {}",
                       all.count() * all.targets(), all.count(), all.targets(), values);
    if (active != nullptr && active_values != all.count())
      throw evo::error(Failure::usage, "`active` has {} values for {} simulations", active_values,
                       all.count());
    if (values > 0) target(targets, "targets");
    std::vector<std::uint8_t>& moving = all.moving;
    for (std::size_t i = 0; i < all.count(); ++i) {
      moving[i] = (active == nullptr || active[i] != 0) && all.status[i] != EVO_SIM_UNSTABLE;
      if (moving[i] == 0) continue;
      for (std::size_t k = 0; k < all.targets(); ++k)
        if (!std::isfinite(targets[i * all.targets() + k]))
          throw evo::error(Failure::usage, "target {} of simulation {} is not a finite number", k,
                           i);
    }
    for (std::size_t i = 0; i < all.count(); ++i)
      if (moving[i] != 0)
        std::copy_n(targets + i * all.targets(), all.targets(), all.batch.targets(i).begin());
    if (all.onset >= 0.0) all.tapes.emplace_back(all.onset);
    all.batch.step(
        moving, &all.pool, [&all](std::size_t i) { all.show(i); },
        all.onset >= 0.0 ? &all.tapes.back() : nullptr);
  });
}

int evo_sims_record(evo_sims* sims, double onset) {
  return change(sims, [&](evo_sims& all) {
    if (!(onset < 0.0)) static_cast<void>(evo::Tape(onset));  // refuses what is too wide
    all.onset = onset;
    all.tapes.clear();
  });
}

int evo_sims_pull_back(evo_sims* sims, const evo_sim_gradients* gradients, size_t size) {
  return change(sims, [&](evo_sims& all) {
    const evo_sim_gradients by = taken(gradients, size);
    const auto points = static_cast<std::size_t>(all.model.points());
    const std::size_t voxels = all.model.cells().size();
    if (by.sims != all.count() || by.points != points || by.actuators != all.targets() ||
        by.voxels != voxels)
      throw evo::error(Failure::usage,
                       "gradients of {} simulations, {} points, {} actuators and {} voxels are "
                       "expected, not {}, {}, {} and {}",
                       all.count(), points, all.targets(), voxels, by.sims, by.points, by.actuators,
                       by.voxels);
    if (all.tapes.empty())
      throw evo::Error(Failure::usage,
                       "no step is kept to go back through: evo_sims_record comes first");
    target(by.positions, "positions");
    target(by.velocities, "velocities");
    target(by.previous, "previous");
    if (all.targets() > 0) target(by.targets, "targets");
    std::vector<evo::Gradient> pulled(
        all.count(), evo::zero_gradient(all.model, {.stiffness = by.stiffness != nullptr,
                                                    .constants = by.constants != nullptr}));
    const auto for_each_value = [&](std::size_t sim, auto visit) {
      evo::State& state = pulled[sim].state;
      std::size_t i = 0;
      for (const evo::ModelObject& object : all.model.objects()) {
        if (object.is_static) continue;
        for (int p = object.first_point; p < object.first_point + object.points; ++p, ++i) {
          const std::size_t o = 2 * (sim * points + static_cast<std::size_t>(p));
          const auto pair = [&](evo::Vec2& inside, double* outside) {
            visit(inside.x, outside[o]);
            visit(inside.y, outside[o + 1]);
          };
          pair(state.positions[i], by.positions);
          pair(state.velocities[i], by.velocities);
          pair(state.previous[i], by.previous);
        }
      }
    };
    for (std::size_t sim = 0; sim < all.count(); ++sim)
      for_each_value(sim, [](double& inside, double outside) { inside = outside; });
    all.tapes.back().pull_back(pulled, &all.pool);
    all.tapes.pop_back();
    for (std::size_t sim = 0; sim < all.count(); ++sim) {
      for_each_value(sim, [](double inside, double& outside) { outside = inside; });
      std::ranges::copy(pulled[sim].state.targets, by.targets + sim * all.targets());
      for (std::size_t v = 0; v < pulled[sim].stiffness.size(); ++v)
        by.stiffness[sim * voxels + v] += pulled[sim].stiffness[v];
      for (std::size_t c = 0; c < pulled[sim].constants.size(); ++c)
        by.constants[sim * evo::gradient_constants + c] += pulled[sim].constants[c];
    }
  });
}

int evo_sims_save(const evo_sims* sims, int32_t sim, void** bytes, size_t* count) {
  return guarded([&] {
    const evo_sims& all = object_of(sims);
    const std::size_t i = all.checked(sim);
    if (all.status[i] == EVO_SIM_UNSTABLE)
      throw evo::error(Failure::usage, "simulation {} is unstable: there is no state to save", sim);
    evo::State state = all.batch.state(i);
    evo::Bytes values;
    for_each_array(state, [&](auto& array) { values.known(array); });
    give(sealed(all, values.take()), bytes, count);
  });
}

int evo_sims_restore(evo_sims* sims, int32_t sim, const void* bytes, size_t count) {
  return change(sims, [&](evo_sims& all) {
    const std::size_t i = all.checked(sim);
    if (bytes == nullptr) throw evo::Error(Failure::usage, "`bytes` is NULL");
    const std::span found(static_cast<const std::uint8_t*>(bytes), count);
    const auto values = found.subspan(std::min(all.seal.size(), count));
    evo::Bytes in(
        values,
        fmt::format("the state for simulation {} is damaged, or of another world or version", sim));
    if (sealed(all, values) != std::string(found.begin(), found.end())) in.refuse();
    evo::State state = all.batch.state(i);
    for_each_array(state, [&](auto& array) { in.known(array); });
    in.finish();
    all.batch.set_state(i, state);
    all.show(i);
  });
}

int evo_sims_translate(evo_sims* sims, int32_t sim, size_t object, double x, double y) {
  return move(sims, sim, [&](const evo::Model& model, evo::State& state) {
    check_translation(object_at(model, object), x, y);
    evo::translate(model, object, {x, y}, state);
  });
}

int evo_sims_perturb(evo_sims* sims, int32_t sim, double jitter, uint64_t seed) {
  return move(sims, sim, [&](const evo::Model& model, evo::State& state) {
    evo::check_jitter(jitter);
    evo::perturb(state, jitter * model.physics().voxel_length, seed);
  });
}

int evo_sims_object_count(const evo_sims* sims, size_t* count) {
  return guarded([&] { target(count, "count") = object_of(sims).model.objects().size(); });
}

int evo_sims_object(const evo_sims* sims, size_t index, evo_sim_object* object, size_t size) {
  return guarded([&] {
    const evo_sims& all = object_of(sims);
    const evo::ModelObject& found = object_at(all.model, index);
    hand_over({found.name.c_str(), static_cast<std::size_t>(found.first_point),
               static_cast<std::size_t>(found.points), all.actuators[index].first,
               all.actuators[index].count},
              object, size);
  });
}

int evo_sims_orientation(const evo_sims* sims, size_t object, const double* positions,
                         double* angles, size_t count) {
  return guarded([&] {
    const evo_sims& all = object_of(sims);
    orientations(all.model, object_at(all.model, object), positions, all.positions, angles, count);
  });
}

int evo_sims_render(const evo_sims* sims, int32_t sim, const double* positions,
                    const evo_view* view, size_t size, uint8_t* pixels, size_t bytes) {
  return guarded([&] {
    const evo_sims& all = object_of(sims);
    const auto own = static_cast<std::size_t>(all.model.points());
    const auto now = std::span<const evo::Vec2>(all.positions).subspan(all.checked(sim) * own, own);
    draw(all.model, now, positions, nullptr, view, size, pixels, bytes);
  });
}

// ---- worlds -----------------------------------------------------------------------------

int evo_world_new(evo_world** world) {
  return open(world, [] { return std::make_unique<evo_world>(); });
}

int evo_world_read(const char* file, evo_world** world) {
  return open(world, [&] {
    return std::make_unique<evo_world>(evo_world{evo::read_evogym_world(text_of(file, "file"))});
  });
}

int evo_world_parse(const char* json, evo_world** world) {
  return open(world, [&] {
    const std::string text = text_of(json, "json");
    return std::make_unique<evo_world>(
        evo_world{evo::read_evogym_world(evo::Node::json(text, "world"))});
  });
}

void evo_world_free(evo_world* world) { close(world); }

int evo_world_add(evo_world* world, const char* name, const uint8_t* voxels, int32_t rows,
                  int32_t columns, const int32_t* links, size_t link_count, int32_t x, int32_t y) {
  return guarded([&] {
    evo::World& built = object_of(world).world;
    const std::string called = text_of(name, "name");
    if (called.empty()) throw evo::Error(Failure::usage, "an object needs a name");
    for (const evo::Object& object : built.objects)
      if (object.name == called)
        throw evo::error(Failure::usage, "the world has an object '{}' already", called);
    check_position(x, y);
    evo::Object object{called, body_of(voxels, rows, columns, links, link_count), x, y};
    if (const auto fault = evo::defect(object.body, false))
      throw evo::error(Failure::usage, "object '{}': {}", called, *fault);
    built.objects.push_back(std::move(object));
  });
}

int evo_world_stiffen(evo_world* world, const char* name, const double* factors, size_t count) {
  return guarded([&] {
    const auto found = find_object(object_of(world).world, text_of(name, "name"));
    if (count > 0) target(factors, "factors");
    found->body = evo::with_stiffness(found->body, std::vector(factors, factors + count));
  });
}

int evo_world_move(evo_world* world, const char* name, int32_t x, int32_t y) {
  return guarded([&] {
    const auto found = find_object(object_of(world).world, text_of(name, "name"));
    check_position(x, y);
    found->x = x;
    found->y = y;
  });
}

int evo_world_remove(evo_world* world, const char* name) {
  return guarded([&] {
    evo::World& built = object_of(world).world;
    built.objects.erase(find_object(built, text_of(name, "name")));
  });
}

int evo_world_json(const evo_world* world, char** json) {
  return guarded([&] { give(evo::evogym_world_to_json(object_of(world).world), json, "json"); });
}
