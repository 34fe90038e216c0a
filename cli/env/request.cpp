#include "cli/env/request.h"

#include <algorithm>
#include <numeric>

#include "cli/command.h"
#include "formats/io/base64.h"
#include "formats/io/format.h"
#include "formats/io/json_object.h"
#include "formats/task/physics_profile.h"
#include "training/episodes.h"

namespace evo::cli {
namespace {

constexpr int default_width = 600;  // of pictures, as the benchmark's
constexpr int default_height = 300;

// A misspelt field would otherwise be left out without a word.
void check_fields(const Json& object, const std::string& path,
                  const std::vector<std::string>& known) {
  const JsonObject checked(object, path);
  for (const auto& [name, value] : object.items())
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw refusal(checked.path_of(name), "is not known{}; there may be: {}",
                    did_you_mean(name, known),
                    known.empty() ? "nothing" : fmt::format("{}", fmt::join(known, ", ")));
}

std::uint64_t natural(const Json& value, const std::string& path) {
  if (!value.is_number_unsigned())
    throw refusal(path, "expected a whole number from 0, found {}", shown(value));
  return value.get<std::uint64_t>();
}

int environment_number(const Session& session, const Json& value, const std::string& path) {
  return json_integer(value, path, 0, session.environments() - 1);
}

// The list of this name, each environment at most once; all when there is none.
std::vector<int> chosen_environments(const Session& session, const Json& object,
                                     const std::string& path) {
  std::vector<int> chosen;
  if (!object.contains("environments")) {
    chosen.resize(static_cast<std::size_t>(session.environments()));
    std::iota(chosen.begin(), chosen.end(), 0);
    return chosen;
  }
  const JsonObject checked(object, path);
  const std::string list = checked.path_of("environments");
  std::vector<bool> seen(static_cast<std::size_t>(session.environments()));
  for (const Json& value : checked.array("environments")) {
    const int e = environment_number(session, value, list);
    if (seen[static_cast<std::size_t>(e)]) throw refusal(list, "names {} twice", e);
    seen[static_cast<std::size_t>(e)] = true;
    chosen.push_back(e);
  }
  if (chosen.empty()) throw refusal(list, "is empty");
  return chosen;
}

ResetRequest reset_request(const Session& session, const Json& wanted) {
  const std::string path = "/reset";
  check_fields(wanted, path, {"environments", "seed", "episode", "draws", "jitter"});
  ResetRequest request;
  request.environments = chosen_environments(session, wanted, path);
  if (wanted.contains("seed")) request.seed = natural(wanted["seed"], path + "/seed");
  if (wanted.contains("episode")) request.episode = natural(wanted["episode"], path + "/episode");
  if (wanted.contains("jitter")) request.jitter = JsonObject(wanted, path).number("jitter");
  if (wanted.contains("draws"))
    request.draws = draws_from_json(wanted["draws"], session.task(), path + "/draws");
  return request;
}

std::vector<std::pair<double, double>> pairs(std::span<const Vec2> points) {
  std::vector<std::pair<double, double>> result;
  for (const Vec2& p : points) result.emplace_back(p.x, p.y);
  return result;
}

// {request: [entry(e) for each environment wanted]}
template <typename Entry>
Json for_each_environment(const Session& session, const Json& wanted, const std::string& request,
                          Entry entry) {
  const std::string where = "/" + request;
  check_fields(wanted, where, {"environments"});
  Json list = Json::array();
  for (const int e : chosen_environments(session, wanted, where)) list.push_back(entry(e));
  return {{request, std::move(list)}};
}

Json positions_document(const Session& session, const Json& wanted) {
  const VecEnv& envs = session.envs();
  return for_each_environment(session, wanted, "positions", [&](int e) -> Json {
    Json objects = Json::array();
    for (const ModelObject& object : envs.model(e).objects())
      objects.push_back(
          {{"name", object.name}, {"first_point", object.first_point}, {"points", object.points}});
    return {{"environment", e},
            {"objects", std::move(objects)},
            {"positions", pairs(envs.positions(e))},
            {"velocities", pairs(envs.velocities(e))}};
  });
}

// [rows x columns]
template <typename T>
Json rows_of(std::span<const T> values, int rows, int columns) {
  Json list = Json::array();
  const auto width = static_cast<std::size_t>(columns);
  for (std::size_t r = 0; r < static_cast<std::size_t>(rows); ++r) {
    const auto row = values.subspan(r * width, width);
    list.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return list;
}

// What does not change of what voxels see.
Json voxels_document(const Session& session, const SessionVoxels& voxels, const Json& wanted) {
  return for_each_environment(session, wanted, "voxels", [&](int e) -> Json {
    const VoxelViews& views = voxels.of(e);
    const Matrix& fixed = views.fixed();
    Json links = Json::array();
    for (const auto& [voxel, other] : voxels.links(e)) links.push_back({voxel, other});
    return {{"environment", e},
            {"local_length", VoxelViews::local_length},
            {"task_length", views.task_length()},
            {"fixed", rows_of(std::span(fixed.data(), static_cast<std::size_t>(fixed.size())),
                              views.voxels(), VoxelViews::fixed_length)},
            {"actuators", views.actuators()},
            {"links", std::move(links)}};
  });
}

// What they see now.
Json look_document(const Session& session, const SessionVoxels& voxels, const Json& wanted) {
  return for_each_environment(session, wanted, "look", [&](int e) -> Json {
    const VoxelViews& views = voxels.of(e);
    std::vector<double> local(static_cast<std::size_t>(views.voxels() * VoxelViews::local_length));
    std::vector<double> task(static_cast<std::size_t>(views.task_length()));
    views.look(session.envs(), e, local, task);
    return {{"environment", e},
            {"local",
             rows_of(std::span<const double>(local), views.voxels(), VoxelViews::local_length)},
            {"task", task}};
  });
}

// What a policy file keeps of the task.
Json task_document(const Session& session) {
  return {{"task", session.task().name},
          {"task_yaml", session.task().source},
          {"physics_yaml", physics_to_yaml(session.task().physics)}};
}

}  // namespace

Json describe(const Session& session) {
  const TaskSpec& task = session.task();
  Json robots = Json::array();
  for (std::size_t r = 0; r < session.robots().size(); ++r) {
    const Robot& robot = session.robots()[r];
    const Arena& arena = session.envs().arena(static_cast<int>(r) * session.per_robot());
    Json layout = Json::array();
    for (const ObservationSlice& slice : arena.layout())
      layout.push_back({{"name", slice.name}, {"offset", slice.offset}, {"length", slice.length}});
    robots.push_back({{"id", robot.id},
                      {"rows", robot.body.rows},
                      {"cols", robot.body.cols},
                      {"observation_length", arena.observation_length()},
                      {"action_length", arena.action_length()},
                      {"observation_layout", std::move(layout)}});
  }
  return {{"format", format::env.name},
          {"version", format::env.version},
          {"created_by", created_by("evo-env")},
          {"task", task.name},
          {"episode_steps", task.episode_steps},
          {"environments_per_robot", session.per_robot()},
          {"action_low", task.physics.min_target},
          {"action_high", task.physics.max_target},
          {"robots", std::move(robots)}};
}

Json state_document(const Session& session, const std::vector<int>& environments) {
  Json observations = Json::array();
  Json rewards = Json::array();
  Json terminated = Json::array();
  Json truncated = Json::array();
  Json status = Json::array();
  Json steps = Json::array();
  for (const int e : environments) {
    const auto observation = session.observation(e);
    observations.push_back(std::vector<double>(observation.begin(), observation.end()));
    rewards.push_back(session.reward(e));
    terminated.push_back(session.terminated(e));
    truncated.push_back(session.truncated(e));
    status.push_back(to_string(session.status(e)));
    steps.push_back(session.envs().steps(e));
  }
  return {{"environments", environments},      {"observations", std::move(observations)},
          {"rewards", std::move(rewards)},     {"terminated", std::move(terminated)},
          {"truncated", std::move(truncated)}, {"status", std::move(status)},
          {"steps", std::move(steps)}};
}

Answer Requests::step(const Json& request) {
  check_fields(request, "", {"step", "environments"});
  Answer answer;
  answer.environments = chosen_environments(session_, request, "");
  const Json& rows = JsonObject(request, "").array("step");
  if (rows.size() != answer.environments.size())
    throw refusal("/step", "has {} rows of actions for {} environments", rows.size(),
                  answer.environments.size());
  actions_.assign(session_.action_values(), 0.0);
  active_.assign(static_cast<std::size_t>(session_.environments()), 0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto e = static_cast<std::size_t>(answer.environments[i]);
    const std::size_t begin = session_.envs().action_offset(answer.environments[i]);
    const auto length =
        static_cast<std::size_t>(session_.envs().arena(answer.environments[i]).action_length());
    const std::string path = fmt::format("/step/{}", i);
    if (!rows[i].is_array() || rows[i].size() != length)
      throw refusal(path, "expected {} actions, found {}", length, shown(rows[i]));
    for (std::size_t k = 0; k < length; ++k)
      actions_[begin + k] = json_number(rows[i][k], fmt::format("{}/{}", path, k));
    active_[e] = 1;
  }
  session_.step(actions_, active_);
  return answer;
}

Answer Requests::draw(const Json& wanted) {
  const std::string path = "/picture";
  check_fields(wanted, path, {"environment", "width", "height"});
  const JsonObject object(wanted, path);
  const auto side = [&](const char* name, int otherwise) {
    return wanted.contains(name) ? object.integer(name, 16, 4096) : otherwise;
  };
  const int e = wanted.contains("environment")
                    ? environment_number(session_, wanted["environment"], path + "/environment")
                    : 0;
  if (session_.status(e) != EnvironmentStatus::ok)
    throw refusal(path + "/environment", "environment {} is {}: reset it first", e,
                  to_string(session_.status(e)));
  render::RenderOptions options;
  options.size = {side("width", default_width), side("height", default_height)};
  options.overlays.labels = false;  // the moment shown is a rollout's only one
  const VecEnv& envs = session_.envs();
  Recorder recorder(envs.arena(e), session_.robot(e), 0, false, cli::created_by("evo-env"));
  recorder.record({0, envs, e, {}, false, {}});
  Answer answer;
  answer.kind = Answer::Kind::picture;
  answer.picture = render::draw_still({&recorder.rollout(), 0, ""}, options);
  return answer;
}

Answer Requests::save(const Json& wanted) {
  check_fields(wanted, "/save", {"environments"});
  Answer answer;
  answer.kind = Answer::Kind::saved;
  answer.environments = chosen_environments(session_, wanted, "/save");
  for (const int e : answer.environments) answer.saved.push_back(session_.save(e));
  return answer;
}

Answer Requests::restore(const Json& wanted) {
  const std::string path = "/restore";
  check_fields(wanted, path, {"environments", "states"});
  Answer answer;
  answer.environments = chosen_environments(session_, wanted, path);
  const Json& texts = JsonObject(wanted, path).array("states");
  if (texts.size() != answer.environments.size())
    throw refusal(path + "/states", "has {} states for {} environments", texts.size(),
                  answer.environments.size());
  std::vector<std::vector<std::uint8_t>> states;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    auto state =
        texts[i].is_string() ? from_base64(texts[i].get_ref<const std::string&>()) : std::nullopt;
    if (!state)
      throw refusal(fmt::format("{}/states/{}", path, i), "expected a saved state, found {}",
                    shown(texts[i]));
    states.push_back(std::move(*state));
  }
  std::vector<Session::Restored> restored;
  for (std::size_t i = 0; i < states.size(); ++i)
    restored.push_back({answer.environments[i], states[i]});
  session_.restore(restored);
  return answer;
}

Answer Requests::answer(const Json& request, const std::string& where) {
  try {
    const JsonObject object(request, "");
    Answer answer;
    if (request.contains("reset")) {
      check_fields(request, "", {"reset"});
      const ResetRequest wanted = reset_request(session_, request["reset"]);
      session_.reset(wanted);
      answer.environments = wanted.environments;
    } else if (request.contains("step")) {
      answer = step(request);
    } else if (request.contains("picture")) {
      check_fields(request, "", {"picture"});
      answer = draw(request["picture"]);
    } else if (request.contains("save")) {
      check_fields(request, "", {"save"});
      answer = save(request["save"]);
    } else if (request.contains("restore")) {
      check_fields(request, "", {"restore"});
      answer = restore(request["restore"]);
    } else if (request.contains("positions")) {
      check_fields(request, "", {"positions"});
      answer.kind = Answer::Kind::document;
      answer.document = positions_document(session_, request["positions"]);
    } else if (request.contains("voxels")) {
      check_fields(request, "", {"voxels"});
      answer.kind = Answer::Kind::document;
      answer.document = voxels_document(session_, voxels(), request["voxels"]);
    } else if (request.contains("look")) {
      check_fields(request, "", {"look"});
      answer.kind = Answer::Kind::document;
      answer.document = look_document(session_, voxels(), request["look"]);
    } else if (request.contains("task")) {
      check_fields(request, "", {"task"});
      check_fields(request["task"], "/task", {});
      answer.kind = Answer::Kind::document;
      answer.document = task_document(session_);
    } else {
      check_fields(
          request, "",
          {"reset", "step", "save", "restore", "positions", "voxels", "look", "picture", "task"});
      throw refusal(
          "",
          "expected one of: reset, step, save, restore, positions, voxels, look, picture, task");
    }
    return answer;
  } catch (const Refusal& refused) {
    throw refused.at(where);
  } catch (const Error& failure) {
    throw failure.at(where);
  }
}

}  // namespace evo::cli
