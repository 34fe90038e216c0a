#include "formats/rollout/ending.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "formats/task/physics_profile.h"
#include "libevo/task/measure.h"

namespace evo {
namespace {

// The last centre of an object, voxels; nothing for one that is not there.
std::optional<Vec2> last_centre(const Rollout& rollout, const RolloutEpisode& episode,
                                const std::string& name) {
  const double voxel = recorded_physics(rollout).voxel_length;
  for (const ModelObject& object : rollout.world.objects) {
    if (object.name != name || object.points == 0) continue;
    const auto points = static_cast<std::size_t>(rollout.points);
    if (episode.positions.size() < points) return std::nullopt;
    const Vec2* last = &episode.positions[episode.positions.size() - points];
    return mean(PointRange{object.first_point, object.points}.of(std::span(last, points))) / voxel;
  }
  return std::nullopt;
}

// Whether a condition on a place holds at the end, and how it is said; nothing for
// other conditions, and for places that are themselves measured.
struct Judged {
  bool holds = false;
  std::string text;
};
std::optional<Judged> judge(const Node& condition, const Rollout& rollout,
                            const RolloutEpisode& episode) {
  const auto position = condition.find("position");
  if (!position) return std::nullopt;
  const auto of = position->find("of");
  const auto axis = position->find("axis");
  if (!of || !axis) return std::nullopt;
  const auto centre = last_centre(rollout, episode, of->string());
  if (!centre) return std::nullopt;
  const double value = axis->string() == "x" ? centre->x : centre->y;
  for (const auto& [key, sign] :
       {std::pair{"above", 1.0}, {"at_least", 1.0}, {"below", -1.0}, {"at_most", -1.0}}) {
    const auto bound = position->find(key);
    if (!bound || !bound->is_scalar()) continue;
    const double limit = bound->number();
    constexpr double close = 1e-6;
    const char* where = axis->string() == "x" ? (sign > 0 ? "beyond x =" : "left of x =")
                                              : (sign > 0 ? "higher than" : "lower than");
    return Judged{sign * (value - limit) >= -close,
                  fmt::format("{} {} {:.4g}", of->string(), where, limit)};
  }
  return std::nullopt;
}

struct RuleThatHolds {
  double reward = 0;
  std::string text;
};

std::optional<RuleThatHolds> rule_of(const Rollout& rollout, const RolloutEpisode& episode) {
  const auto rules = task_value(rollout, "rules");
  if (!rules || !rules->is_sequence()) return std::nullopt;
  std::optional<RuleThatHolds> found;
  for (const Node& rule : rules->items()) {
    const auto when = rule.find("when");
    if (!when) continue;
    const std::vector<Node> conditions =
        when->is_sequence() ? when->items() : std::vector<Node>{*when};
    bool all = true;
    std::string text;
    for (const Node& condition : conditions) {
      const auto judged = judge(condition, rollout, episode);
      all = all && judged && judged->holds;
      if (judged) text += (text.empty() ? "" : ", ") + judged->text;
    }
    if (!all) continue;
    const auto reward = rule.find("reward");
    const double worth = reward ? reward->number() : 0.0;
    if (!found || std::abs(worth) > std::abs(found->reward)) found = RuleThatHolds{worth, text};
  }
  return found;
}

bool is_height(const Node& reward) {
  if (reward.find("when")) return false;
  if (const auto weight = reward.find("weight"); weight && weight->number() < 0) return false;
  return std::ranges::any_of(std::array{"displacement", "extent"}, [&](const char* what) {
    const auto measured = reward.find(what);
    const auto axis = measured ? measured->find("axis") : std::nullopt;
    return axis && axis->string() == "y";
  });
}

bool rewards_any(const Rollout& rollout, bool (*what)(const Node&)) {
  const auto rewards = task_value(rollout, "reward");
  return rewards && rewards->is_sequence() && std::ranges::any_of(rewards->items(), what);
}

}  // namespace

Physics recorded_physics(const Rollout& rollout) {
  if (rollout.physics_yaml.empty()) return {};
  return physics_profiles().read(Node::yaml(rollout.physics_yaml, "physics of the rollout"), {},
                                 {});
}

std::optional<Node> task_value(const Rollout& rollout, const char* key) {
  if (rollout.task_yaml.empty()) return std::nullopt;
  return Node::yaml(rollout.task_yaml, "task of the rollout").find(key);
}

int hold_of(const Rollout& rollout) {
  const auto hold = task_value(rollout, "hold");
  return hold ? hold->integer(1, std::numeric_limits<int>::max()) : 1;
}

double steps_per_second(const Rollout& rollout) { return 50.0 / hold_of(rollout); }

bool rewards_height(const Rollout& rollout) { return rewards_any(rollout, is_height); }

bool rewards_turning(const Rollout& rollout) {
  return rewards_any(rollout, [](const Node& part) { return part.find("rotation").has_value(); });
}

Ending ending(const Rollout& rollout, const RolloutEpisode& episode) {
  const auto last = [](const std::vector<std::uint8_t>& flags) {
    return !flags.empty() && flags.back() != 0;
  };
  if (!last(episode.terminations))
    return last(episode.truncations) ? Ending{Ending::Kind::limit, "time is up"}
                                     : Ending{Ending::Kind::cut, "end of the recording"};
  if (const auto rule = rule_of(rollout, episode)) {
    if (rule->reward > 0) return {Ending::Kind::goal, "goal reached: " + rule->text};
    return {rule->reward < 0 ? Ending::Kind::failure : Ending::Kind::rule,
            (rule->reward < 0 ? "failed: " : "the task ends here: ") + rule->text};
  }
  constexpr double punished = -2.0;  // folding costs 3, a step's other rewards far less
  if (!episode.rewards.empty() && episode.rewards.back() < punished)
    return {Ending::Kind::failure, "failed: folded up"};
  return {Ending::Kind::rule, "ended by a rule of the task"};
}

}  // namespace evo
