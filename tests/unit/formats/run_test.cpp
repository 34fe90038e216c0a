#include "formats/run/run.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "formats/io/files.h"
#include "formats/run/settings.h"
#include "formats/training/training_log.h"
#include "libevo/base/digest.h"
#include "libevo/base/random.h"
#include "tests/unit/expect.h"

using namespace evo;

namespace {

const std::vector<RunSetting> list{{"task", "Walker-v0"},
                                   {"pop", "2"},
                                   {"evals", "4"},
                                   {"steps", "1000"},
                                   {"mutate_options", "--rate 0.2"},
                                   {"train_options", "--train 'hidden=8,8'"}};

// A run as evo-evolve begins it.
RunFolder begin(const std::filesystem::path& path, const RunSettings& settings = {"ga", list}) {
  std::filesystem::create_directories(path / "journal");
  std::filesystem::create_directories(path / "policies");
  write_file(path / "run.yaml", settings.to_yaml());
  return RunFolder(path);
}

std::filesystem::path slot(const RunFolder& run, int generation, const std::string& places) {
  return run.generation(generation) / (places + ".json");
}

// What evo-train --journal writes.
void add_work(const RunFolder& run, double started, double seconds, bool finished) {
  std::ofstream(run.journal() / "here.jsonl", std::ios::app) << fmt::format(
      "{{\"started\":{},\"seconds\":{},\"finished\":{}}}\n", started, seconds, finished);
}
void mark(const RunFolder& run, const std::string& name) {
  write_file(run.journal() / (name + ".running"), "{\"host\":\"n1\",\"process\":7}\n");
}

Robot robot(const std::vector<std::string>& rows) { return Robot(Body::from_rows(rows)); }

Robot scored(const std::vector<std::string>& rows, double fitness) {
  Robot result = robot(rows);
  result.document["fitness"] = fitness;
  return result;
}

Robot after(Robot robot, int steps) {
  robot.document["steps"] = steps;
  return robot;
}

Robot failed(const std::vector<std::string>& rows) { return robot(rows).failed({"diverged"}); }

void write_robots(const std::filesystem::path& file, const std::vector<Robot>& robots) {
  std::filesystem::create_directories(file.parent_path());
  std::string text;
  for (const Robot& robot : robots) text += robot_to_line(robot) + "\n";
  write_file(file, text);
}

}  // namespace

TEST_CASE("a run's settings are written, and read back") {
  RunSettings settings("ga", list);
  settings.set_makefile(std::string(64, 'a'));
  const test::ScratchFolder scratch;
  const auto file = scratch.path() / "run.yaml";
  write_file(file, settings.to_yaml());
  CHECK(RunSettings::read(file).list() == settings.list());
  CHECK(RunSettings::read(file).text("method") == "ga");
  CHECK(RunSettings::read(file).number("steps") == 1000);
  CHECK(RunSettings::read(file).makefile() == std::string(64, 'a'));
}

TEST_CASE("whatever line of text a setting is, it comes back") {
  const test::ScratchFolder scratch;
  Stream random(1, "settings");
  const std::vector<std::string> pieces{"'", "\"", "\\", "#",  " ", ": ",  "- ",   "%",    "@",
                                        "{", "]",  ",",  "&a", "*", "!",   "null", "0x1F", "1e5",
                                        "~", "ä",  "|",  "?",  "=", "yes", "true"};
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<RunSetting> settings;
    for (const char* name : {"task", "train_options", "evaluate", "founders", "mutate"}) {
      std::string value;
      for (std::uint32_t length = 1 + random.below(6); length > 0; --length)
        value += pieces[random.below(static_cast<std::uint32_t>(pieces.size()))];
      settings.push_back({name, value});
    }
    const RunSettings written("ga", settings);
    write_file(scratch / "run.yaml", written.to_yaml());
    INFO(written.to_yaml());
    CHECK(RunSettings::read(scratch / "run.yaml").list() == written.list());
  }
}

TEST_CASE("settings that there are none of, of other methods and out of range are refused") {
  const auto refusal = [](const std::string& method, const RunSetting& setting) {
    return test::error_of(Failure::usage, [&] { RunSettings(method, {setting}); });
  };
  CHECK_THAT(refusal("gaa", {"pop", "2"}), Catch::Contains("unknown method 'gaa'"));
  CHECK_THAT(refusal("ga", {"evls", "2"}), Catch::Contains("did you mean 'evals'"));
  CHECK_THAT(refusal("ga", {"rungs", "2"}),
             Catch::Contains("--rungs is a setting of race, not of ga"));
  CHECK_THAT(refusal("ga", {"task", "a\nb"}), Catch::Contains("line breaks"));
  CHECK_THAT(refusal("ga", {"inherit", "maybe"}), Catch::Contains("is one of no, yes, all"));
  CHECK_THAT(refusal("ga", {"shape", "5"}), Catch::Contains("such as 5x5, not '5'"));
  for (const char* value : {"0", "-1", "x", "", "1e9", "01", "1000001", "3'"})
    CHECK_THAT(refusal("ga", {"pop", value}), Catch::Contains("from 1 to 1000000, not"));
  CHECK_THAT(refusal("ga", {"task", std::string(20000, 'a')}), Catch::Contains("longer"));
}

TEST_CASE("a file that is not a run, or a newer program's, is refused") {
  const test::ScratchFolder scratch;
  const auto path = scratch.path() / "run";
  CHECK_THAT(test::error_of(Failure::no_input, [&] { RunFolder{path}; }),
             Catch::Contains("no such run folder"));
  std::filesystem::create_directories(path);
  CHECK_THAT(test::error_of(Failure::data, [&] { RunFolder{path}; }),
             Catch::Contains("without run.yaml"));
  const auto refusal = [&](const std::string& text) {
    write_file(path / "run.yaml", text);
    return test::error_of(Failure::data, [&] { RunFolder{path}; });
  };
  CHECK_THAT(refusal("task: Walker-v0\n"),
             Catch::Contains("format 'evo/run' is expected, found none"));
  CHECK_THAT(refusal("format: evo/run\ntask: Walker-v0\n"),
             Catch::Contains("there is no version, such as version: 1"));
  CHECK_THAT(refusal("format: evo/run\nversion: 2\n"), Catch::Contains("newer"));
  CHECK_THAT(refusal("format: evo/run\nversion: 1\nmethod: ga\nlayout: spiral\n"),
             Catch::Contains("run.yaml: unknown setting of a run 'layout'"));
  for (const char* value : {"\"a\\0b\"", "\"a\\nb\"", "|\n  a\n  b"})
    CHECK_THAT(refusal(fmt::format("format: evo/run\nversion: 1\nmethod: ga\ntask: {}\n", value)),
               Catch::Contains("--task has line breaks or control characters"));
}

TEST_CASE("a Makefile that is another one than was written is told") {
  const test::ScratchFolder scratch;
  RunSettings settings("ga", list);
  settings.set_makefile(sha256_hex("all:\n"));
  const RunFolder run = begin(scratch.path() / "run", settings);
  CHECK_FALSE(run.is_edited());
  write_file(run.path() / "Makefile", "all:\n");
  CHECK_FALSE(run.is_edited());
  write_file(run.path() / "Makefile", "all: more\n");
  CHECK(run.is_edited());
}

TEST_CASE("the command of a run has what does not hold anyway") {
  const RunSettings settings("ga", {{"task", "Walker-v0"},
                                    {"pop", "25"},
                                    {"evals", "250"},
                                    {"steps", "512000"},
                                    {"seed", "0"},
                                    {"shape", "4x4"},
                                    {"train", "default"},
                                    {"inherit", "no"},
                                    {"train_options", "--failures stop -q"}});
  const auto setting = [&](const std::string& name) { return settings.value(name); };
  CHECK(
      evolve_command("my run", setting, {{"seed", "2"}}) ==
      "evo evolve ga --run 'my run' --task Walker-v0 --pop 25 --evals 250 --steps 512000 --seed 2 "
      "--shape 4x4 --train-options '--failures stop -q'");
}

TEST_CASE("a history follows a run while it grows") {
  const test::ScratchFolder scratch;
  const RunFolder run = begin(scratch.path() / "run");
  RunHistory history(run);
  CHECK(history.robots().empty());
  CHECK(history.champion() == nullptr);
  CHECK_FALSE(history.seconds_each());

  const std::vector<std::string> one{"HV"}, two{"VH"}, three{"HH"};
  write_robots(run.population(0), {robot(one), robot(two)});
  write_robots(slot(run, 0, "01"), {scored(two, 2.0)});
  mark(run, robot(one).id);
  add_work(run, 1'700'000'000, 2.5, true);
  history.update();
  REQUIRE(history.generations().size() == 1);
  auto slots = history.slots(history.generations()[0]);
  REQUIRE(slots.size() == 2);
  CHECK(slots[0].state == SlotState::training);
  CHECK(slots[1].state == SlotState::done);
  CHECK(history.seconds() == 2.5);

  write_robots(slot(run, 0, "00"), {failed(one)});
  write_robots(run.scores(0), {failed(one), scored(two, 2.0)});
  write_robots(run.population(1), {robot(two), robot(three)});
  std::filesystem::remove(run.journal() / (robot(one).id + ".running"));
  add_work(run, 1'700'000'000, 0.5, false);
  add_work(run, 1'700'000'000, 1.0, true);
  history.update();
  REQUIRE(history.generations().size() == 2);
  CHECK(history.generations()[0].finished);
  slots = history.slots(history.generations()[0]);
  CHECK(slots[0].state == SlotState::failed);
  CHECK(slots[0].why == "diverged");
  slots = history.slots(history.generations()[1]);
  CHECK(slots[0].state == SlotState::waiting);
  CHECK(slots[1].state == SlotState::waiting);
  CHECK(history.seconds() == 4.0);
  CHECK(history.seconds_each() == 2.0);

  write_robots(slot(run, 1, "00"), {scored(two, 2.0)});
  write_robots(slot(run, 1, "01"), {scored(three, 3.0)});
  history.update();
  CHECK(history.robots().size() == 3);
  CHECK(history.champion()->robot.id == robot(three).id);
  CHECK(history.champion()->generation == 1);
  CHECK(history.robots()[history.by_id().at(robot(two).id)].generation == 0);
  // A file may have several slots, from the one that it is named by on.
  write_robots(run.population(2), {robot({"HHV"}), robot({"HVV"}), robot({"VVV"})});
  write_robots(slot(run, 2, "01-"), {scored({"HVV"}, 0.5), scored({"VVV"}, 0.25)});
  history.update();
  slots = history.slots(history.generations()[2]);
  CHECK(slots[0].state == SlotState::waiting);
  CHECK(slots[2].state == SlotState::done);
  std::filesystem::remove_all(run.generation(2));
  // Read all at once it is the same, in the order of slots.
  const RunHistory again(run);
  CHECK(again.robots().size() == 3);
  CHECK(again.robots()[0].robot.id == robot(one).id);
  CHECK(again.seconds() == 4.0);
}

TEST_CASE("where one controller learns on all robots, they count with their last fitness") {
  const test::ScratchFolder scratch;
  const RunSettings settings("modular",
                             {{"pop", "2"}, {"evals", "5"}, {"children", "2"}, {"steps", "1000"}});
  for (const int generation : {0, 1, 2}) {
    CHECK(settings.shares(generation));
    CHECK(settings.steps(generation) == 1000);
  }
  CHECK_FALSE(settings.shares(3));
  CHECK(settings.steps(3) == 500);
  CHECK_FALSE(RunSettings("ga", {{"steps", "1000"}}).shares(0));

  const RunFolder run = begin(scratch.path() / "run", settings);
  const std::vector<std::string> one{"HV"}, two{"VH"}, three{"VV"};
  write_robots(run.scores(0), {after(scored(one, 3.0), 500), after(scored(two, 2.0), 500)});
  RunHistory history(run);
  CHECK(history.champion()->robot.id == robot(one).id);
  // Its log is that of all; then it earns less, and another one is the best.
  write_robots(run.population(1), {after(robot(one), 500), robot(three)});
  history.update();
  CHECK(history.slots(history.generations()[1])[0].state == SlotState::waiting);
  mark(run, "gen-001");
  for (const SlotStatus& slot : history.slots(history.generations()[1]))
    CHECK(slot.state == SlotState::training);
  write_robots(run.scores(1), {after(scored(one, 1.0), 1000), after(scored(three, 1.5), 500)});
  history.update();
  CHECK(history.champion()->robot.id == robot(two).id);
  CHECK(history.robots()[history.by_id().at(robot(one).id)].fitness == 1.0);
}

TEST_CASE(
    "in a race, a generation is a rung, and robots that continue count with their last fitness") {
  const test::ScratchFolder scratch;
  const RunSettings settings("race", {{"steps", "1000"}, {"rungs", "3"}});
  const RunFolder run = begin(scratch.path() / "run", settings);
  for (const int race : {0, 1}) {
    CHECK(settings.steps(3 * race) == 250);
    CHECK(settings.steps(3 * race + 1) == 500);
    CHECK(settings.steps(3 * race + 2) == 1000);
  }
  const std::vector<std::string> one{"HV"}, two{"VH"}, three{"VV"};
  write_robots(run.scores(0), {after(scored(one, 1.0), 250), after(scored(two, 2.0), 250),
                               after(scored(three, 0.0), 250)});
  write_robots(run.population(1), {robot(two), robot(one)});
  RunHistory history(run);
  CHECK(history.champion()->robot.id == robot(two).id);
  CHECK(history.slots(history.generations()[1])[1].state == SlotState::waiting);
  mark(run, robot(one).id);
  CHECK(history.slots(history.generations()[1])[1].state == SlotState::training);

  write_robots(slot(run, 1, "00"), {after(failed(two), 400)});  // has what it had before
  write_robots(slot(run, 1, "01"), {after(scored(one, 3.0), 500)});
  history.update();
  REQUIRE(history.robots().size() == 3);
  CHECK(history.champion()->robot.id == robot(one).id);
  CHECK(history.champion()->fitness == 3.0);
  CHECK(history.champion()->robot.steps() == 500);
  CHECK(history.champion()->generation == 0);
  CHECK(history.robots()[history.by_id().at(robot(two).id)].fitness == 2.0);
}

TEST_CASE("how busy the cores of a run were: pauses of all of them do not count") {
  const test::ScratchFolder scratch;
  const RunFolder run = begin(scratch / "run");
  CHECK(RunHistory(run).utilisation().cores == 0);
  // Two cores for ten seconds, one of which waits for five; a night; one core for one.
  add_work(run, 1000.0, 10.0, true);
  add_work(run, 1000.0, 2.5, true);
  add_work(run, 1002.5, 2.5, true);
  add_work(run, 30000.0, 1.0, true);
  const Utilisation found = RunHistory(run).utilisation();
  CHECK(found.cores == 2);
  CHECK(found.idle == Approx(1.0 - (10.0 + 5.0 + 1.0) / (11.0 * 2)));
}

TEST_CASE("a timing that is being written is read when it is whole") {
  const test::ScratchFolder scratch;
  const RunFolder run = begin(scratch.path() / "run");
  const auto file = run.journal() / "another.jsonl";
  write_file(file, "{\"seconds\": 1.5, \"finished\": true}\n{\"sec");
  RunHistory history(run);
  CHECK(history.seconds() == 1.5);
  std::ofstream(file, std::ios::app) << "onds\": 2.0, \"finished\": true}\n";
  history.update();
  CHECK(history.seconds() == 3.5);
}

TEST_CASE("a training's log says how far it is, restarts included") {
  const test::ScratchFolder scratch;
  const auto file = scratch.path() / "a.log";
  CHECK(read_training_log(file).step == 0.0);
  TrainingReport report;
  report.step = 1024;
  report.metrics = {{"eval/return", 0.5}, {"eval/best", 0.75}, {"losses/eval/return", 9.0}};
  {
    TrainingLog log(file);
    log.begin("tool", "Walker-v0", false);
    log.line(report, 1e4);
  }
  CHECK(read_file(file) ==
        "# tool, Walker-v0\ncharts/global_step 1024\tcharts/SPS 10000\teval/return 0.5\t"
        "eval/best 0.75\tlosses/eval/return 9\n");
  {
    TrainingLog log(file);
    log.begin("tool", "Walker-v0", true);
    report.step = 2048;
    log.line(report, 1e4);
    log.end(3.0);
  }
  LoggedTraining logged = read_training_log(file);
  CHECK(logged.step == 2048.0);
  CHECK(logged.best == 0.75);
  CHECK(logged.evaluations == std::vector<double>{0.5, 0.5});
  TrainingLog(file).begin("tool", "Walker-v0", false);
  CHECK(read_training_log(file).evaluations.empty());
}
