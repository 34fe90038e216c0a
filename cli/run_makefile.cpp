#include "cli/run_makefile.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "formats/io/values.h"
#include "formats/robot/robot.h"
#include "formats/run/settings.h"
#include "formats/task/text.h"
#include "libevo/base/error.h"
#include "libevo/evolve/select.h"

namespace evo::cli {
namespace {

namespace fs = std::filesystem;

// How each champion of a modular run continues alone.
constexpr const char* champions_training =
    " --train learning_rate=3e-4 --train rollout=128 --train evaluation_interval=16"
    " --train final_episodes=20";

// ---- words --------------------------------------------------------------------------

std::string for_make(const std::string& line, const char* hash = "$(hash)") {
  std::string made;
  for (const char c : line) made += c == '$' ? "$$" : c == '#' ? hash : std::string(1, c);
  return made;
}

// A file named as seen from here is named in full, since recipes run in the run's folder.
std::string in_full(const std::string& word) {
  const std::size_t equals = word.starts_with("--") ? word.find('=') : std::string::npos;
  if (equals != std::string::npos)
    return word.substr(0, equals + 1) + in_full(word.substr(equals + 1));
  std::error_code unknown;
  const bool may_be_file = word.find_first_of("./") != std::string::npos;
  return may_be_file && fs::exists(word, unknown) ? fs::absolute(word).lexically_normal().string()
                                                  : word;
}

std::vector<std::string> words_of(const RunSettings& settings, const std::string& name) {
  const std::string* line = settings.find(name);
  if (line == nullptr) return {};
  std::vector<std::string> words = option_words(*line, find_run_setting(name)->option());
  for (std::string& word : words) word = in_full(word);
  return words;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + make_word(word);
  return text;
}

// " --rate 0.2", or nothing.
std::string options(const RunSettings& settings, const std::string& name) {
  const std::string text = joined(words_of(settings, name));
  return text.empty() ? "" : " " + text;
}

// What evo-train is told of every training; in a race and in modular its steps depend on the
// generation. `parents`: the folder of their controllers.
std::vector<std::string> training(const RunSettings& settings, const Surroundings& around,
                                  const std::string& parents) {
  const std::string method = settings.text("method");
  const std::string inherit = method == "modular" ? "no" : settings.value("inherit");
  std::vector<std::string> words{"--task", in_full(settings.text("task"))};
  const auto add = [&](const char* option, const std::string& value) {
    words.insert(words.end(), {option, value});
  };
  if (settings.find("physics") != nullptr) add("--physics", in_full(settings.text("physics")));
  add("--train", in_full(settings.text("train")));
  if (method != "race" && method != "modular") {
    add("--steps", settings.text("steps"));
    if (settings.find("founder_steps") != nullptr)
      add("--founder-steps", settings.text("founder_steps"));
  }
  add("--seed", settings.text("seed"));
  if (inherit == "yes" || inherit == "all") add("--init", parents);
  if (inherit == "all") add("--founder-init", around.founders->policies);
  const std::vector<std::string> more = words_of(settings, "train_options");
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// What evo-render is told of the champion's film.
std::vector<std::string> film(const RunSettings& settings) {
  std::vector<std::string> words = words_of(settings, "video_options");
  if (std::find(words.begin(), words.end(), "--size") == words.end())
    words.insert(words.begin(), {"--size", "640x360", "--fps", "25"});
  return words;
}

int digits(int number) { return static_cast<int>(fmt::format("{}", number).size()); }

// ---- the parts of a run ---------------------------------------------------------------

// Robots of a generation, by the files of their slots: 07 is one, 05-09 are five, 07- all
// from there on.
std::vector<std::string> slot_names(int robots, int chunk, bool open_end) {
  const int width = std::max(2, digits(robots - 1));
  std::vector<std::string> names;
  for (int first = 0; first < robots; first += chunk) {
    const bool last = first + chunk >= robots;
    names.push_back(fmt::format("{:0{}}", first, width));
    if (last && open_end)
      names.back() += "-";
    else if (chunk > 1)
      names.back() += fmt::format("-{:0{}}", first + chunk - 1, width);
  }
  return names;
}

std::string folder(int generation) { return fmt::format("gen-{:03}", generation); }

class RunMakefile {
 public:
  RunMakefile(const RunSettings& settings, const Surroundings& around)
      : settings_(settings),
        around_(around),
        method_(settings.text("method")),
        pop_(settings.number("pop")),
        evals_(settings.number("evals")),
        seed_(static_cast<std::uint64_t>(settings.number("seed"))),
        chunk_(settings.find("chunk") == nullptr ? 1 : settings.number("chunk")),
        window_(settings.find("window") == nullptr ? 0 : settings.number("window")) {}

  std::string text() {
    if (window_ > 0)
      add_window();
    else if (method_ == "ga")
      add_ga();
    else if (method_ == "race")
      add_races();
    else if (method_ == "modular")
      add_modular();
    else
      add_batches();
    const std::string generations = std::move(rules_);
    rules_ = "\n# ---- results\n\n";
    add_results();
    return head() + generations + rules_;
  }

 private:
  bool is_evaluated() const { return settings_.is_evaluated(); }
  bool is_python() const { return !is_evaluated() && is_python_task(settings_.text("task")); }

  // One seed per purpose and generation.
  std::string stage_seed(int generation) const {
    return fmt::format("{}", seed_ * 1'000'000 + static_cast<std::uint64_t>(generation));
  }
  // Files of all generations, whose numbers have three digits, then four, and so on.
  std::string all(const std::string& file) const {
    std::string globs;
    for (int width = 3; width <= std::max(3, digits(generations_ - 1)); ++width)
      globs += fmt::format("{}gen-{}/{}", globs.empty() ? "" : " ", std::string(width, '?'), file);
    return globs;
  }

  // ---- rules ------------------------------------------------------------------------

  void rule(const std::string& targets, const std::string& needed, const std::string& recipe) {
    rules_ += fmt::format("{}:{}\n\t{}\n", targets, needed.empty() ? "" : " | " + needed, recipe);
  }

  // Population, slots and scores of the next generation. `train`: the recipe of slots;
  // `slots`: a variable with their names.
  void generation(int robots, const std::string& needed, const std::string& population,
                  const std::string& train = "$(train)", const std::string& slots = "SLOTS") {
    const std::string here = folder(generations_);
    const int launches = (robots + chunk_ - 1) / chunk_;
    const bool all = is_together_ || slots != "SLOTS" || launches == (pop_ + chunk_ - 1) / chunk_;
    const std::string files =
        all ? fmt::format("$({}:%={}/%.json)", slots, here)
            : fmt::format("$(patsubst %,{}/%.json,$(wordlist 1,{},$({})))", here, launches, slots);
    rules_ += "\n";
    rule(here + "/population.jsonl", needed.empty() ? "same" : needed, "$(alone)\n\t" + population);
    rule(fmt::format("{}: {}/%.json", files, here), here + "/population.jsonl", train);
    rule(here + "/scores.jsonl", files,
         generations_ == 0 ? "$(gather) --need-fitness" : "$(gather)");
    ++generations_;
  }

  std::string first_robots(int robots) const {
    const std::string shape = settings_.text("shape");
    const std::string sample =
        fmt::format("evo-sample -n {} --shape {} --seed {}", robots, shape, stage_seed(0));
    std::string command;
    if (method_ == "neat")
      command = fmt::format(
          "$(NEAT) --shape {} --seed {} --state-out $(@D)/species.json -o $@ < /dev/null", shape,
          stage_seed(0));
    else if (method_ == "bo")
      command = sample + " --weights 1,1,1,1,1 -o $@";
    else if (around_.founders && around_.founders->scored)
      command = fmt::format("evo-select --keep {} {} | evo-convert --bodies -o $@", robots,
                            make_word(around_.founders->robots));
    else if (around_.founders)
      command = fmt::format("evo-convert --bodies {} -o $@", make_word(around_.founders->robots));
    else
      command = sample + options(settings_, "sample_options") + " -o $@";
    return "mkdir -p $(@D)\n\t" + command;
  }

  void add_ga() {
    int number = 0;
    PlannedGeneration before;
    for (const PlannedGeneration& next : paper_plan(pop_, evals_)) {
      if (number == 0)
        generation(next.robots, "", first_robots(next.robots));
      else
        generation(next.robots, folder(number - 1) + "/scores.jsonl seen.txt",
                   fmt::format("$(call breed,{},{},{},{})", folder(number - 1), before.survivors,
                               before.children, stage_seed(number)));
      before = next;
      ++number;
    }
  }

  // Generations of neat, batches of bo, of map, whose elites stay until a new robot is better, and
  // of what no rule of ours chooses: drawn, or proposed by a program.
  void add_batches() {
    for (int number = 0; number * pop_ < evals_; ++number) {
      const int robots = method_ == "neat" ? pop_ : std::min(pop_, evals_ - number * pop_);
      const std::string before = number == 0 ? "" : folder(number - 1);
      const std::string scores = number == 0 ? "" : before + "/scores.jsonl";
      const std::string seed = stage_seed(number);
      const std::string known = number == 0 ? ": >" : "evo-convert " + all("scores.jsonl") + " -o";
      if (method_ == "program")
        generation(robots, scores,
                   fmt::format("{} scored.jsonl\n\t$(call propose,{},{})", known, robots, seed));
      else if (number == 0)
        generation(robots, "", first_robots(robots));
      else if (method_ == "neat")
        generation(robots, scores + " seen.txt",
                   fmt::format("$(call reproduce,{},{})", before, seed));
      else if (method_ == "bo")
        generation(robots, scores, fmt::format("$(call suggest,{},{})", robots, seed));
      else if (method_ == "map")
        generation(robots, scores + " seen.txt",
                   fmt::format("$(call breed,{},{}{},{},{})", before,
                               number == 1 ? "" : before + "/elites.jsonl ", scores, robots, seed));
      else  // waits for no score
        generation(robots, before + "/population.jsonl seen.txt",
                   fmt::format("$(call sample,{},{},{})", before, robots, seed));
    }
  }

  // After the first population each launch is a generation of its own. It is proposed from
  // the scores of robots 0 to k-window-1, k being its first robot.
  void add_window() {
    struct Launch {
      std::string file;
      int end = 0;  // the robot after its last
    };
    std::vector<Launch> launches;
    generation(std::min(pop_, evals_), "", first_robots(std::min(pop_, evals_)));
    for (const std::string& slot : slot_names(pop_, chunk_, false))
      launches.push_back({folder(0) + "/" + slot + ".json",
                          std::min(pop_, static_cast<int>(launches.size() + 1) * chunk_)});
    std::size_t known = 0;  // launches
    std::string state;      // that the last proposal left
    bool knows_all_first = false;
    for (int robot = pop_; robot < evals_; robot += chunk_) {
      const int count = std::min(chunk_, evals_ - robot);
      std::string fresh;
      const std::size_t known_before = known;
      while (known < launches.size() && launches[known].end <= robot - window_)
        fresh += (fresh.empty() ? "" : " ") + launches[known++].file;
      const int scores = known == 0 ? 0 : launches[known - 1].end;
      std::string needed = folder(generations_ - 1) + "/population.jsonl seen.txt";
      if (!fresh.empty()) needed += " " + fresh;
      if (scores >= pop_ && !knows_all_first) needed += " " + folder(0) + "/scores.jsonl";
      knows_all_first = scores >= pop_;
      generation(count, needed, window_proposal(count, scores, state, fresh), "$(train)", "SLOT");
      if (known > known_before) state = folder(generations_ - 1) + state_file();
      launches.push_back({fmt::format("{}/{}.json", folder(generations_ - 1),
                                      slot_names(chunk_, chunk_, false).front()),
                          robot + count});
    }
  }
  std::string state_file() const { return method_ == "map" ? "/elites.jsonl" : "/parents.jsonl"; }

  std::string window_proposal(int count, int scores, const std::string& state,
                              const std::string& fresh) const {
    const std::string before = folder(generations_ - 1);
    const std::string seed = stage_seed(generations_);
    if (scores == 0) return fmt::format("$(call sample,{},{},{})", before, count, seed);
    if (method_ == "bo") return fmt::format("$(call suggest,{},{},{})", count, seed, scores);
    const std::string known = state + (state.empty() || fresh.empty() ? "" : " ") + fresh;
    if (method_ == "map")
      return fmt::format("$(call breed,{},{},{},{})", before, known, count, seed);
    return fmt::format("$(call breed,{},{},{},{},{})", before, known,
                       steady_parents(pop_, scores, evals_), count, seed);
  }

  void add_races() {
    const int rungs = settings_.number("rungs");
    for (int race = 0; race * pop_ < evals_; ++race) {
      int robots = std::min(pop_, evals_ - race * pop_);
      for (int rung = 0; rung < rungs; ++rung) {
        const int number = race * rungs + rung;
        const std::string before = number == 0 ? "" : folder(number - 1);
        const std::string train = fmt::format("$(call train,--steps {}{})", settings_.steps(number),
                                              rung + 1 < rungs ? " --keep-checkpoint" : "");
        if (number == 0) {
          generation(robots, "", first_robots(robots), train);
        } else if (rung == 0) {
          const std::string elders = race == 1 ? "" : folder(number - rungs) + "/parents.jsonl ";
          generation(robots, before + "/scores.jsonl seen.txt",
                     fmt::format("$(call breed,{},{}{}/scores.jsonl,{},{})", before, elders, before,
                                 robots, stage_seed(number)),
                     train);
        } else {
          robots = (robots + 1) / 2;
          generation(robots, before + "/scores.jsonl",
                     fmt::format("$(call go_on,{},{})", before, robots), train);
        }
      }
    }
  }

  void add_modular() {
    is_together_ = true;
    const int first = std::min(pop_, evals_);
    const int later = evals_ - first;
    const int children = settings_.number("children");
    const int last_shared = (later + children - 1) / children;
    const auto shared = [](int number) {
      return fmt::format("policies/{}.policy.h5", folder(number));
    };
    const bool inherits_all = settings_.value("inherit") == "all";
    for (int number = 0; number <= last_shared; ++number) {
      const std::string init = number > 0     ? " --init " + shared(number - 1)
                               : inherits_all ? " --init " + make_word(around_.founders->policies)
                                              : "";
      const std::string train = fmt::format("$(call train,--steps {} --shared {}{})",
                                            settings_.number("steps"), shared(number), init);
      if (number == 0) {
        generation(first, "", first_robots(first), train);
        continue;
      }
      const int born = std::min(children, later - (number - 1) * children);
      generation(pop_, folder(number - 1) + "/scores.jsonl seen.txt",
                 fmt::format("$(call breed,{},{},{},{})", folder(number - 1), pop_ - born, born,
                             stage_seed(number)),
                 train);
    }
    if (const int champions = settings_.number("champions"); champions > 0)
      generation(champions, folder(last_shared) + "/scores.jsonl",
                 fmt::format("$(call go_on,{},{})", folder(last_shared), champions),
                 fmt::format("$(call train,--steps {}{} --init {})", settings_.steps(generations_),
                             champions_training, shared(last_shared)),
                 "CHAMPIONS");
  }

  // ---- above and below the rules -------------------------------------------------------

  std::string program() const {
    if (is_evaluated())
      return fmt::format("cd {} && {}", shell_word(around_.here), settings_.text("evaluate"));
    std::string text =
        fmt::format("{} {} --out-dir policies --steps {} --seed {} --train {} --failures skip",
                    around_.python, shell_word(in_full_task(settings_.text("task"))),
                    settings_.number("steps"), seed_, shell_word(in_full(settings_.text("train"))));
    for (const std::string& word : words_of(settings_, "train_options"))
      text += " " + shell_word(word);
    return text;
  }
  // The file of FILE.py:CLASS in full.
  static std::string in_full_task(const std::string& task) {
    const std::size_t colon = task.rfind(':');
    return in_full(task.substr(0, colon)) + task.substr(colon);
  }

  std::string head() const {
    std::string text = fmt::format(
        "# {} {} {}: a run of evo evolve, whose settings are in run.yaml.\n"
        "#\n"
        "#   make -j8                    continues where it was, killed or not\n"
        "#   make -j8 LAUNCH='srun ..'   with something in front of every training\n"
        "#\n"
        "# What exists is done: rules ask whether a file is there, not when it was made. Remove\n"
        "# files to have them made again, change a recipe to try something else.\n"
        "\n"
        "SHELL := /bin/bash\n"
        ".SHELLFLAGS := -eu -o pipefail -c\n"
        ".ONESHELL:\n"
        ".SUFFIXES:\n"
        "MAKEFLAGS += --no-builtin-rules --no-print-directory\n",
        method_, is_evaluated() ? "scored by" : "on", comment(settings_.scored_by()));
    if (!around_.tools.empty())
      text += fmt::format("export PATH := {}:$(PATH)\n", for_make(around_.tools, "\\#"));
    text +=
        "hash := \\#\n\n"
        "LAUNCH ?=\n"
        "CORES ?= 1\n";
    text += fmt::format("TRIES ?= {}\n\n", settings_.number("tries"));
    text += slots() + "\n";
    if (is_evaluated() || is_python())
      text += fmt::format(
          "# A robot goes in as a line of JSON, and comes out with its fitness.\n"
          "SCORE = $(LAUNCH) evo-score --by {} \\\n  --tries $(TRIES) --journal journal\n",
          make_word(program()));
    else
      text += fmt::format(
          "TRAIN = $(LAUNCH) evo-train {} \\\n  --out-dir policies --journal journal --resume "
          "--failures skip --progress never -j $(CORES){}\n",
          joined(training(settings_, around_, "policies")), method_ == "race" ? " -q" : "");
    text += proposer();
    text +=
        "\n.PHONY: all same\n"
        "all: | " +
        results() +
        "\n\n# Another task or program than the run began with is refused.\n"
        "same:\n\tevo-evolve -q --run . --plan\n\n" +
        "# Several makes may work on one run. Who comes second finds that it is done, and does\n"
        "# not propose robots once more from what the first has scored since.\n"
        "alone = exec 9>> Makefile; flock 9 || :; [ ! -e $@ ] || exit 0\n\n" +
        train() +
        "\n# All slots of a generation, in order.\n"
        "gather = evo-convert $(@D)/[0-9]*.json -o $@\n\n" +
        recipes();
    return text;
  }

  std::string slots() const {
    if (is_together_) {
      const int champions = settings_.number("champions");
      return "# One training of all robots of a generation; then each champion's own.\nSLOTS = "
             "00-\n" +
             (champions == 0 ? std::string()
                             : fmt::format("CHAMPIONS = {}\n",
                                           fmt::join(slot_names(champions, 1, false), " ")));
    }
    std::string text =
        fmt::format("SLOTS = {}\n", fmt::join(slot_names(pop_, chunk_, method_ == "neat"), " "));
    if (window_ > 0) text += fmt::format("SLOT = {}\n", slot_names(chunk_, chunk_, false).front());
    if (method_ == "neat")
      text = "# A generation of NEAT may have a few robots more; the last slot has them.\n" + text;
    return text;
  }

  std::string proposer() const {
    if (method_ == "neat") {
      const std::string own = settings_.find("neat") == nullptr
                                  ? ""
                                  : " --neat " + make_word(in_full(settings_.text("neat")));
      return fmt::format("NEAT = evo-neat -n {}{}\n", pop_, own);
    }
    if (method_ == "program")
      return fmt::format("PROPOSE = {}\n", joined(words_of(settings_, "propose")));
    if (method_ == "bo" || method_ == "random") return "";
    const std::string tool =
        settings_.find("mutate") == nullptr ? "evo-mutate" : joined(words_of(settings_, "mutate"));
    std::string text = fmt::format("MUTATE = {}{}\n", tool, options(settings_, "mutate_options"));
    if (method_ == "map")
      text += fmt::format("ARCHIVE = evo-archive -q --features {}\n",
                          make_word(settings_.value("features")));
    return text;
  }

  std::string train() const {
    const std::string work = is_evaluated() || is_python() ? "SCORE" : "TRAIN";
    const std::string more = method_ == "race" || method_ == "modular" ? "$(1) " : "";
    return fmt::format(
        "# The robots of a slot. What dies is begun again, and in the end a robot whose training "
        "was\n"
        "# killed counts as failed; a status that says what is wrong for any robot ends the run.\n"
        "define train\n"
        "for try in $$(seq $(TRIES)); do \\\n"
        "  $({0}) {1}--pick $* $(@D)/population.jsonl -o $@ && exit || status=$$?; \\\n"
        "  case $$status in 2|65|66|69|73|130|143) exit $$status;; esac; sleep $$try; \\\n"
        "done; \\\n"
        "$({0}) {1}--give-up --pick $* $(@D)/population.jsonl -o $@\n"
        "endef\n",
        work, more);
  }

  // A program of one's own may make fewer, or bodies that there were.
  std::string checked_children(const std::string& count) const {
    if (settings_.find("mutate") == nullptr) return "";
    return fmt::format(
        "new=$$(($$(evo-convert --to ids seen.txt $(@D)/children.jsonl | wc -l) - $$(wc -l < "
        "seen.txt))); \\\n"
        "[ $$new -eq {0} ] || {{ echo \"$(@D)/children.jsonl: $$new new bodies, not {0}\" >&2; "
        "exit 65; }}\n",
        count);
  }

  std::string recipes() const {
    const std::string seen =
        "mkdir -p $(@D)\n"
        "evo-convert --to ids seen.txt $(1)/population.jsonl -o seen.txt\n";
    std::string text;
    const auto define = [&](const std::string& what, const std::string& name,
                            const std::string& body) {
      text += fmt::format("# {}\ndefine {}\n{}endef\n\n", what, name, body);
    };
    if (method_ == "program")
      define("As many different robots as asked for. $(1) robots, $(2) seed", "propose",
             fmt::format(
                 "mkdir -p $(@D)\n"
                 "$(PROPOSE) -n $(1) --seed $(2) --shape {} < scored.jsonl > $(@D)/proposed.jsonl\n"
                 "new=$$(evo-convert --to ids $(@D)/proposed.jsonl | sort -u | wc -l)\n"
                 "[ $$new -eq $(1) ] || {{ echo \"$(@D)/proposed.jsonl: $$new different robots, "
                 "not $(1)\" >&2; exit 65; }}\n"
                 "evo-convert --bodies $(@D)/proposed.jsonl -o $@\n",
                 settings_.text("shape")));
    else if (method_ != "bo" || window_ > 0)
      text +=
          "# Bodies that there were, which must not come again.\n"
          "seen.txt: | gen-000/population.jsonl\n"
          "\tevo-convert --to ids " +
          all("population.jsonl") + " -o $@\n\n";
    if (window_ > 0 || method_ == "random")
      define(
          "Robots at random. $(1) generation before, $(2) robots, $(3) seed", "sample",
          seen + fmt::format("evo-sample -n $(2) --shape {} --seed $(3){} --avoid seen.txt -o $@\n",
                             settings_.text("shape"),
                             method_ == "bo" ? " --weights 1,1,1,1,1"
                                             : options(settings_, "sample_options")));
    if (method_ == "ga" && window_ == 0)
      define(
          "Survivors keep their fitness; their children are new to the run.\n"
          "# $(1) generation before, $(2) survivors, $(3) children, $(4) seed",
          "breed",
          seen +
              "evo-select --keep $(2) $(1)/scores.jsonl -o $(@D)/survivors.jsonl\n"
              "$(MUTATE) -n $(3) --seed $(4) --avoid seen.txt $(@D)/survivors.jsonl "
              "-o $(@D)/children.jsonl\n" +
              checked_children("$(3)") +
              "evo-convert $(@D)/survivors.jsonl $(@D)/children.jsonl -o $@\n");
    if (method_ == "ga" && window_ > 0)
      define(
          "Children of the best so far. $(1) generation before, $(2) the best and what was scored\n"
          "# since, $(3) parents, $(4) children, $(5) seed",
          "breed",
          seen + fmt::format("evo-select --keep {} $(2) -o $(@D)/parents.jsonl\n", pop_) +
              "evo-select --keep $(3) $(@D)/parents.jsonl | \\\n"
              "  $(MUTATE) -n $(4) --seed $(5) --avoid seen.txt -o $(@D)/children.jsonl\n" +
              checked_children("$(4)") + "evo-convert $(@D)/children.jsonl -o $@\n");
    if (method_ == "map")
      define(
          "Children of the fittest robot of every kind. $(1) generation before, $(2) elites and\n"
          "# what was scored since, $(3) children, $(4) seed",
          "breed",
          seen + "$(ARCHIVE) $(2) -o $(@D)/elites.jsonl\n" +
              (window_ > 0
                   ? fmt::format("if [ -s $(@D)/elites.jsonl ]; then \\\n"
                                 "  $(MUTATE) -n $(3) --seed $(4) --avoid seen.txt "
                                 "$(@D)/elites.jsonl -o $@; \\\n"
                                 "else evo-sample -n $(3) --shape {} --seed $(4) --avoid seen.txt "
                                 "-o $@; fi\n",
                                 settings_.text("shape"))
                   : "$(MUTATE) -n $(3) --seed $(4) --avoid seen.txt $(@D)/elites.jsonl -o $@\n"));
    if (method_ == "neat")
      define("$(1) generation before, $(2) seed", "reproduce",
             seen +
                 "$(NEAT) --seed $(2) --avoid seen.txt --state-in $(1)/species.json \\\n"
                 "  --state-out $(@D)/species.json $(1)/scores.jsonl -o $@\n");
    if (method_ == "bo")
      define(window_ > 0 ? "From the first scores, beside robots in training. $(1) robots, $(2) "
                           "seed, $(3) scores"
                         : "From all scores. $(1) robots, $(2) seed",
             "suggest",
             window_ > 0 ? "mkdir -p $(@D)\n"
                           "evo-suggest -q -n $(1) --seed $(2) --known $(3) " +
                               all("[0-9]*.json") + " " + all("population.jsonl") + " -o $@\n"
                         : "mkdir -p $(@D)\n"
                           "evo-suggest -n $(1) --seed $(2) " +
                               all("scores.jsonl") + " -o $@\n");
    if (method_ == "race")
      define(
          "Children of the best that any race took to its end. $(1) generation before, $(2) those\n"
          "# of earlier races and the last race's end, $(3) children, $(4) seed",
          "breed",
          seen +
              fmt::format("rm -f policies/*.checkpoint.h5\n"
                          "evo-select --keep {} $(2) -o $(@D)/parents.jsonl\n",
                          settings_.value("parents")) +
              "$(MUTATE) -n $(3) --seed $(4) --avoid seen.txt $(@D)/parents.jsonl -o $@\n");
    if (method_ == "race" || method_ == "modular")
      define("The best continue. $(1) generation before, $(2) robots", "go_on",
             "mkdir -p $(@D)\n"
             "evo-select --keep $(2) --unscored $(1)/scores.jsonl -o $@\n");
    if (method_ == "modular")
      define(
          "Children take the places of the worst. $(1) generation before, $(2) that stay,\n"
          "# $(3) children, $(4) seed",
          "breed",
          seen +
              fmt::format("evo-select --keep $(2) --grace {} --unscored {} -o $(@D)/stay.jsonl\n",
                          settings_.number("grace"), all("scores.jsonl")) +
              "$(MUTATE) -n $(3) --seed $(4) --avoid seen.txt $(@D)/stay.jsonl "
              "-o $(@D)/children.jsonl\n"
              "evo-convert $(@D)/stay.jsonl $(@D)/children.jsonl -o $@\n");
    return text + "# ---- generations\n";
  }

  bool has_video() const { return settings_.value("video") != "none"; }
  std::string video() const { return "best." + settings_.value("video"); }

  std::string results() const {
    std::string files = "best.json";
    if (method_ == "map") files += " archive.jsonl archive.tsv";
    if (is_evaluated()) return files + " report.html";
    files += " best.policy.h5";
    if (has_video()) files += " " + video();
    return files + " report.html";
  }

  void add_results() {
    rules_ += "GENERATIONS =";
    for (int k = 0; k < generations_; ++k) rules_ += fmt::format(" {:03}", k);
    rules_ += "\n\n";
    rule("history.jsonl", "$(GENERATIONS:%=gen-%/scores.jsonl)",
         "evo-convert --unique " + all("scores.jsonl") + " -o $@");
    rule("best.json", "history.jsonl", "evo-select --keep 1 history.jsonl -o $@");
    if (method_ == "map") {
      rule("archive.jsonl", "history.jsonl", "$(ARCHIVE) history.jsonl -o $@");
      rule("archive.tsv", "history.jsonl", "$(ARCHIVE) --table history.jsonl -o $@");
    }
    if (is_evaluated()) {
      rule("report.html", "best.json", "evo-report -q . -o $@");
      return;
    }
    rule("best.policy.h5", "best.json", "evo-convert --to policy best.json -o $@");
    rule("best.rollout.h5", "best.policy.h5",
         is_python() ? fmt::format("{} {} --rollout best.policy.h5 $@", for_make(around_.python),
                                   make_word(in_full_task(settings_.text("task"))))
                     : fmt::format("evo-eval -q --policy best.policy.h5 --seed {} --rollout $@ "
                                   "best.json > /dev/null",
                                   seed_));
    if (has_video())
      rule(video(), "best.rollout.h5",
           fmt::format("evo-render -q best.rollout.h5 {} -o $@", joined(film(settings_))));
    rule("report.html", has_video() ? video() : "best.rollout.h5", "evo-report -q . -o $@");
  }

  static std::string comment(const std::string& text) {
    return !text.empty() && text.back() == '\\' ? text + " " : text;
  }

  const RunSettings& settings_;
  const Surroundings& around_;
  std::string method_;
  int pop_;
  int evals_;
  std::uint64_t seed_;
  int chunk_;
  int window_;
  bool is_together_ = false;
  int generations_ = 0;
  std::string rules_;
};

// ---- what does not go together -----------------------------------------------------------

void check_python_task(const RunSettings& settings) {
  if (settings.text("method") == "race" || settings.text("method") == "modular")
    throw error(Failure::usage, "--task {}: trainings in Python cannot continue, as {} needs",
                settings.text("task"), settings.text("method"));
  for (const char* name : {"physics", "founder_steps"})
    if (settings.find(name) != nullptr)
      throw error(Failure::usage, "{} is for tasks of the suite: {} is a class in Python",
                  find_run_setting(name)->option(), settings.text("task"));
  if (settings.value("inherit") != "no" && !settings.value("inherit").empty())
    throw error(Failure::usage,
                "--inherit is for tasks of the suite: {} is a class in Python, trained from the "
                "beginning",
                settings.text("task"));
}

void check(const RunSettings& settings, const Surroundings& around) {
  const std::string method = settings.text("method");
  const int pop = settings.number("pop");
  if (!settings.is_evaluated() && is_python_task(settings.text("task")))
    check_python_task(settings);
  for (const char* name : {"mutate", "propose"}) {
    const std::vector<std::string> words = words_of(settings, name);
    if (!words.empty() && words[0].find('/') != std::string::npos && !fs::exists(words[0]))
      throw error(Failure::no_input, "{} {}: there is no such program",
                  find_run_setting(name)->option(), words[0]);
  }
  if (settings.find("window") != nullptr && settings.find("chunk") != nullptr &&
      settings.number("chunk") > settings.number("window"))
    throw error(Failure::usage, "--chunk {} is larger than --window {}", settings.number("chunk"),
                settings.number("window"));
  if (method == "neat" && pop < 2)
    throw error(Failure::usage, "--pop {}: neat needs at least 2 robots", pop);
  const bool inherits_all = settings.value("inherit") == "all";
  if (inherits_all && (!around.founders || around.founders->policies.empty()))
    throw error(Failure::usage,
                "--inherit all is for --founders that have controllers: a run or a record{}",
                around.founders ? "; --inherit yes trains founders anew" : "");
  if (method != "modular") return;
  if (settings.value("inherit") == "yes")
    throw Error(
        Failure::usage,
        "--inherit is no or all for modular: every robot starts with the controller of all");
  const int safe = settings.number("children") * (settings.number("grace") + 1);
  if (pop <= safe)
    throw error(Failure::usage,
                "--pop {} leaves no place for robots out of --grace; more than children x (grace + "
                "1) are needed, {}",
                pop, safe);
}

}  // namespace

bool is_python_task(const std::string& task) { return task.find(".py:") != std::string::npos; }

std::string make_word(const std::string& text) { return for_make(shell_word(text)); }

std::vector<std::string> option_words(const std::string& line, const std::string& where) {
  std::vector<std::string> words;
  bool in_word = false;
  char quote = '\0';
  for (std::size_t at = 0; at < line.size(); ++at) {
    const char c = line[at];
    if (quote == '\0' && (c == ' ' || c == '\t')) {
      in_word = false;
      continue;
    }
    if (!in_word) words.emplace_back();
    in_word = true;
    if (quote == '\0' && (c == '\'' || c == '"')) {
      quote = c;
    } else if (c == quote) {
      quote = '\0';
    } else if (c == '\\' && quote != '\'' && at + 1 < line.size()) {
      words.back() += line[++at];
    } else {
      words.back() += c;
    }
  }
  if (quote != '\0')
    throw error(Failure::usage, "{}: the quote {} is not closed: {}", where, quote, line);
  return words;
}

std::vector<Trial> trials(const RunSettings& settings, const Surroundings& around) {
  const std::string method = settings.text("method");
  const std::string shape = settings.text("shape");
  std::vector<Trial> list;
  const auto add = [&](std::vector<std::string> words, const std::vector<std::string>& more = {},
                       const std::string& input = "") {
    words.insert(words.end(), more.begin(), more.end());
    list.push_back({std::move(words), input});
  };
  add({"evo-sample", "-n", "0", "--shape", shape, "-o", "/dev/null"},
      words_of(settings, "sample_options"));
  if (settings.find("mutate_options") != nullptr && settings.find("mutate") == nullptr)
    add({"evo-mutate", "-n", "0", "-o", "/dev/null"}, words_of(settings, "mutate_options"));
  if (method == "neat") {
    std::vector<std::string> words{"evo-neat",  "-n", "2",        "--state-out",
                                   "/dev/null", "-o", "/dev/null"};
    if (settings.find("neat") != nullptr)
      words.insert(words.end(), {"--neat", in_full(settings.text("neat"))});
    add(words);
  }
  if (method == "map")
    add({"evo-archive", "-q", "--features", settings.text("features"), "-o", "/dev/null"});
  if (settings.is_evaluated()) return list;

  const auto [rows, cols] = parse_shape(shape);
  const std::string body = robot_to_line(Robot(full_body(rows, cols))) + "\n";
  const bool is_python = is_python_task(settings.text("task"));
  // A film of a moment, where such a body can stand in the task.
  if (settings.find("video_options") != nullptr && settings.value("video") != "none") {
    const std::string lines =
        "task=$1 kind=$2 d=$(mktemp -d); trap 'rm -r \"$d\"' EXIT; "
        "evo-eval -q --task \"$task\" --actions random --max-steps 2 --rollout \"$d/r.h5\" "
        "> \"$d/said\" 2>&1 || exit 0; evo-render -q \"$d/r.h5\" \"${@:3}\" -o \"$d/best.$kind\"";
    const std::string task = is_python ? "Walker-v0" : in_full(settings.text("task"));
    add({"bash", "-c", lines, "bash", task, settings.text("video")}, film(settings), body);
  }
  if (is_python) {
    std::string line =
        fmt::format("{} {} --steps {} --train {}", around.python, shell_word(settings.text("task")),
                    settings.text("steps"), shell_word(settings.text("train")));
    for (const std::string& word : words_of(settings, "train_options"))
      line += " " + shell_word(word);
    add({"bash", "-c", line});
    return list;
  }
  const std::vector<std::string> train = training(settings, around, ".");
  const auto add_training = [&](std::vector<std::string> words, int robots) {
    words.insert(words.begin(), train.begin(), train.end());
    add({"evo-train", "--check"}, words);
    for (int k = 0; k < robots; ++k) list.back().input += body;
  };
  if (method == "modular") {
    constexpr int enough = 64;  // robots, to see whether the first steps are too few
    add_training({"--steps", settings.text("steps"), "--shared", "none.policy.h5"},
                 std::min(settings.number("pop"), enough));
    if (settings.number("champions") > 0)
      add_training(option_words(fmt::format("--steps {}{}", settings.number("steps") / 2,
                                            champions_training),
                                "--champions"),
                   1);
    return list;
  }
  std::vector<std::string> words;
  if (method == "race") words = {"--steps", fmt::format("{}", settings.steps(0))};
  add_training(words, 1);
  return list;
}

std::string run_makefile(const RunSettings& settings, const Surroundings& around) {
  check(settings, around);
  return RunMakefile(settings, around).text();
}

}  // namespace evo::cli
