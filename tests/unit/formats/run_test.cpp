#include "formats/run/run.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "formats/io/files.h"
#include "formats/training/training_log.h"
#include "libevo/base/random.h"
#include "tests/unit/formats/scratch.h"

using namespace evo;

namespace {

const std::vector<std::string> words{"method=ga",
                                     "task=Walker-v0",
                                     "pop=2",
                                     "evals=4",
                                     "steps=1000",
                                     "physics=task",
                                     "mutate_options=--rate 0.2",
                                     "none=",
                                     "train_options=--train-set 'hidden=8,8'"};

Robot robot(const std::vector<std::string>& rows) { return Robot(Body::from_rows(rows)); }

Robot scored(const std::vector<std::string>& rows, double fitness) {
  Robot result = robot(rows);
  result.document["fitness"] = fitness;
  return result;
}

Robot failed(const std::vector<std::string>& rows) {
  Robot result = robot(rows);
  result.document["fitness"] = nullptr;
  result.document["failure"] = {{"why", "diverged"}};
  return result;
}

void write_robots(const std::filesystem::path& file, const std::vector<Robot>& robots) {
  std::filesystem::create_directories(file.parent_path());
  std::string text;
  for (const Robot& robot : robots) text += robot_to_line(robot) + "\n";
  write_file(file, text);
}

}  // namespace

TEST_CASE("a run's settings are written as they always were, and read back") {
  const RunSettings settings = RunSettings::from_words(words);
  const std::string text = settings.to_yaml();
  CHECK(text ==
        "format: evo/run\nversion: 1\nmethod: ga\ntask: Walker-v0\npop: 2\nevals: 4\n"
        "steps: 1000\nphysics: task\nmutate_options: --rate 0.2\nnone: \n"
        "train_options: '--train-set ''hidden=8,8'''\n");
  const test::ScratchFolder scratch;
  const auto file = scratch.path() / "run.yaml";
  write_file(file, text);
  CHECK(RunSettings::read(file).list() == settings.list());
  CHECK(RunSettings::read(file).number("steps") == 1000);
}

TEST_CASE("values that YAML would take for something else come back as they were") {
  const test::ScratchFolder scratch;
  const auto file = scratch.path() / "run.yaml";
  for (const std::string value :
       {"--rate 0.2", "a: b", "# c", "x #y", "[1]", "~",        "null", " padded ",
        "it's",       "'",    "-",   "- a",  "-a",  "--rate 1", "a:",   "1e3",
        "true",       "{a}",  "*",   "%",    "@",   "a\\nb",    "\"q\""}) {
    const RunSettings settings =
        RunSettings::from_words({"key=" + value, "train_options=" + value});
    write_file(file, settings.to_yaml());
    INFO(settings.to_yaml());
    CHECK(RunSettings::read(file).list() == settings.list());
  }
}

TEST_CASE("whatever line of text a setting is, it comes back") {
  const test::ScratchFolder scratch;
  Stream random(1, "settings");
  const std::vector<std::string> pieces{"'", "\"", "\\", "#",  " ", ": ",  "- ",   "%",    "@",
                                        "{", "]",  ",",  "&a", "*", "!",   "null", "0x1F", "1e5",
                                        "~", "ä",  "|",  "?",  "=", "yes", "\t"};
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<std::string> settings;
    for (int k = 0; k < 5; ++k) {
      std::string value;
      for (std::uint32_t length = random.below(6); length > 0; --length)
        value += pieces[random.below(static_cast<std::uint32_t>(pieces.size()))];
      settings.push_back("key_" + std::to_string(k) + "=" + value);
    }
    const RunSettings written = RunSettings::from_words(settings);
    write_file(scratch / "run.yaml", written.to_yaml());
    INFO(written.to_yaml());
    CHECK(RunSettings::read(scratch / "run.yaml").list() == written.list());
  }
}

TEST_CASE("words that are no settings are refused") {
  for (const char* word : {"task", "=x", "Task=x", "version=2", "a b=1"})
    CHECK_THAT(test::error_of(Failure::usage, [&] { RunSettings::from_words({word}); }),
               Catch::Contains("is not a setting"));
  CHECK_THAT(test::error_of(Failure::usage,
                            [] {
                              RunSettings::from_words({"a=1", "a=2"});
                            }),
             Catch::Contains("twice"));
  CHECK_THAT(test::error_of(Failure::usage, [] { RunSettings::from_words({"a=1\n2"}); }),
             Catch::Contains("line breaks"));
}

TEST_CASE("a run is begun once; other settings are refused with what differs") {
  const test::ScratchFolder scratch;
  const auto path = scratch.path() / "run";
  RunFolder::create(path, RunSettings::from_words(words));
  const std::string text = read_file(path / "run.yaml");
  RunFolder::create(path, RunSettings::from_words(words));
  std::vector<std::string> others = words;
  others[4] = "steps=2000";
  others.push_back("extra=1");
  CHECK_THAT(test::error_of(Failure::cannot_create,
                            [&] { RunFolder::create(path, RunSettings::from_words(others)); }),
             Catch::Contains(
                 "(steps: 1000 there, steps: 2000 asked for; no extra there, extra: 1 asked for)"));
  CHECK(read_file(path / "run.yaml") == text);
}

TEST_CASE("what is no run, or of a newer program, is refused") {
  const test::ScratchFolder scratch;
  const auto path = scratch.path() / "run";
  CHECK_THAT(test::error_of(Failure::no_input, [&] { RunFolder{path}; }),
             Catch::Contains("no such run folder"));
  std::filesystem::create_directories(path);
  CHECK_THAT(test::error_of(Failure::data, [&] { RunFolder{path}; }),
             Catch::Contains("without run.yaml"));
  write_file(path / "run.yaml", "task: Walker-v0\n");
  CHECK_THAT(test::error_of(Failure::data, [&] { RunFolder{path}; }),
             Catch::Contains("format 'evo/run' is expected, found none"));
  write_file(path / "run.yaml", "format: evo/run\ntask: Walker-v0\n");
  CHECK_THAT(test::error_of(Failure::data, [&] { RunFolder{path}; }),
             Catch::Contains("there is no version, such as version: 1"));
  write_file(path / "run.yaml", "format: evo/run\nversion: 2\n");
  CHECK_THAT(test::error_of(Failure::data, [&] { RunFolder{path}; }), Catch::Contains("newer"));
  write_file(path / "run.yaml", "format: evo/run\nversion: 1\nlayout: spiral\n");
  CHECK_THAT(test::error_of(Failure::data, [&] { RunFolder{path}; }),
             Catch::Contains("unknown layout of a run 'spiral'"));
  for (const char* value : {"a\x10", "\"a\\0b\"", "\"a\\nb\"", "|\n  a\n  b"}) {
    write_file(path / "run.yaml", fmt::format("format: evo/run\nversion: 1\ntask: {}\n", value));
    CHECK_THAT(test::error_of(Failure::data, [&] { RunFolder{path}; }),
               Catch::Contains("run.yaml:3:7: task has line breaks or control characters"));
  }
  for (const char* name : {"Task", "a b", "\"\\0task\""}) {
    write_file(path / "run.yaml", fmt::format("format: evo/run\nversion: 1\n{}: x\n", name));
    CHECK_THAT(
        test::error_of(Failure::data, [&] { RunFolder{path}; }),
        Catch::Contains("run.yaml:3:1: \"") && Catch::Contains("is not the name of a setting"));
  }
}

TEST_CASE("a slot's robot is a line of the population") {
  const test::ScratchFolder scratch;
  const RunFolder run = RunFolder::create(scratch.path() / "run", RunSettings::from_words(words));
  CHECK_THAT(test::error_of(Failure::no_input,
                            [&] {
                              run.robot({0, 0});
                            }),
             Catch::Contains("no population yet"));
  write_robots(run.population(0), {robot({"HV"}), robot({"VH"})});
  CHECK(run.population_size(0) == 2);
  CHECK(run.robot({0, 1}).id == robot({"VH"}).id);
  CHECK_THAT(test::error_of(Failure::usage,
                            [&] {
                              run.robot({0, 2});
                            }),
             Catch::Contains("generation 0 has 2"));
  CHECK(run.slot({3, 7}) == scratch.path() / "run/gen-003/07.json");
  CHECK(run.slot({1000, 123}) == scratch.path() / "run/gen-1000/123.json");
}

TEST_CASE("a history follows a run while it grows") {
  const test::ScratchFolder scratch;
  const RunFolder run = RunFolder::create(scratch.path() / "run", RunSettings::from_words(words));
  RunHistory history(run);
  CHECK(history.robots().empty());
  CHECK(history.champion() == nullptr);
  CHECK_FALSE(history.seconds_each());

  const std::vector<std::string> one{"HV"}, two{"VH"}, three{"HH"};
  write_robots(run.population(0), {robot(one), robot(two)});
  write_robots(run.slot({0, 1}), {scored(two, 2.0)});
  write_file(run.log(robot(one).id), "# evo-train, Walker-v0\n");
  run.add_timing({robot(two).id, {0, 1}, 1'700'000'000, 2.5, 1000, true});
  history.update();
  REQUIRE(history.generations().size() == 1);
  auto slots = history.slots(history.generations()[0]);
  REQUIRE(slots.size() == 2);
  CHECK(slots[0].state == SlotState::training);
  CHECK(slots[1].state == SlotState::done);
  CHECK(history.seconds() == 2.5);

  write_robots(run.slot({0, 0}), {failed(one)});
  write_robots(run.scores(0), {failed(one), scored(two, 2.0)});
  write_file(run.ranking(0), "");
  write_robots(run.population(1), {robot(two), robot(three)});
  run.add_timing({robot(one).id, {0, 0}, 1'700'000'000, 0.5, 100, false});
  run.add_timing({robot(one).id, {0, 0}, 1'700'000'000, 1.0, 200, true});
  history.update();
  REQUIRE(history.generations().size() == 2);
  CHECK(history.generations()[0].finished);
  slots = history.slots(history.generations()[0]);
  CHECK(slots[0].state == SlotState::failed);
  CHECK(slots[0].why == "diverged");
  // A survivor was trained before: its log does not say that it is trained now.
  slots = history.slots(history.generations()[1]);
  CHECK(slots[0].state == SlotState::waiting);
  CHECK(slots[1].state == SlotState::waiting);
  CHECK(history.seconds() == 4.0);
  CHECK(history.seconds_each() == 2.0);

  write_robots(run.slot({1, 0}), {scored(two, 2.0)});
  write_robots(run.slot({1, 1}), {scored(three, 3.0)});
  history.update();
  CHECK(history.robots().size() == 3);
  CHECK(history.champion()->robot.id == robot(three).id);
  CHECK(history.champion()->generation == 1);
  CHECK(history.robots()[history.by_id().at(robot(two).id)].generation == 0);
  // Read all at once it is the same, in the order of slots.
  const RunHistory again(run);
  CHECK(again.robots().size() == 3);
  CHECK(again.robots()[0].robot.id == robot(one).id);
  CHECK(again.seconds() == 4.0);
}

TEST_CASE("where one controller learns on all robots, they count with their last fitness") {
  const test::ScratchFolder scratch;
  const RunSettings settings =
      RunSettings::from_words({"pop=2", "evals=5", "children=2", "steps=1000", "own_steps=300"});
  for (const int generation : {0, 1, 2}) {
    CHECK(settings.shares(generation));
    CHECK(settings.steps(generation) == 1000);
  }
  CHECK_FALSE(settings.shares(3));
  CHECK(settings.steps(3) == 300);
  CHECK_FALSE(RunSettings::from_words({"steps=1000"}).shares(0));

  const RunFolder run = RunFolder::create(scratch.path() / "run", settings);
  const auto after = [](Robot robot, int steps) {
    robot.document["steps"] = steps;
    return robot;
  };
  const std::vector<std::string> one{"HV"}, two{"VH"}, three{"VV"};
  write_robots(run.scores(0), {after(scored(one, 3.0), 500), after(scored(two, 2.0), 500)});
  write_file(run.ranking(0), "");
  RunHistory history(run);
  CHECK(history.champion()->robot.id == robot(one).id);
  // Its log is that of all; then it earns less, and another one is the best.
  write_robots(run.population(1), {after(robot(one), 500), robot(three)});
  history.update();
  CHECK(history.slots(history.generations()[1])[0].state == SlotState::waiting);
  TrainingLog log(run.policies() / "gen-001.log");
  log.begin("evo-train", "Walker-v0", false);
  for (const SlotStatus& slot : history.slots(history.generations()[1]))
    CHECK(slot.state == SlotState::training);
  write_robots(run.scores(1), {after(scored(one, 1.0), 1000), after(scored(three, 1.5), 500)});
  history.update();
  CHECK(history.champion()->robot.id == robot(two).id);
  CHECK(history.robots()[history.by_id().at(robot(one).id)].fitness == 1.0);
}

TEST_CASE(
    "in a race, a generation is a rung, and robots that go on count with their last fitness") {
  const test::ScratchFolder scratch;
  const RunSettings settings = RunSettings::from_words({"steps=1000", "rungs=3"});
  const RunFolder run = RunFolder::create(scratch.path() / "run", settings);
  for (const int race : {0, 1}) {
    CHECK(settings.steps(3 * race) == 250);
    CHECK(settings.steps(3 * race + 1) == 500);
    CHECK(settings.steps(3 * race + 2) == 1000);
    CHECK(settings.goes_on(3 * race + 1));
    CHECK_FALSE(settings.goes_on(3 * race + 2));
  }
  const auto after = [](Robot robot, int steps) {
    robot.document["steps"] = steps;
    return robot;
  };
  const std::vector<std::string> one{"HV"}, two{"VH"}, three{"VV"};
  write_robots(run.scores(0), {after(scored(one, 1.0), 250), after(scored(two, 2.0), 250),
                               after(scored(three, 0.0), 250)});
  write_file(run.ranking(0), "");
  write_robots(run.population(1), {robot(two), robot(one)});
  TrainingLog log(run.log(robot(one).id));
  log.begin("evo-train", "Walker-v0", false);
  RunHistory history(run);
  CHECK(history.champion()->robot.id == robot(two).id);
  CHECK(history.slots(history.generations()[1])[1].state == SlotState::waiting);
  TrainingReport report;
  report.step = 300;
  report.metrics = {{"eval/return", 1.5}};
  log.line(report, 1.0);
  CHECK(history.slots(history.generations()[1])[1].state == SlotState::training);

  write_robots(run.slot({1, 0}), {after(failed(two), 400)});  // has what it had before
  write_robots(run.slot({1, 1}), {after(scored(one, 3.0), 500)});
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
  const RunFolder run = RunFolder::create(scratch / "run", RunSettings::from_words(words));
  CHECK(RunHistory(run).utilisation().cores == 0);
  // Two cores for ten seconds, one of which waits for five; a night; one core for one.
  run.add_timing({"a", {0, 0}, 1000.0, 10.0, 1, true});
  run.add_timing({"b", {0, 1}, 1000.0, 2.5, 1, true});
  run.add_timing({"c", {0, 2}, 1002.5, 2.5, 1, true});
  run.add_timing({"d", {0, 3}, 30000.0, 1.0, 1, true});
  const Utilisation found = RunHistory(run).utilisation();
  CHECK(found.cores == 2);
  CHECK(found.idle == Approx(1.0 - (10.0 + 5.0 + 1.0) / (11.0 * 2)));
}

TEST_CASE("a timing that is being written is read when it is whole") {
  const test::ScratchFolder scratch;
  const RunFolder run = RunFolder::create(scratch.path() / "run", RunSettings::from_words(words));
  const auto file = run.timings() / "another.jsonl";
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
