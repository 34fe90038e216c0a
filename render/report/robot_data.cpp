#include "render/report/robot_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/run/settings.h"
#include "libevo/base/join.h"

namespace evo::report {
namespace {

Json rounded_or_null(double value) {
  if (!std::isfinite(value)) return nullptr;
  // More than a chart shows, and enough to be rounded once more as the page's text was.
  return Json::parse(fmt::format("{:.7g}", value), nullptr, false);
}

// Sides between neighbours that are not linked, as a path.
std::string open_sides(const Body& body) {
  std::string path;
  for (const Link& side : full_links(body.rows, body.cols, body.cells)) {
    if (std::binary_search(body.links.begin(), body.links.end(), side)) continue;
    path += fmt::format("M{} {}{}", side.b % body.cols, side.b / body.cols,
                        side.b == side.a + 1 ? "v1" : "h1");
  }
  return path;
}

// The number of a genome's nodes and connections; nothing for robots without genome.
Json genes(const Robot& robot) {
  const auto genome = robot.document.find("genome");
  if (genome == robot.document.end() || !genome->is_object()) return nullptr;
  Json counts = Json::array();
  for (const char* which : {"nodes", "connections"}) {
    const auto list = genome->find(which);
    if (list == genome->end() || !list->is_array()) return nullptr;
    counts.push_back(list->size());
  }
  return counts;
}

// Its curve, and what the algorithm logged beside it, against steps.
Json trainings(const Training& training) {
  Json charts = Json::object();
  for (const CurvePoint& point : training.curve)
    charts["return"].push_back({point.step, rounded_or_null(point.evaluation)});
  for (const LogSeries& series : training.log)
    for (const auto& [step, value] : series.points)
      charts[series.name].push_back({step, rounded_or_null(value)});
  return charts;
}

Json commands(const Run& run, const Entry& entry) {
  const std::string policy = shell_word(run.folder + "/" + entry.policy);
  const std::string& id = entry.robot.id;
  const std::string play =
      entry.sharing
          ? fmt::format(
                "jq -c 'select(.id == \"{0}\")' {1} | evo-eval --policy {2} --rollout {0}.h5", id,
                shell_word(fmt::format("{}/gen-{:03}/scores.jsonl", run.folder, *entry.sharing)),
                policy)
          : fmt::format("evo-eval {0} --policy {0} --rollout {1}.h5", policy, id);
  return {fmt::format("evo-inspect {}", policy), play,
          fmt::format("evo-render {0}.h5 -o {0}.mp4", id)};
}

// What is not there is left out.
Json robot_data(const Run& run, std::size_t k) {
  const Entry& entry = run.robots[k];
  const Training& training = entry.training;
  Json robot{{"fitness", entry.fitness ? rounded_or_null(*entry.fitness) : Json()},
             {"number", k + 1},
             {"generation", entry.generation},
             {"body", joined(entry.robot.body.to_rows(), "/")},
             {"parents", entry.robot.parents()}};
  if (!entry.fitness) robot["failure"] = entry.failure;
  if (const std::string open = open_sides(entry.robot.body); !open.empty()) robot["open"] = open;
  if (Json counts = genes(entry.robot); !counts.is_null()) robot["genes"] = std::move(counts);
  if (training.final_score)
    robot["score"] = {rounded_or_null(training.final_score->mean),
                      rounded_or_null(training.final_score->standard_error)};
  if (entry.sharing) robot["sharing"] = *entry.sharing;
  if (training.steps > 0) robot["best"] = {training.best_step, training.steps};
  if (!training.created_by.empty()) robot["tool"] = training.created_by;
  if (Json charts = trainings(training); !charts.empty()) robot["charts"] = std::move(charts);
  if (!entry.policy.empty()) robot["commands"] = commands(run, entry);
  if (const auto replay = run.replays.find(k); replay != run.replays.end())
    robot["replay"] = replay->second;
  return robot;
}

}  // namespace

Json robots_data(const Run& run) {
  Json robots = Json::object();
  for (const std::size_t k : run.shown) robots[run.robots[k].robot.id] = robot_data(run, k);
  return {{"world", run.world},
          {"done", run.done()},
          {"decimals", run.decimals()},
          {"robots", std::move(robots)}};
}

}  // namespace evo::report
