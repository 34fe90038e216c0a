#include "render/report/robot_data.h"

#include <fmt/format.h>

#include <cmath>

#include "formats/run/settings.h"
#include "render/report/lineage.h"
#include "render/report/markup.h"
#include "render/report/parts.h"

namespace evo::report {
namespace {

Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  // More than a chart shows, and enough to be rounded once more as the page's text was.
  return Json::parse(fmt::format("{:.7g}", value), nullptr, false);
}

Json facts_of(const Run& run, std::size_t k) {
  const Entry& entry = run.robots[k];
  const Body& body = entry.robot.body;
  Json facts = Json::array();
  const auto add = [&](const char* name, const std::string& value) {
    facts.push_back({name, value});
  };
  add("fitness", entry.fitness ? shown(entry.fitness) : "failed: " + entry.failure);
  if (const auto& score = entry.training.final_score)
    add("from perturbed starts", with_error(score->mean, score->standard_error));
  add(run.is_evaluated() ? "scored as" : "trained as",
      fmt::format("robot {} of {}, in generation {}", k + 1, run.robots.size(), entry.generation));
  if (entry.sharing)
    add("controller", fmt::format("that of all robots of generation {}", *entry.sharing));
  if (entry.training.steps > 0)
    add("best evaluation",
        fmt::format("after {} of {} steps", entry.training.best_step, entry.training.steps));
  add("body", fmt::format("{}x{}, {}, {}", body.rows, body.cols,
                          count_of(static_cast<std::size_t>(count_voxels(body)), "voxel"),
                          count_of(static_cast<std::size_t>(count_actuators(body)), "actuator")));
  if (!entry.training.created_by.empty()) add("made by", entry.training.created_by);
  return facts;
}

Json robot_data(const Run& run, std::size_t k, const std::vector<std::string>& children) {
  const Entry& entry = run.robots[k];
  const std::string policy = shell_word(run.folder + "/" + entry.policy);
  Json robot{{"fitness", entry.fitness ? rounded(*entry.fitness) : Json()},
             {"facts", facts_of(run, k)},
             {"parents", entry.robot.parents()},
             {"children", children}};
  Json curve = Json::array();
  for (const CurvePoint& point : entry.training.curve)
    curve.push_back({point.step, rounded(point.evaluation), rounded(point.best)});
  robot["curve"] = std::move(curve);
  Json log = Json::object();
  for (const LogSeries& series : entry.training.log) {
    Json points = Json::array();
    for (const auto& [step, value] : series.points) points.push_back({step, rounded(value)});
    log[series.name] = std::move(points);
  }
  robot["log"] = std::move(log);
  robot["commands"] =
      entry.policy.empty()
          ? Json::array()
          : Json::array(
                {fmt::format("evo-inspect {}", policy),
                 entry.sharing
                     ? fmt::format("jq -c 'select(.id == \"{0}\")' {1} | evo-eval --policy {2} "
                                   "--rollout {0}.h5",
                                   entry.robot.id,
                                   shell_word(fmt::format("{}/gen-{:03}/scores.jsonl", run.folder,
                                                          *entry.sharing)),
                                   policy)
                     : fmt::format("evo-eval {0} --policy {0} --rollout {1}.h5", policy,
                                   entry.robot.id),
                 fmt::format("evo-render {0}.h5 -o {0}.mp4", entry.robot.id)});
  if (const auto replay = run.replays.find(k); replay != run.replays.end())
    robot["replay"] = replay->second;
  return robot;
}

}  // namespace

Json robots_data(const Run& run) {
  std::vector<std::vector<std::string>> children(run.robots.size());
  for (const std::size_t robot : run.shown)
    for (const std::string& id : run.robots[robot].robot.parents())
      if (const auto known = run.by_id.find(id); known != run.by_id.end())
        children[known->second].push_back(run.robots[robot].robot.id);
  Json robots = Json::object();
  for (const std::size_t k : run.shown)
    robots[run.robots[k].robot.id] = robot_data(run, k, children[k]);
  return {{"world", run.world}, {"robots", std::move(robots)}};
}

}  // namespace evo::report
