// evo-inspect: what a file is, how a run stands, which tasks there are.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>
#include <string_view>

#include "cli/check.h"
#include "cli/command.h"
#include "cli/data.h"
#include "cli/documents.h"
#include "cli/progress.h"
#include "cli/robots.h"
#include "cli/run_status.h"
#include "cli/terminal.h"
#include "formats/io/format.h"
#include "formats/io/hdf5.h"
#include "formats/io/npz.h"
#include "formats/io/text.h"
#include "formats/io/values.h"
#include "formats/rollout/ending.h"
#include "formats/rollout/rollout.h"
#include "formats/run/settings.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/task/text.h"
#include "formats/training/policy.h"
#include "formats/training/training.h"
#include "formats/training/training_log.h"

namespace {

using namespace evo;
namespace fs = std::filesystem;

// ---- robots -------------------------------------------------------------------

std::string kinds(const Body& body) {
  std::vector<std::string> parts;
  for (const Voxel kind : voxel_kinds) {
    const auto count = std::count(body.cells.begin(), body.cells.end(), kind);
    if (count > 0) parts.push_back(fmt::format("{} {}", count, kind_name(kind)));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

// Beside a fitness, which may be luck.
void print_perturbed(double mean, double error, int episodes) {
  fmt::print("perturbed {:.6g} +- {:.2g} over {} episodes from perturbed starts\n", mean, error,
             episodes);
}

void print_perturbed(const Json& document) {
  const Json final = document.value("final", Json::object());
  const auto has = [&](const char* key) { return final.contains(key) && final[key].is_number(); };
  if (final.is_object() && has("mean") && has("standard_error") && has("episodes"))
    print_perturbed(final["mean"].get<double>(), final["standard_error"].get<double>(),
                    final["episodes"].get<int>());
}

void print_robot(const Robot& robot) {
  const Body& body = robot.body;
  fmt::print("{}", cli::draw_body(body));
  fmt::print("id        {}\n", robot.id);
  fmt::print("size      {}x{}, {} voxels: {}\n", body.rows, body.cols, count_voxels(body),
             kinds(body));
  std::vector<double> factors;
  for (std::size_t k = 0; k < body.stiffness.size(); ++k)
    if (body.cells[k] != Voxel::empty) factors.push_back(body.stiffness[k]);
  if (!factors.empty()) {
    const auto [least, most] = std::ranges::minmax(factors);
    fmt::print("stiffness {:.3g} to {:.3g}\n", least, most);
  }
  if (body.links != full_links(body.rows, body.cols, body.cells))
    fmt::print("links     {} of {} adjacent pairs\n", body.links.size(),
               full_links(body.rows, body.cols, body.cells).size());
  if (const auto fault = defect(body, true)) fmt::print("not a robot: {}\n", *fault);
  const Json& document = robot.document;
  const auto print_field = [&](const char* label, const char* key) {
    const auto found = document.find(key);
    if (found == document.end() || found->is_null()) return;
    fmt::print("{:<9} {}\n", label,
               printable(found->is_string() ? found->get<std::string>() : compact(*found)));
  };
  print_field("fitness", "fitness");
  print_perturbed(document);
  print_field("failure", "failure");
  print_field("task", "task");
  print_field("steps", "steps");
  print_field("policy", "policy");
  print_field("parents", "parents");
  print_field("origin", "origin");
}

// "    1.25 ..     2.50  ############ 17": equal parts of the range, the best on top.
void print_histogram(const std::vector<double>& scores) {
  constexpr std::size_t most_parts = 12;
  constexpr double longest = 44;  // of a bar
  const auto [low, high] = std::minmax_element(scores.begin(), scores.end());
  if (!(*high > *low)) return;
  const auto root =
      static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(scores.size()))));
  std::vector<std::size_t> counts(std::clamp<std::size_t>(root, 2, most_parts));
  const double width = (*high - *low) / static_cast<double>(counts.size());
  for (const double score : scores)
    ++counts[std::min(counts.size() - 1, static_cast<std::size_t>((score - *low) / width))];
  const auto most = static_cast<double>(*std::max_element(counts.begin(), counts.end()));
  for (std::size_t k = counts.size(); k-- > 0;) {
    const double from = *low + static_cast<double>(k) * width;
    const auto bar =
        static_cast<std::size_t>(std::ceil(longest * static_cast<double>(counts[k]) / most));
    fmt::print("{:>9.4g} .. {:>9.4g}  {}{}{}\n", from,
               k + 1 == counts.size() ? *high : from + width, std::string(bar, '#'),
               bar > 0 ? " " : "", counts[k]);
  }
}

// As many as a line has room for, the fittest first, their ids below them.
void print_side_by_side(std::vector<Robot> robots) {
  std::ranges::stable_sort(robots, std::ranges::greater(), [](const Robot& robot) {
    return robot.fitness().value_or(-std::numeric_limits<double>::infinity());
  });
  const std::size_t columns = cli::output_columns().value_or(80);
  std::vector<std::string> lines(1);  // the first of them, the ids, is printed last
  std::size_t left = 0;
  for (const Robot& robot : robots) {
    const auto body = static_cast<std::size_t>(2 * robot.body.cols);
    const std::size_t width = std::max(robot.id.size(), body);
    if (left > 0 && left + width > columns) break;
    std::vector<std::string> column{robot.id};
    for (const std::string& row : split_list(cli::draw_body(robot.body), '\n'))
      column.push_back(row);
    lines.resize(std::max(lines.size(), column.size()), std::string(left, ' '));
    column.resize(lines.size());
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const bool painted = column[k].find('\x1b') != std::string::npos;
      const std::size_t shown = painted ? body : column[k].size();
      lines[k] += column[k] + std::string(width - shown + 2, ' ');
    }
    left += width + 2;
  }
  std::rotate(lines.begin(), lines.begin() + 1, lines.end());
  for (const std::string& line : lines)
    fmt::print("{}\n", line.substr(0, line.find_last_not_of(' ') + 1));
}

void print_robots(const std::vector<Robot>& robots, const std::string& name) {
  if (robots.size() == 1) {
    print_robot(robots.front());
    return;
  }
  std::vector<double> scores;
  int failed = 0;
  std::set<std::string> ids;
  for (const Robot& robot : robots) {
    ids.insert(robot.id);
    if (const auto fitness = robot.fitness()) scores.push_back(*fitness);
    failed += robot.document.contains("failure") ? 1 : 0;
  }
  if (!robots.empty()) print_side_by_side(robots);
  fmt::print("{}: {} robots, {} different\n", printable(name), robots.size(), ids.size());
  if (!scores.empty()) {
    const auto [low, high] = std::minmax_element(scores.begin(), scores.end());
    double sum = 0.0;
    for (const double score : scores) sum += score;
    fmt::print("fitness of {}: best {:.4g}, mean {:.4g}, worst {:.4g}\n", scores.size(), *high,
               sum / static_cast<double>(scores.size()), *low);
    print_histogram(scores);
  }
  if (failed > 0) fmt::print("failed: {}\n", failed);
}

// ---- HDF5 files ---------------------------------------------------------------

std::string describe_motion(const SineController& gait) {
  return fmt::format("waves of period {:.3g}", gait.period);
}
std::string describe_motion(const ReplayController& sequence) {
  return fmt::format("a sequence of actions, {} steps", sequence.steps());
}
template <typename Motion>
std::string describe(const Motion& motion) {
  return describe_motion(motion) + ", open loop";
}
std::string describe(const Policy& policy) {
  std::string text = "a network";
  const char* before = " ";
  for (const Layer& layer : policy.actor.layers) {
    text += fmt::format("{}{}", before, layer.weight.cols());
    before = "-";
  }
  text += fmt::format("-{}", policy.action_length());
  if (policy.base)
    text +=
        " on " + std::visit([](const auto& base) { return describe_motion(base); }, *policy.base);
  return text;
}
std::string describe(const ModularPolicy& policy) {
  std::string text = fmt::format("a network {}-{}",
                                 VoxelViews::local_length + policy.task_length() +
                                     2 * std::ssize(policy.clock) + VoxelViews::fixed_length,
                                 policy.actor.bias.size());
  for (const Layer& layer : policy.actor.rest.layers) text += fmt::format("-{}", layer.bias.size());
  text += " of every voxel, for any body";
  return text;
}

void print_policy(const std::string& path) {
  const PolicyFile file = read_policy(path);
  fmt::print("{}: policy\n", printable(path));
  print_robot(file.robot);
  fmt::print("trained   on {}, {} steps", printable(file.task), file.steps);
  if (!std::isnan(file.fitness))  // unknown of what other programs trained, as what is below
    fmt::print(", seed {}, best evaluation {:.6g} at step {}", file.seed, file.fitness,
               file.best_step);
  fmt::print("\n");
  if (file.final_score)
    print_perturbed(file.final_score->mean, file.final_score->standard_error,
                    file.final_score->episodes);
  std::vector<double> evaluations;
  for (const CurvePoint& point : file.curve) evaluations.push_back(point.evaluation);
  if (!evaluations.empty()) fmt::print("curve     {}\n", cli::sparkline(evaluations, 60));
  fmt::print("made by   {}", printable(file.created_by));
  if (!file.settings_hash.empty())
    fmt::print(", settings {}", printable(file.settings_hash.substr(0, 12)));
  fmt::print("\n");
  constexpr std::string_view key = "\ninherited=";
  if (const std::size_t at = file.identity.find(key); at != std::string::npos)
    fmt::print("began     with the policy of settings {}\n",
               printable(file.identity.substr(at + key.size(), 12)));
  fmt::print("control   {}\n",
             std::visit([](const auto& any) { return describe(any); }, file.controller));
  if (!std::holds_alternative<Policy>(file.controller) &&
      !std::holds_alternative<ModularPolicy>(file.controller))
    return;  // sees nothing
  std::string observes = "observes ";
  for (const ObservationSlice& slice : file.layout)
    observes += fmt::format(" {} [{}..{}]", printable(slice.name), slice.offset,
                            slice.offset + slice.length - 1);
  cli::print_wrapped(observes + "\n");
}

void print_rollout(const std::string& path) {
  const Rollout rollout = read_rollout(path);
  fmt::print("{}: rollout of {}\n", printable(path),
             rollout.task.empty() ? "an unknown task" : printable(rollout.task));
  if (rollout.robot) print_robot(*rollout.robot);
  fmt::print("{} observations, {} actuators, {} points{}\n", rollout.observation_length,
             rollout.action_length, rollout.points,
             rollout.world.cells.empty() ? ", no cells (cannot be drawn)" : "");
  fmt::print("{:>8} {:>7} {:>20}  {}\n", "episode", "steps", "return", "end");
  for (std::size_t k = 0; k < rollout.episodes.size(); ++k) {
    const RolloutEpisode& episode = rollout.episodes[k];
    double sum = 0.0;
    for (const double reward : episode.rewards) sum += reward;
    fmt::print("{:>8} {:>7} {:>20.17g}  {}\n", k, episode.steps(), sum,
               printable(ending(rollout, episode).text));
  }
}

void print_hdf5(const std::string& path) {
  const std::string found = hdf5::Reader(path).format();
  if (found == format::policy.name) return print_policy(path);
  if (found == format::rollout.name) return print_rollout(path);
  if (found == format::checkpoint.name) {
    fmt::print("{}: checkpoint of a training; evo-train --resume continues from it\n",
               printable(path));
    return;
  }
  throw error(Failure::data, "{}: an HDF5 file, but neither a policy nor a rollout{}", path,
              found.empty() ? "" : " (format '" + found + "')");
}

// ---- run folders --------------------------------------------------------------

double size_on_disk(const fs::path& folder) {
  double bytes = 0.0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) bytes += static_cast<double>(entry.file_size());
  return bytes;
}

void print_work(const cli::RunWork& work) {
  if (!work.launches.empty()) fmt::print("launches     {}\n", cli::tally(work.launches, " on "));
  if (work.waiting > 0) fmt::print("waiting      {} robots\n", work.waiting);
  if (!work.failures.empty()) fmt::print("failed       {}\n", cli::tally(work.failures, " x "));
}

// What there is to say of a slot in its state: fitness, share done, why it failed.
std::string detail(const SlotStatus& slot, const RunHistory& history) {
  if (slot.state == SlotState::done)
    return fmt::format("{}", *history.robots()[history.by_id().at(slot.robot)].fitness);
  if (slot.state == SlotState::failed) return printable(slot.why);
  if (slot.state == SlotState::waiting) return "";
  const fs::path log = history.folder().log(slot.generation, slot.robot);
  if (!fs::exists(log)) return "0.00";
  const double steps = history.folder().settings().steps(slot.generation);
  return fmt::format("{:.2f}", read_training_log(log).step / std::max(1.0, steps));
}

void print_slots(const fs::path& folder) {
  const RunHistory history{RunFolder(folder)};
  static constexpr std::array words{"waiting", "training", "done", "failed"};  // of SlotState
  fmt::print("generation\tslot\trobot\tstate\tdetail\n");
  for (const RunHistory::Generation& generation : history.generations())
    for (const SlotStatus& slot : history.slots(generation))
      fmt::print("{}\t{}\t{}\t{}\t{}\n", slot.generation, slot.slot, slot.robot,
                 words.at(static_cast<std::size_t>(slot.state)), detail(slot, history));
}

void print_run(const fs::path& folder) {
  const cli::RunStatus run(folder);
  const RunHistory& history = run.history();
  const RunSettings& settings = run.folder().settings();
  fmt::print("{}: {} {} {}, seed {}\n", printable(folder.string()),
             printable(settings.text("method")), settings.is_evaluated() ? "scored by" : "on",
             printable(settings.scored_by()), printable(settings.text("seed")));
  if (settings.is_evaluated() && !settings.source_hash().empty())
    fmt::print("program      {} ({})\n", printable(settings.source()),
               printable(settings.source_hash().substr(0, 12)));
  const auto setting = [&](const std::string& name) { return settings.value(name); };
  fmt::print("command      {}\n", printable(evolve_command(folder.string(), setting)));
  if (run.folder().is_edited()) fmt::print("Makefile     edited by hand\n");
  fmt::print("robots       {} of {} {}, {} left\n", run.trained(), run.evaluations(),
             settings.is_evaluated() ? "scored" : "trained", run.left());
  fmt::print("generations  {} finished, {} begun\n",
             std::count_if(history.generations().begin(), history.generations().end(),
                           [](const auto& generation) { return generation.finished; }),
             history.generations().size());
  print_work(run.work());
  if (const auto each = history.seconds_each()) {
    fmt::print("{:<12} {} per robot on average, {:.2f} core hours so far\n",
               settings.is_evaluated() ? "scoring" : "training", cli::duration(*each),
               history.seconds() / 3600.0);
    if (const Utilisation cores = history.utilisation(); cores.cores > 0)
      fmt::print("cores        at most {} at once, {:.1f} % of their time between robots\n",
                 cores.cores, 100.0 * cores.idle);
    if (run.left() > 0)
      fmt::print("expected     {:.2f} more core hours: {} on one core\n",
                 *each * run.left() / 3600.0, cli::duration(*each * run.left()));
  }
  fmt::print("disk         {}\n", cli::file_size(size_on_disk(folder)));
  if (const TrainedRobot* best = history.champion()) {
    fmt::print("best so far  {}\n", cli::sparkline(run.best_so_far(), 60));
    Robot shown = best->robot;
    if (shown.policy()) {
      const fs::path file = fs::path(folder) / "policies" / fs::path(*shown.policy()).filename();
      shown.document["policy"] = file.string();
    }
    print_robot(shown);
  }
}

// ---- the command line ---------------------------------------------------------

void print_tasks() {
  const DataFolders folders = cli::data_folders();
  std::vector<TaskSpec> tasks;
  for (const std::string& name : task_names(folders)) tasks.push_back(load_task(name, folders));
  cli::print_wrapped(task_table(tasks));
}

// Keys, values, what is allowed, and what it means, a line each.
void print_settings(const std::vector<SettingRow>& rows) {
  std::size_t key = 0;
  std::size_t value = 0;
  std::size_t kind = 0;
  for (const SettingRow& row : rows) {
    key = std::max(key, row.key.size());
    value = std::max(value, row.value.size());
    kind = std::max(kind, row.kind.size());
  }
  std::string text;
  for (const SettingRow& row : rows)
    text += fmt::format("{:<{}}  {:>{}}  {:<{}}  {}{}{}\n", row.key, key, row.value, value,
                        row.kind, kind, row.unit, row.unit.empty() ? "" : "; ", row.meaning);
  cli::print_wrapped(text);
}

bool print_profile(const std::vector<std::string>& words) {
  if (words[0] != "physics" && words[0] != "training") return false;
  if (words.size() > 2)
    throw error(Failure::usage, "{}: name one profile, such as paper", words[0]);
  const DataFolders folders = cli::data_folders();
  const auto print = [&](const auto& profiles, const char* otherwise) {
    print_settings(profiles.rows(profiles.load(words.size() == 2 ? words[1] : otherwise, folders)));
  };
  if (words[0] == "physics")
    print(physics_profiles(), "evogym");
  else
    print(training_profiles(), "default");
  return true;
}

// Bodies that cannot be robots are shown and then refused.
void check_bodies(const std::vector<Robot>& robots, const std::string& name) {
  for (const Robot& robot : robots)
    if (const auto fault = defect(robot.body, true))
      throw error(Failure::data, "{}: robot {} cannot be one: {}", name, robot.id, *fault);
}

void print_file(const std::string& name) {
  cli::refuse_task_as_file(name);
  if (name != standard_stream && fs::is_directory(name)) return print_run(name);
  if (name != standard_stream && hdf5::is_hdf5(name)) return print_hdf5(name);
  const std::string text = read_robot_text(name);
  const bool is_hdf5 = hdf5::begins_as_hdf5(text);
  if (!is_hdf5 && !begins_as_numpy(text))
    if (const auto document = cli::describe_document(text, input_label(name))) {
      fmt::print("{}", printable_lines(document->says));
      return;
    }
  const std::vector<Robot> robots = is_hdf5
                                        ? parse_robots(hdf5::Reader(text, name).text("/", "robot"),
                                                       input_label(name), BodyCheck::any)
                                        : cli::robots_in(text, name, BodyCheck::any);
  print_robots(robots, input_label(name));
  check_bodies(robots, input_label(name));
}

void draw_robots(const std::string& name) {
  const std::vector<Robot> robots = cli::read_robots({name}, BodyCheck::any);
  for (const Robot& robot : robots) {
    print_robot(robot);
    fmt::print("\n");
  }
  check_bodies(robots, input_label(name));
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-inspect");
  std::vector<std::string> words;
  bool watch = false;
  bool check = false;
  bool replay = false;
  bool slots = false;
  command.arguments(
      words, "SUBJECT...",
      {{"FILE...", "robots, policies, rollouts, tasks, profiles, NEAT states, worlds, run folders"},
       {"tasks", "the tasks there are"},
       {"task NAME", "its world, what is observed, rewarded, and ends an episode"},
       {"physics [PROFILE]", "what can be set there, and its values in a profile [evogym]"},
       {"training [PROFILE]", "the same of trainings [default]"},
       {"robot FILE...", "robots, drawn"}});
  command.flag("--watch", watch,
               "follow a run, or one that is to begin, until it is over: a line per generation, on "
               "a terminal the champion's body and live curves");
  const cli::Option whole = command.flag(
      "--check", check,
      "read the files, or every file of a run, whole: structure, ids, checksums, fitness");
  command.flag("--replay", replay, "with --check, run the policies: each earns its fitness again")
      .needs(whole);
  command.flag(
      "--slots", slots,
      "of a run, a table of all slots: state (waiting, training, done, failed) and fitness, "
      "share done, or why it failed");
  command.progress_option();
  command.example("evo-inspect tasks", "the benchmark's tasks with difficulty and lengths");
  command.example("evo-inspect task Carrier-v0", "what is observed, rewarded, and ends an episode");
  command.example("evo-inspect physics paper", "the constants of a profile, with units and limits");
  command.example("evo-inspect runs/walker", "how far a run is and what is left");
  command.example("evo-inspect --watch runs/walker", "the same, live");

  return command.run(argc, argv, [&] {
    if (check) {
      if (words.empty()) throw error(Failure::usage, "--check: name files or run folders");
      cli::check_paths(words, replay);
      return 0;
    }
    if (slots) {
      if (words.size() != 1) throw error(Failure::usage, "--slots: name one run folder");
      print_slots(words[0]);
      return 0;
    }
    if (watch) {
      if (words.size() != 1) throw error(Failure::usage, "--watch: name one run folder");
      cli::watch_run(words[0], command.progress_style());
      return 0;
    }
    if (words.empty() && isatty(STDIN_FILENO) == 1)
      throw Error(Failure::usage,
                  "name a file or a run folder, or 'tasks', 'task NAME', 'physics' or 'training'; "
                  "see evo-inspect --help");
    if (words.empty()) words.emplace_back(standard_stream);
    if (words == std::vector<std::string>{"tasks"}) {
      print_tasks();
    } else if (words[0] == "task") {
      if (words.size() != 2) throw error(Failure::usage, "task: name one task, such as Walker-v0");
      cli::print_wrapped(cli::describe_task(load_task(words[1], cli::data_folders())));
    } else if (print_profile(words)) {
      return 0;
    } else if (words[0] == "robot") {
      if (words.size() < 2) words.emplace_back(standard_stream);
      for (std::size_t i = 1; i < words.size(); ++i) draw_robots(words[i]);
    } else {
      for (const std::string& word : words) print_file(word);
    }
    return 0;
  });
}
