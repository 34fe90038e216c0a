#include "render/report/cards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/io/base64.h"
#include "formats/io/values.h"
#include "libevo/base/join.h"
#include "render/report/choice.h"
#include "render/report/verdict.h"

namespace evo::report {
namespace {

constexpr std::size_t changes_listed = 4;  // of one mutation, in words

}  // namespace

std::string purpose_in_words(const Run& run) {
  std::string purpose = run.purpose;
  while (!purpose.empty() && purpose.back() == '.') purpose.pop_back();
  if (!purpose.empty() && purpose.front() >= 'A' && purpose.front() <= 'Z')
    purpose.front() = static_cast<char>(purpose.front() - 'A' + 'a');
  return purpose;
}

// ---- the verdict ------------------------------------------------------------------------

std::string verdict_card(const Run& run) {
  const Verdict verdict = judge(run);
  const char* look = verdict.level == Verdict::Level::good    ? "good"
                     : verdict.level == Verdict::Level::doubt ? "doubt"
                                                              : "bad";
  return fmt::format("<section class=\"card verdict {}\">\n<h3>{}</h3>\n<p>{}</p>\n</section>\n",
                     look, escaped(verdict.headline), escaped(joined(verdict.sentences, " ")));
}

std::string next_card(const Run& run, const std::string& anchor) {
  const Verdict verdict = judge(run);
  if (verdict.commands.empty()) return "";
  std::string html = "<section class=\"card\">\n" +
                     heading(anchor + "-next", "What to do next",
                             "Commands for the folder in which this page was made.");
  for (const Verdict::Command& command : verdict.commands)
    html += fmt::format(
        "<div class=\"command\"><span>{0}</span><code>{1}</code><button type=\"button\" "
        "data-copy=\"{1}\" aria-label=\"Copy: {0}\">Copy</button></div>\n",
        escaped(command.why), escaped(command.line));
  return html + "</section>\n";
}

// ---- about a run -----------------------------------------------------------------------

std::string badge(const Run& run) {
  return is_over(run) ? "<span class=\"badge\">finished</span>"
                      : "<span class=\"badge open\">unfinished</span>";
}

std::string trained(const Run& run) {
  const auto wanted = run.evaluations();
  return wanted ? fmt::format("{} <small>of {}</small>", run.robots.size(), *wanted)
                : fmt::to_string(run.robots.size());
}

namespace {

long long training_steps(const Run& run) {
  long long steps = 0;
  for (const Entry& entry : run.robots) steps += entry.robot.steps().value_or(0);
  return steps;
}

std::string tile(const std::string& name, const std::string& value) {
  return fmt::format("<div class=\"tile\"><dt>{}</dt><dd>{}</dd></div>\n", name, value);
}

std::string duration(double seconds) {
  constexpr double minute = 60;
  constexpr double hour = 60 * minute;
  if (seconds < 2 * minute) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2 * hour) return fmt::format("{:.0f} min", seconds / minute);
  return fmt::format("{:.1f} h", seconds / hour);
}

}  // namespace

std::string tiles(const Run& run) {
  std::string html = "<dl class=\"tiles\">\n";
  html +=
      tile("best fitness", run.champion ? run.text(run.robots[*run.champion].fitness) : "none yet");
  html += tile(fmt::format("robots {}", run.done()), trained(run));
  html += tile("generations", fmt::to_string(run.generations.size()));
  html += tile(run.is_evaluated() ? "failed" : "failed trainings", fmt::to_string(run.failures()));
  if (!run.is_evaluated()) html += tile("training steps", grouped(training_steps(run)));
  if (run.seconds > 0) {
    const auto elapsed = static_cast<double>(run.ended - run.began);
    html += tile(run.is_evaluated() ? "scoring time of one core" : "training time of one core",
                 duration(run.seconds) +
                     (elapsed > 0 ? " <small>within " + duration(elapsed) + "</small>" : ""));
  }
  return html + "</dl>\n";
}

namespace {

std::string kinds_of(const Body& body) {
  std::vector<std::string> parts;
  for (const Voxel kind : voxel_kinds)
    if (const auto count = std::count(body.cells.begin(), body.cells.end(), kind); count > 0)
      parts.push_back(
          fmt::format("<span class=\"part\"><span class=\"swatch {0}\"></span>{1} {0}</span>",
                      kind_name(kind), count));
  return joined(parts, ", ");
}

// ---- the champion ------------------------------------------------------------------------

// Both themes; the style sheet shows one.
std::string still_pictures(const Film& film) {
  const auto image = [](const char* theme, const std::string& svg) {
    return fmt::format(
        "<img class=\"film {}\" src=\"data:image/svg+xml;base64,{}\" alt=\"The way of the champion "
        "at its task, six moments of it\">\n",
        theme, base64(svg));
  };
  return image("light", film.light) + image("dark", film.dark);
}

std::string champion_facts(const Run& run) {
  const Entry& entry = run.robots[*run.champion];
  const Body& body = entry.robot.body;
  std::string facts = "<dl class=\"facts\">\n";
  facts += fact("robot", fmt::format("<span class=\"id\">{}</span>, number {}, generation {}",
                                     entry.robot.id, *run.champion + 1, entry.generation));
  facts += fact("body", fmt::format("{}&times;{}, {}: {}", body.rows, body.cols,
                                    count_of(static_cast<std::size_t>(count_voxels(body)), "voxel"),
                                    kinds_of(body)));
  if (const auto& score = entry.training.final_score)
    facts += fact("perturbed starts",
                  fmt::format("{} (mean of {} \u00b1 its standard error)",
                              with_error(run, score->mean, score->standard_error),
                              count_of(static_cast<std::size_t>(score->episodes), "episode")));
  return facts + "</dl>\n";
}

// "In 9.9 s it moves 98 voxels to the right; goal reached: robot beyond x = 99. "
std::string what_happened(const Json& replay) {
  constexpr int far = 5;  // voxels; less is no travel
  const double seconds = replay["steps"].get<double>() / replay["rate"].get<double>();
  const auto moved = std::lround(replay["moved"].get<double>());
  const std::string way = std::abs(moved) < far
                              ? fmt::format("Its episode lasts {:.3g} s", seconds)
                              : fmt::format("In {:.3g} s it moves {} voxels to the {}", seconds,
                                            std::abs(moved), moved > 0 ? "right" : "left");
  return fmt::format("{}; {}. ", way, replay["ending"].get<std::string>());
}

// For whoever sees such a page for the first time.
std::string introduction(const Run& run) {
  const std::string purpose = purpose_in_words(run);
  const Entry& champion = run.robots[*run.champion];
  const bool evaluated = run.is_evaluated();
  const std::string task = evaluated ? champion.robot.task().value_or("") : run.setting("task");
  const std::size_t tried = run.robots.size();
  std::string text = fmt::format("This robot was evolved{}: {}. ",
                                 !purpose.empty() ? " to " + purpose
                                 : !task.empty()  ? " for " + task
                                                  : "",
                                 tried == 1 ? "the only one tried"
                                            : fmt::format("the best of {} that were tried",
                                                          grouped(static_cast<long long>(tried))));
  if (const auto replay = run.replays.find(*run.champion); replay != run.replays.end())
    text += what_happened(replay->second);
  if (evaluated)
    return text + fmt::format("Its fitness, {}, is what a program gave it: {}.",
                              run.text(champion.fitness), run.setting("evaluate"));
  return text + fmt::format("Its fitness, {}, is what {} paid it {}.", run.text(champion.fitness),
                            purpose.empty() ? "the task" : "the task " + task,
                            champion.sharing ? "with the controller of all robots"
                                             : "in its best episode during training");
}

}  // namespace

std::string champion_card(const Run& run, const std::string& anchor, Page& page) {
  const Robot& robot = run.robots[*run.champion].robot;
  const std::string body = page.link(robot, anchor);
  const bool moves = run.replays.contains(*run.champion);
  return fmt::format(
      "<section class=\"card\" id=\"{}-champion\">\n{}<p class=\"introduction\">{}</p>\n"
      "<div class=\"portrait\">{}{}</div>\n</section>\n",
      anchor,
      moves ? stage({{anchor, robot.id, "The champion"}})
            : "<div class=\"still\">" + body + "</div>",
      escaped(introduction(run)), moves ? body : "", champion_facts(run));
}

std::string film_card(const Run& run) {
  if (!run.film) return "";
  return "<section class=\"card long\">\n<h3>Its way</h3>\n<div class=\"scroll\">\n" +
         still_pictures(*run.film) + "</div>\n</section>\n";
}

bool has_lineage(const Run& run) {
  return lineage(run.robots, run.by_id, *run.champion).size() > 1;
}

namespace {

// ---- the evolution sheet -------------------------------------------------------------------

std::string sheet_cell(const Run& run, const Generation& generation, std::size_t place,
                       const std::string& anchor) {
  const std::size_t robot = generation.members[place];
  const Entry& entry = run.robots[robot];
  const bool champion = robot == run.champion;
  return fmt::format("<a class=\"{}{}\" href=\"#{}-{}\">{}{}</a>",
                     entry.generation == generation.number ? "new" : "kept",
                     champion ? " best" : "", anchor, entry.robot.id,
                     picture(entry.robot.id, entry.robot.body), run.text(generation.scores[place]));
}

std::string sheet_column(const Run& run, const SheetColumn& chosen, const std::string& anchor) {
  const Generation& generation = *chosen.generation;
  const bool partial = generation.members.size() < generation.planned;
  std::string column = fmt::format(
      "<li class=\"generation\"><b>{}{}</b>", generation.number,
      partial ? fmt::format(" ({}/{})", generation.members.size(), generation.planned) : "");
  for (const std::size_t place : chosen.best) column += sheet_cell(run, generation, place, anchor);
  return column + "</li>\n";
}

}  // namespace

std::string evolution_card(const Run& run, const std::string& anchor) {
  const std::vector<SheetColumn> generations = sheet(run);
  std::string columns = "<li class=\"ranks\"><b>generation</b><span>best</span>";
  for (std::size_t rank = 2; rank <= sheet_rows; ++rank)
    columns += fmt::format("<span>{}.</span>", rank);
  columns += "</li>\n";
  for (const SheetColumn& generation : generations)
    columns += sheet_column(run, generation, anchor);
  const std::string some =
      generations.size() < run.generations.size() ? " Not every generation is shown." : "";
  return fmt::format(
      "<section class=\"card long\">\n{}<div class=\"scroll\"><ol class=\"sheet\">\n{}</ol></div>\n"
      "</section>\n",
      heading(anchor + "-evolution", "Evolution",
              "The best four robots of each generation, with what they earned in it. A frame marks "
              "robots that "
              "were new in their generation, a coloured one the champion." +
                  some),
      columns);
}

namespace {

// ---- the lineage ------------------------------------------------------------------------------

std::string change_list(const std::vector<Change>& changed) {
  std::string items;
  for (std::size_t k = 0; k < std::min(changed.size(), changes_listed); ++k)
    items += fmt::format(
        "<li><span class=\"swatch {0}\"></span>{0} &rarr; "
        "<span class=\"swatch {1}\"></span>{1}</li>",
        kind_name(changed[k].before), kind_name(changed[k].after));
  if (changed.size() > changes_listed)
    items += fmt::format("<li>and {} more</li>", changed.size() - changes_listed);
  return items;
}

std::string gain(const Run& run, double difference) {
  return fmt::format("<span class=\"{}\">{}{}</span>", difference < 0 ? "down" : "up",
                     difference > 0 ? "+" : "", run.text(difference));
}

// What the robot has from its parent and what it has not.
std::string descent(const Run& run, const Entry& child, const Entry& from,
                    const std::vector<Change>& changed) {
  std::string html;
  if (child.fitness && from.fitness) html += " " + gain(run, *child.fitness - *from.fitness);
  html += "<ul>";
  const Body& before = from.robot.body;
  if (const Body& body = child.robot.body; before.rows != body.rows || before.cols != body.cols) {
    html += "<li>another size</li>";
  } else {
    html += fmt::format("<li>{} changed</li>", count_of(changed.size(), "voxel"));
    html += change_list(changed);
  }
  for (const std::string& id : child.robot.parents())
    if (id != from.robot.id)
      html += fmt::format("<li>{} <span class=\"id\">{}</span></li>",
                          run.by_id.contains(id) ? "also from" : "also from, not in this run,",
                          escaped(id));
  return html + "</ul>";
}

std::string lineage_step(const Run& run, const Entry& entry, const Entry* from,
                         const std::string& anchor) {
  std::vector<Change> changed;
  if (from != nullptr) changed = changes(from->robot.body, entry.robot.body);
  const std::string moving = run.replays.contains(run.by_id.at(entry.robot.id))
                                 ? fmt::format(
                                       "<canvas class=\"ancestor\" data-robot=\"{0}\" role=\"img\" "
                                       "aria-label=\"robot {0} moving\"></canvas>",
                                       entry.robot.id)
                                 : "";
  return fmt::format(
      "<li><div class=\"step\"><a href=\"#{}-{}\">{}{}</a><div><span class=\"score\">{}</span>{}"
      "<div class=\"note\">generation {}</div></div></div></li>\n",
      anchor, entry.robot.id, moving, picture(entry.robot.id, entry.robot.body, changed),
      run.text(entry.fitness), from != nullptr ? descent(run, entry, *from, changed) : "",
      entry.generation);
}

}  // namespace

std::string lineage_card(const Run& run, const std::string& anchor) {
  const std::vector<std::size_t> line = lineage(run.robots, run.by_id, *run.champion);
  if (line.size() == 1) return "";
  std::string html =
      "<section class=\"card long\">\n" +
      heading(
          anchor + "-lineage", "Lineage of the champion",
          fmt::format("{} from the first ancestor. Voxels that differ from the robot before are "
                      "outlined, and flash while it moves; the gain in fitness stands below.",
                      count_of(line.size() - 1, "step")));
  html += fmt::format("<ol class=\"line\" data-run=\"{}\">\n", anchor);
  for (std::size_t k = 0; k < line.size(); ++k)
    html +=
        lineage_step(run, run.robots[line[k]], k > 0 ? &run.robots[line[k - 1]] : nullptr, anchor);
  return html + "</ol>\n<div class=\"replay\"></div>\n</section>\n";
}

// ---- all robots -----------------------------------------------------------------------

std::string which_robots(const Run& run) {
  const std::size_t count = run.robots.size();
  if (run.shown.size() == count) return count_of(count, "robot");
  return fmt::format(
      "{} of {} robots: the fittest, the champion&rsquo;s ancestors, those that were the best "
      "when they came, and others evenly spread over the run (all of them: "
      "<code>evo-report --robots {}</code>, or history.jsonl)",
      grouped(static_cast<long long>(run.shown.size())), grouped(static_cast<long long>(count)),
      count);
}

std::string robots_card(const Run& run, const std::string& anchor) {
  return fmt::format(
      "<section class=\"card long\">\n{}<div class=\"robots\" data-run=\"{}\"></div>\n</section>\n",
      heading(
          anchor + "-robots", run.shown.size() < run.robots.size() ? "Robots" : "All robots",
          fmt::format("{}. &ldquo;Perturbed starts&rdquo; is the mean return from slightly "
                      "moved starts \u00b1 its standard error; &ldquo;changed&rdquo; counts the "
                      "voxels that differ from its parent.",
                      which_robots(run))),
      anchor);
}

// ---- settings -------------------------------------------------------------------------

std::string settings_card(const std::vector<const Run*>& runs) {
  std::vector<std::string> names;
  for (const Run* run : runs)
    for (const RunSetting& setting : run->settings)
      if (std::find(names.begin(), names.end(), setting.name) == names.end())
        names.push_back(setting.name);
  std::string head;
  if (runs.size() > 1) {
    head = "<thead><tr><th>setting</th>";
    for (const Run* run : runs) head += "<th>" + escaped(run->label) + "</th>";
    head += "</tr></thead>\n";
  }
  std::string rows;
  for (const std::string& name : names) {
    std::set<std::string> values;
    std::string cells;
    for (const Run* run : runs) {
      const std::string value = run->setting(name);
      values.insert(value);
      cells +=
          fmt::format("<td class=\"wrap\">{}</td>", value.empty() ? "&ndash;" : escaped(value));
    }
    rows += fmt::format("<tr{}><td>{}</td>{}</tr>\n", values.size() > 1 ? " class=\"differs\"" : "",
                        escaped(name), cells);
  }
  return fmt::format(
      "<section class=\"card\">\n<h3 id=\"settings\">Settings</h3>\n<div class=\"scroll\">"
      "<table class=\"data\">\n{}<tbody>\n{}</tbody></table></div>\n</section>\n",
      head, rows);
}

}  // namespace evo::report
