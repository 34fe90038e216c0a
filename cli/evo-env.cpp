// evo-env: environments that any program can step, over pipes: a request a line, an answer a
// line, both JSON (docs/evo-env.md).
#include <algorithm>
#include <iostream>
#include <memory>
#include <numeric>

#include "bindings/c/session.h"
#include "cli/command.h"
#include "cli/robots.h"
#include "cli/task_options.h"
#include "formats/io/base64.h"
#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/json.h"
#include "formats/rollout/episodes.h"
#include "formats/task/physics_profile.h"
#include "formats/training/policy_json.h"

namespace {

using namespace evo;

constexpr std::size_t longest_request = std::size_t{64} << 20U;  // bytes
constexpr int patience = 1000;  // lines in a row that are no JSON: no client sends them

// The first thing a client hears.
Json describe(const Session& session) {
  const TaskSpec& task = session.task();
  Json robots = Json::array();
  for (std::size_t r = 0; r < session.robots().size(); ++r) {
    const Robot& robot = session.robots()[r];
    const Arena& arena = session.envs().arena(static_cast<int>(r) * session.per_robot());
    robots.push_back({{"id", robot.id},
                      {"rows", robot.body.rows},
                      {"cols", robot.body.cols},
                      {"observation_length", arena.observation_length()},
                      {"action_length", arena.action_length()},
                      {"observation_layout", layout_to_json(arena.layout())}});
  }
  return {{"format", format::env.name},
          {"version", format::env.version},
          {"created_by", cli::created_by("evo-env")},
          {"task", task.name},
          {"episode_steps", task.episode_steps},
          {"environments_per_robot", session.per_robot()},
          {"action_low", task.physics.min_target},
          {"action_high", task.physics.max_target},
          {"robots", std::move(robots)}};
}

// One value for each of these environments.
Json state(const Session& session, const std::vector<int>& environments) {
  const VecEnv& envs = session.envs();
  Json answer{{"environments", environments}};
  const auto add = [&](const char* name, const auto& of) {
    Json& list = answer[name] = Json::array();
    for (const int e : environments) list.push_back(of(e));
  };
  add("observations", [&](int e) {
    const auto first =
        envs.observations().begin() + static_cast<std::ptrdiff_t>(envs.observation_offset(e));
    return std::vector<double>(first, first + envs.arena(e).observation_length());
  });
  add("rewards", [&](int e) { return session.reward(e); });
  add("terminated", [&](int e) { return envs.terminated()[static_cast<std::size_t>(e)] != 0; });
  add("truncated", [&](int e) { return envs.truncated()[static_cast<std::size_t>(e)] != 0; });
  add("status", [&](int e) { return to_string(session.status(e)); });
  add("steps", [&](int e) { return envs.steps(e); });
  return answer;
}

// The list of this name, each environment at most once; all when there is none.
std::vector<int> chosen_environments(const Session& session, const Node& object) {
  std::vector<int> chosen;
  const auto list = object.find("environments");
  if (!list) {
    chosen.resize(static_cast<std::size_t>(session.environments()));
    std::iota(chosen.begin(), chosen.end(), 0);
    return chosen;
  }
  for (const Node& item : list->items()) {
    chosen.push_back(item.integer(0, session.environments() - 1));
    if (std::count(chosen.begin(), chosen.end(), chosen.back()) > 1)
      throw item.error(fmt::format("environment {} is there twice", chosen.back()));
  }
  if (chosen.empty()) throw list->error("no environment is named");
  return chosen;
}

Json reset(Session& session, const Node& request) {
  const Node wanted = request.at("reset");
  const Mapping fields(wanted, "reset", {"environments", "seed", "episode", "draws", "jitter"});
  ResetRequest start;
  start.environments = chosen_environments(session, wanted);
  if (const auto seed = fields.find("seed")) start.seed = seed->natural();
  if (const auto episode = fields.find("episode")) start.episode = episode->natural();
  if (const auto jitter = fields.find("jitter")) start.jitter = jitter->number();
  if (const auto draws = fields.find("draws")) start.draws = read_draws(*draws, session.task());
  session.reset(start);
  return state(session, start.environments);
}

Json step(Session& session, const Node& request) {
  const std::vector<int> environments = chosen_environments(session, request);
  const Node step = request.at("step");
  const std::vector<Node> rows = step.items();
  if (rows.size() != environments.size())
    throw step.error(
        fmt::format("{} rows of actions for {} environments", rows.size(), environments.size()));
  std::vector<double> actions(session.action_values());
  std::vector<std::uint8_t> active(static_cast<std::size_t>(session.environments()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int e = environments[i];
    const auto length = static_cast<std::size_t>(session.envs().arena(e).action_length());
    const std::vector<double> row = rows[i].numbers();
    if (row.size() != length)
      throw rows[i].error(fmt::format("{} actions are expected, found {}", length, row.size()));
    std::copy(row.begin(), row.end(),
              actions.begin() + static_cast<std::ptrdiff_t>(session.envs().action_offset(e)));
    active[static_cast<std::size_t>(e)] = 1;
  }
  session.step(actions, active);
  return state(session, environments);
}

Json save(Session& session, const Node& request) {
  const Mapping fields(request.at("save"), "save", {"environments"});
  const std::vector<int> environments = chosen_environments(session, fields.node());
  Json states = Json::array();
  for (const int e : environments) {
    const std::vector<std::uint8_t> bytes = session.save(e);
    states.push_back(base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  }
  return {{"environments", environments}, {"states", std::move(states)}};
}

Json restore(Session& session, const Node& request) {
  const Mapping fields(request.at("restore"), "restore", {"environments", "states"});
  const std::vector<int> environments = chosen_environments(session, fields.node());
  const Node texts = fields.at("states");
  std::vector<std::vector<std::uint8_t>> states;
  for (const Node& text : texts.items()) {
    auto bytes = from_base64(text.string());
    if (!bytes) throw text.error("a saved state is expected, found " + text.found());
    states.push_back(std::move(*bytes));
  }
  if (states.size() != environments.size())
    throw texts.error(
        fmt::format("{} states for {} environments", states.size(), environments.size()));
  std::vector<Session::Restored> restored;
  for (std::size_t i = 0; i < states.size(); ++i) restored.push_back({environments[i], states[i]});
  session.restore(restored);
  return state(session, environments);
}

Json positions(Session& session, const Node& request) {
  const auto pairs = [](std::span<const Vec2> points) {
    std::vector<std::pair<double, double>> list;
    for (const Vec2& p : points) list.emplace_back(p.x, p.y);
    return list;
  };
  const Mapping fields(request.at("positions"), "positions", {"environments"});
  const VecEnv& envs = session.envs();
  Json list = Json::array();
  for (const int e : chosen_environments(session, fields.node())) {
    Json objects = Json::array();
    for (const ModelObject& object : envs.model(e).objects())
      objects.push_back(
          {{"name", object.name}, {"first_point", object.first_point}, {"points", object.points}});
    list.push_back({{"environment", e},
                    {"objects", std::move(objects)},
                    {"positions", pairs(envs.positions(e))},
                    {"velocities", pairs(envs.velocities(e))}});
  }
  return {{"positions", std::move(list)}};
}

// What a policy file keeps of the task.
Json task_of(Session& session, const Node& request) {
  const Mapping none(request.at("task"), "task", {});
  return {{"task", session.task().name},
          {"task_yaml", session.task().source},
          {"physics_yaml", physics_profiles().to_yaml(session.task().physics)}};
}

struct Request {
  std::string name;
  Json (*answer)(Session&, const Node&);
};

// Throws Error unless it is a request that can be fulfilled; nothing has changed
// then.
Json answer(Session& session, const Node& request) {
  static const std::vector<Request> all{{"reset", reset},         {"step", step},
                                        {"save", save},           {"restore", restore},
                                        {"positions", positions}, {"task", task_of}};
  std::vector<std::string> names;
  for (const auto& [name, respond] : all) {
    names.push_back(name);
    if (!request.find(name)) continue;
    std::vector<std::string> allowed{name};
    if (name == "step") allowed.emplace_back("environments");
    const Mapping fields(request, "request", allowed);
    return respond(session, request);
  }
  const Mapping fields(request, "request", names);
  throw request.error(fmt::format("one of these is expected: {}", fmt::join(names, ", ")));
}

// Until the input ends. Throws Error(data) for a line that is too long, and for an input
// that is none of a client.
void serve(Session& session) {
  LineWriter out{std::string(standard_stream)};
  out.line(compact(describe(session)));
  std::ios::sync_with_stdio(false);
  const auto line = std::make_unique_for_overwrite<char[]>(longest_request);
  int strange = 0;  // lines in a row
  for (int number = 1; std::cin.getline(line.get(), longest_request); ++number) {
    if (++strange > patience)
      throw error(Failure::data, "standard input: {} lines in a row are no JSON", patience);
    const auto taken = static_cast<std::size_t>(std::cin.gcount());  // with the line's end
    const std::string_view text(line.get(), std::cin.eof() ? taken : taken - 1);
    if (text.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    const std::string where = fmt::format("request {}", number);
    try {
      const Node request = Node::json(text, where);
      strange = 0;
      out.line(compact(answer(session, request)));
    } catch (const Error& failure) {
      if (failure.kind() == Failure::io) throw;
      const std::string what = failure.what();  // of a document, it begins with its place
      out.line(compact({{"error", what.starts_with(where) ? what : where + ": " + what}}));
    }
  }
  if (!std::cin.eof())
    throw error(Failure::data, "standard input: a request is longer than {} bytes",
                longest_request);
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-env");
  cli::TaskOptions task;
  int envs = 1;
  std::vector<std::string> files;
  command.arguments(
      files, "ROBOT...",
      {{"ROBOT...", "files of robots; standard input carries the requests (docs/evo-env.md)"}});
  task.add_to(command);
  command.option("--envs", envs, "N", "environments of each robot, stepped together");
  command.seed_option();
  command.jobs_option();
  command.example("echo '{\"reset\":{\"seed\":1}}' | evo-env --task Walker-v0 walker.json",
                  "what the environment is, and its first observation");
  command.example("evo-env --task Carrier-v0 --envs 16 -j 1 walker.json < requests.jsonl",
                  "sixteen environments of one robot, stepped together");

  return command.run(argc, argv, [&] {
    const TaskSpec spec = task.load();
    if (files.empty() || std::find(files.begin(), files.end(), standard_stream) != files.end())
      throw Error(Failure::usage, "name a file of robots: standard input carries the requests");
    std::vector<Robot> robots = cli::read_robots(files);
    if (robots.empty()) throw error(Failure::data, "{}: there are no robots", files.front());
    Session session(spec, std::move(robots), envs, command.seed, command.jobs);
    serve(session);
    return 0;
  });
}
