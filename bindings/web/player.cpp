#include "bindings/web/player.h"

#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bindings/web/wasm/files.h"
#include "formats/io/data_folders.h"
#include "formats/robot/evogym.h"
#include "formats/robot/robot.h"
#include "formats/rollout/episodes.h"
#include "formats/task/draft.h"
#include "formats/task/pieces.h"
#include "formats/task/task.h"
#include "formats/training/controller_json.h"
#include "libevo/base/error.h"
#include "libevo/body/operators.h"
#include "libevo/control/actor.h"

namespace evo::web {
namespace {

std::string& answer() {
  static std::string text;
  return text;
}

// Does the work with an empty answer, which becomes the error's line where it throws.
template <typename Work>
int guarded(const Work& work) {
  answer().clear();
  try {
    work();
    return 0;
  } catch (const Error& failure) {
    answer() = failure.what();
    return static_cast<int>(failure.kind());
  } catch (const std::bad_alloc&) {
    answer() = "out of memory";
    return static_cast<int>(Failure::work);
  }
}

const DataFolders& folders() {  // of the files given
  static const DataFolders given{"tasks"};
  return given;
}

TaskSpec read_task(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '{') {
    const World world = read_evogym_world(Node::json(text, "world"));
    return parse_task(draft_task(world, "world"), "the task of this world", {}, folders());
  }
  if (text.find('\n') == std::string::npos) return load_task(text, folders());
  return parse_task(text, "task", {}, folders());
}

Robot one_robot(const std::string& text) {
  std::vector<Robot> robots = parse_robots(text, "robot");
  if (robots.empty()) throw Error(Failure::data, "robot: there is none in this text");
  return std::move(robots.front());
}

Json facts(const TaskSpec& task) {
  Json observation = Json::array();
  for (const ObservationPart& part : task.observation)
    observation.push_back(part_to_words(part, task.physics));
  Json reward = Json::array();
  for (const RewardTerm& term : task.reward) {
    const TermWords words = term_to_words(term.term, task.physics);
    reward.push_back({{"formula", words.formula},
                      {"words", words.words},
                      {"weight", term.weight},
                      {"when", conditions_to_words(term.when, task.physics)}});
  }
  Json rules = Json::array();
  for (const Rule& rule : task.rules)
    rules.push_back({{"when", conditions_to_words(rule.when, task.physics)},
                     {"reward", rule.reward},
                     {"ends", rule.terminate}});
  if (task.step_cost != 0.0)
    rules.push_back({{"when", "every step"}, {"reward", -task.step_cost}, {"ends", false}});
  return {{"name", task.name},
          {"description", task.description},
          {"difficulty", task.difficulty},
          {"notes", task.notes},
          {"steps", task.episode_steps},
          {"yaml", task.source},
          {"observation", observation},
          {"reward", reward},
          {"rules", rules},
          {"folding", task.folding_reward}};
}

// The same task with a part of its reward only.
TaskSpec with_reward(TaskSpec task, std::vector<RewardTerm> terms, std::vector<Rule> rules) {
  task.reward = std::move(terms);
  task.rules = std::move(rules);
  task.folding_reward = 0.0;
  task.step_cost = 0.0;
  return task;
}

// What one part of the reward adds to the return.
struct Share {
  std::unique_ptr<Arena> arena;  // of the task with this part only
  Episode episode;
};

enum class Ended { no, by_rule, by_time, with_sequence, folded, at_goal };

// The entries of evo_counts().
enum Count : std::size_t { total, reward, steps, ended, folding, rules, terms };

}  // namespace
}  // namespace evo::web

using namespace evo::web;  // NOLINT(google-build-using-namespace)

struct evo_player {
  evo_player(evo::TaskSpec task, evo::Robot robot_)
      : robot(std::move(robot_)), arena(std::move(task), robot.body), env(arena, 1) {
    const evo::TaskSpec& spec = arena.task();
    evo::TaskSpec rules = with_reward(spec, {}, spec.rules);
    rules.step_cost = spec.step_cost;  // a step's cost is shown among what the rules give
    shares.push_back(share(std::move(rules)));
    for (const evo::RewardTerm& term : spec.reward)
      shares.push_back(share(with_reward(spec, {term}, {})));
    counts.resize(Count::terms + spec.reward.size());
    targets.resize(static_cast<std::size_t>(arena.action_length()), 1.0);
    controller = evo::travelling_wave(arena.action_length(), 0.0, 1.0, 0.0);
    std::get<evo::SineController>(controller).middle = 1.0;
    actor.emplace(controller, arena);
  }

  Share share(evo::TaskSpec task) const {
    return {std::make_unique<evo::Arena>(std::move(task), robot.body), {}};
  }

  void control(const evo::Node& document) {
    evo::TrainedController read =
        document.at("kind").string() == "wave"
            ? evo::travelling_wave(arena.action_length(), document.at("amplitude").number(),
                                   document.at("period").number(), document.at("phase").number())
            : evo::read_controller(document);
    (void)evo::Actor(read, arena);  // refuses what does not fit, and the old one acts on
    controller = std::move(read);
    actor.emplace(controller, arena);
  }

  void reset(std::uint64_t seed, const std::optional<evo::Draws>& given) {
    const evo::Draws draws = given ? *given : arena.draw(seed, 0);
    env.reset(0, {draws, 0.0, 0});
    for (Share& each : shares) each.episode = {draws, 0, 0, {}};
    std::fill(counts.begin(), counts.end(), 0.0);
    std::fill(targets.begin(), targets.end(), 1.0);
    look(now);
  }

  void look(evo::Snapshot& snapshot) const {
    const auto positions = env.positions(0);
    const auto velocities = env.velocities(0);
    snapshot.positions.assign(positions.begin(), positions.end());
    snapshot.velocities.assign(velocities.begin(), velocities.end());
  }

  bool over() const { return counts[Count::ended] != 0.0; }

  void step() {
    const int t = env.steps(0);
    actor->act(env, 0, {&t, 1}, targets);
    std::swap(before, now);
    env.step(targets);
    evo::require_stable(env);
    look(now);
    const bool folded = env.status(0) == evo::LaneStatus::self_folding;
    counts[Count::reward] = env.rewards()[0];
    counts[Count::total] += env.rewards()[0];
    counts[Count::steps] = env.steps(0);
    if (folded) counts[Count::folding] += arena.task().folding_reward;
    const double ruled = counts[Count::rules] - arena.task().step_cost;
    for (std::size_t i = 0; i < shares.size(); ++i)
      counts[Count::rules + i] += evo::judge(*shares[i].arena, env.model(0), shares[i].episode,
                                             before, now, targets, folded)
                                      .reward;
    counts[Count::ended] = static_cast<double>(how_it_ended(folded, counts[Count::rules] > ruled));
  }

  Ended how_it_ended(bool folded, bool paid) const {
    if (folded) return Ended::folded;
    if (env.terminated()[0] != 0) return paid ? Ended::at_goal : Ended::by_rule;
    if (env.truncated()[0] != 0) return Ended::by_time;
    const auto* sequence = std::get_if<evo::ReplayController>(&controller);
    if (sequence != nullptr && env.steps(0) >= sequence->steps()) return Ended::with_sequence;
    return Ended::no;
  }

  evo::Robot robot;
  evo::Arena arena;
  evo::VecEnv env;
  evo::TrainedController controller;
  std::optional<evo::Actor> actor;  // of `controller`
  std::vector<Share> shares;        // of the rules, then of each term
  evo::Snapshot before;
  evo::Snapshot now;
  std::vector<double> targets;
  std::vector<double> counts;
};

const char* evo_answer() { return answer().c_str(); }

void evo_give_file(const char* path, const char* text) { evo::given_files()[path] = text; }

int evo_robot(const char* text) {
  return guarded([&] { answer() = evo::robot_to_line(one_robot(text)); });
}

int evo_sample(int rows, int columns, std::uint32_t seed) {
  return guarded([&] {
    evo::Stream stream(seed, "page/sample");
    answer() = evo::robot_to_line(
        evo::Robot(evo::sample_body(rows, columns, evo::default_weights, stream)));
  });
}

int evo_mutate(const char* robot, double rate, std::uint32_t seed) {
  return guarded([&] {
    const evo::Robot parent = one_robot(robot);
    evo::Stream stream(seed, "page/mutate");
    evo::MutationSettings settings;
    settings.rate = rate;
    const std::optional<evo::Body> child = evo::mutate(parent.body, settings, stream);
    answer() = evo::robot_to_line(child ? evo::Robot(*child) : parent);
  });
}

int evo_task(const char* task) {
  return guarded([&] { answer() = evo::compact(facts(read_task(task))); });
}

evo_player* evo_open(const char* task, const char* robot) {
  evo_player* opened = nullptr;
  guarded(
      [&] { opened = std::make_unique<evo_player>(read_task(task), one_robot(robot)).release(); });
  return opened;
}

void evo_close(evo_player* player) { delete player; }  // NOLINT(cppcoreguidelines-owning-memory)

int evo_describe(const evo_player* player) {
  return guarded([&] {
    const evo::Arena& arena = player->arena;
    const evo::Model& model = arena.model();
    evo::Json objects = evo::Json::array();
    for (const evo::ModelObject& object : model.objects())
      objects.push_back({{"name", object.name},
                         {"first", object.first_point},
                         {"points", object.points},
                         {"static", object.is_static}});
    evo::Json cells = evo::Json::array();
    for (const evo::ModelCell& cell : model.cells())
      cells.push_back({cell.object, std::string(1, evo::letter(cell.type)), cell.points[0],
                       cell.points[1], cell.points[2], cell.points[3]});
    answer() = evo::compact({{"task", arena.task().name},
                             {"steps", arena.task().episode_steps},
                             {"points", model.points()},
                             {"voxel", arena.task().physics.voxel_length},
                             {"objects", objects},
                             {"cells", cells},
                             {"follow", arena.task().follow},
                             {"terms", arena.task().reward.size()}});
  });
}

int evo_control(evo_player* player, const char* controller) {
  return guarded([&] { player->control(evo::Node::json(controller, "controller")); });
}

int evo_reset(evo_player* player, std::uint32_t seed, const char* draws) {
  return guarded([&] {
    std::optional<evo::Draws> given;
    if (draws != nullptr)
      given = evo::read_draws(evo::Node::json(draws, "draws"), player->arena.task());
    player->reset(seed, given);
  });
}

int evo_step(evo_player* player, int most) {
  return guarded([&] {
    for (int taken = 0; taken < most && !player->over(); ++taken) player->step();
  });
}

const double* evo_positions(const evo_player* player) {
  return reinterpret_cast<const double*>(player->env.positions(0).data());
}
const double* evo_counts(const evo_player* player) { return player->counts.data(); }
