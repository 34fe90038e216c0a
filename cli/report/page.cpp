#include "cli/report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

#include "cli/report/assets.h"
#include "cli/report/charts.h"
#include "cli/report/lineage.h"
#include "cli/report/markup.h"
#include "cli/terminal.h"

namespace evo::report {
namespace {

constexpr std::size_t sheet_rows = 4;      // best robots of a generation
constexpr std::size_t sheet_columns = 40;  // generations that still fit a screen by scrolling
constexpr std::size_t changes_listed = 4;  // of one mutation, in words
constexpr std::array kinds{Voxel::rigid, Voxel::soft, Voxel::horizontal, Voxel::vertical};

// ---- the page under construction ----------------------------------------------------

struct Page {
  std::string symbols;
  std::set<std::string> drawn;  // ids that have a symbol
  std::string sections;
  std::string navigation;
  Json charts = Json::object();

  // A picture, whose symbol is there after the first use.
  std::string body(const Robot& robot, const std::vector<Change>& changed = {}) {
    if (drawn.insert(robot.id).second) symbols += symbol(robot.id, robot.body);
    return picture(robot.id, robot.body, changed);
  }
  // The place where report.js draws the chart.
  std::string chart(Json data, const std::string& run, const std::string& look = "") {
    const std::string key = fmt::format("chart-{}", charts.size() + 1);
    charts[key] = std::move(data);
    return fmt::format("<div class=\"chart {}\" data-chart=\"{}\" data-run=\"{}\"></div>\n", look,
                       key, run);
  }
  void link(const std::string& anchor, const std::string& text) {
    navigation += fmt::format("<a href=\"#{}\">{}</a>\n", anchor, escape(text));
  }
};

std::string heading(const std::string& id, const std::string& title, const std::string& about) {
  return fmt::format("<h3{}>{}</h3>\n<p class=\"about\">{}</p>\n",
                     id.empty() ? "" : fmt::format(" id=\"{}\"", id), title, about);
}

std::string count_of(std::size_t count, const std::string& thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

// A table cell with what it is sorted by; empty sorts last.
std::string cell(const std::string& sort_value, const std::string& html,
                 const std::string& look = "n") {
  return fmt::format("<td class=\"{}\" data-v=\"{}\">{}</td>", look, escape(sort_value), html);
}
std::string cell(std::size_t value) { return cell(fmt::to_string(value), fmt::to_string(value)); }
std::string fitness_cell(const std::optional<double>& fitness) {
  return cell(fitness ? fmt::to_string(*fitness) : "", shown(fitness), "n fitness");
}

struct Column {
  const char* name;
  const char* look = "n";
  const char* first_order = "descending";  // nothing: not to be sorted by
  bool sorted = false;                     // in that order, as it is
};

std::string table_head(const std::vector<Column>& columns) {
  std::string head = "<thead><tr>";
  for (const Column& column : columns) {
    head += fmt::format("<th class=\"{}\"", column.look);
    if (column.first_order != nullptr) head += fmt::format(" data-sort=\"{}\"", column.first_order);
    if (column.sorted) head += fmt::format(" aria-sort=\"{}\"", column.first_order);
    head += fmt::format(">{}</th>", column.name);
  }
  return head + "</tr></thead>\n";
}

// ---- about a run -----------------------------------------------------------------------

bool finished(const Run& run) {
  const auto wanted = run.evaluations();
  return wanted && run.robots.size() >= *wanted;
}

std::string badge(const Run& run) {
  return finished(run) ? "<span class=\"badge\">finished</span>"
                       : "<span class=\"badge open\">unfinished</span>";
}

std::string trained(const Run& run) {
  const auto wanted = run.evaluations();
  return wanted ? fmt::format("{} <small>of {}</small>", run.robots.size(), *wanted)
                : fmt::to_string(run.robots.size());
}

long long training_steps(const Run& run) {
  long long steps = 0;
  for (const Entry& entry : run.robots) steps += entry.robot.steps().value_or(0);
  return steps;
}

std::string tile(const std::string& name, const std::string& value) {
  return fmt::format("<div class=\"tile\"><dt>{}</dt><dd>{}</dd></div>\n", name, value);
}

std::string tiles(const Run& run) {
  std::string html = "<dl class=\"tiles\">\n";
  html +=
      tile("best fitness", run.champion ? shown(run.robots[*run.champion].fitness) : "none yet");
  html += tile("robots trained", trained(run));
  html += tile("generations", fmt::to_string(run.generations.size()));
  html += tile("failed trainings", fmt::to_string(run.failures()));
  html += tile("training steps", cli::grouped(training_steps(run)));
  return html + "</dl>\n";
}

std::string kinds_of(const Body& body) {
  std::vector<std::string> parts;
  for (const Voxel kind : kinds)
    if (const auto count = std::count(body.cells.begin(), body.cells.end(), kind); count > 0)
      parts.push_back(
          fmt::format("<span class=\"part\"><span class=\"swatch {0}\"></span>{1} {0}</span>",
                      kind_name(kind), count));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string fact(const std::string& name, const std::string& html) {
  return fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, html);
}

// ---- the champion ------------------------------------------------------------------------

std::string moving_picture(const Video& video) {
  const std::string source = data_uri(video.media_type, video.bytes);
  if (video.media_type.starts_with("image/"))
    return fmt::format("<img src=\"{}\" alt=\"The champion at its task, moving\">\n", source);
  return fmt::format(
      "<video src=\"{}\" controls loop muted playsinline preload=\"auto\"></video>\n", source);
}

// Both themes; the style sheet shows one.
std::string still_pictures(const Film& film) {
  const auto image = [](const char* theme, const std::string& png) {
    return fmt::format(
        "<img class=\"film {}\" src=\"{}\" alt=\"Six moments of the champion at its task\">\n",
        theme, data_uri("image/png", png));
  };
  return image("light", film.light) + image("dark", film.dark);
}

std::string champion_facts(const Run& run) {
  const Entry& entry = run.robots[*run.champion];
  const Body& body = entry.robot.body;
  std::string facts = "<dl class=\"facts\">\n";
  facts += fact("id", fmt::format("<span class=\"id\">{}</span>", entry.robot.id));
  facts += fact("fitness", fmt::format("{}", *entry.fitness));
  if (run.final_score)
    facts +=
        fact("from shifted starts",
             fmt::format("{:.4g} &plusmn; {:.2g} (mean of {}, standard error)",
                         run.final_score->mean, run.final_score->standard_error,
                         count_of(static_cast<std::size_t>(run.final_score->episodes), "episode")));
  facts += fact("trained as", fmt::format("robot {} of the run, in generation {}",
                                          *run.champion + 1, entry.generation));
  facts += fact("body", fmt::format("{}&times;{}, {}: {}", body.rows, body.cols,
                                    count_of(static_cast<std::size_t>(count_voxels(body)), "voxel"),
                                    kinds_of(body)));
  return facts + "</dl>\n";
}

std::string champion_card(const Run& run, const std::string& anchor, Page& page) {
  const Robot& robot = run.robots[*run.champion].robot;
  std::string html =
      fmt::format("<section class=\"card\">\n<h3 id=\"{}-champion\">Champion</h3>\n", anchor);
  html += fmt::format("<div class=\"champion{}\">\n", run.video ? "" : " still");
  if (run.video) html += "<div>" + moving_picture(*run.video) + "</div>\n";
  if (!run.video) html += "<div>" + page.body(robot) + "</div>\n";
  html += "<div>";
  if (run.video) html += page.body(robot) + "\n";
  html += champion_facts(run) + "</div>\n</div>\n";
  if (run.film) html += still_pictures(*run.film);
  if (run.video_left_out > 0)
    html += fmt::format("<p class=\"note\">Its video of {} is left out (--max-video).</p>\n",
                        cli::file_size(run.video_left_out));
  return html + "</section>\n";
}

// ---- the evolution sheet -------------------------------------------------------------------

std::vector<std::size_t> best_of(const Generation& generation, const Run& run) {
  std::vector<std::size_t> best;
  for (const std::size_t member : generation.members)
    if (run.robots[member].fitness) best.push_back(member);
  std::stable_sort(best.begin(), best.end(), [&](std::size_t a, std::size_t b) {
    return *run.robots[a].fitness > *run.robots[b].fitness;
  });
  best.resize(std::min(best.size(), sheet_rows));
  return best;
}

// All generations, or as many as fit, evenly chosen, the first and the last among them.
std::vector<const Generation*> sheet_generations(const Run& run) {
  std::vector<const Generation*> begun;
  for (const Generation& generation : run.generations)
    if (!generation.members.empty()) begun.push_back(&generation);
  if (begun.size() <= sheet_columns) return begun;
  std::vector<const Generation*> chosen;
  for (std::size_t k = 0; k < sheet_columns; ++k)
    chosen.push_back(begun[k * (begun.size() - 1) / (sheet_columns - 1)]);
  return chosen;
}

std::string sheet_cell(const Run& run, std::size_t robot, int generation, const std::string& anchor,
                       Page& page) {
  const Entry& entry = run.robots[robot];
  const bool champion = robot == run.champion;
  return fmt::format("<a class=\"{}{}\" href=\"#{}-{}\">{}{}</a>",
                     entry.generation == generation ? "new" : "kept", champion ? " best" : "",
                     anchor, entry.robot.id, page.body(entry.robot), shown(entry.fitness));
}

std::string sheet_column(const Run& run, const Generation& generation, const std::string& anchor,
                         Page& page) {
  const bool partial = generation.members.size() < generation.planned;
  std::string column = fmt::format(
      "<li class=\"generation\"><b>{}{}</b>", generation.number,
      partial ? fmt::format(" ({}/{})", generation.members.size(), generation.planned) : "");
  for (const std::size_t robot : best_of(generation, run))
    column += sheet_cell(run, robot, generation.number, anchor, page);
  return column + "</li>\n";
}

std::string evolution_card(const Run& run, const std::string& anchor, Page& page) {
  const std::vector<const Generation*> generations = sheet_generations(run);
  std::string columns = "<li class=\"ranks\"><b>generation</b><span>best</span>";
  for (std::size_t rank = 2; rank <= sheet_rows; ++rank)
    columns += fmt::format("<span>{}.</span>", rank);
  columns += "</li>\n";
  for (const Generation* generation : generations)
    columns += sheet_column(run, *generation, anchor, page);
  const std::string some =
      generations.size() < run.generations.size() ? " Not every generation is shown." : "";
  return fmt::format(
      "<section class=\"card long\">\n{}<div class=\"scroll\"><ol class=\"sheet\">\n{}</ol></div>\n"
      "</section>\n",
      heading(anchor + "-evolution", "Evolution",
              "The best four robots of each generation, fitness below. A frame marks robots that "
              "were new in their generation, a coloured one the champion." +
                  some),
      columns);
}

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

std::string gain(double difference) {
  return fmt::format("<span class=\"{}\">{:+.3g}</span>", difference < 0 ? "down" : "up",
                     difference);
}

// What the robot has from its parent and what it has not.
std::string descent(const Run& run, const Entry& child, const Entry& from,
                    const std::optional<std::vector<Change>>& changed) {
  std::string html;
  if (child.fitness && from.fitness) html += " " + gain(*child.fitness - *from.fitness);
  html += "<ul>";
  if (!changed) {
    html += "<li>another size</li>";
  } else {
    html += fmt::format("<li>{} changed</li>", count_of(changed->size(), "voxel"));
    html += change_list(*changed);
  }
  for (const std::string& id : child.robot.parents())
    if (id != from.robot.id)
      html += fmt::format("<li>{} <span class=\"id\">{}</span></li>",
                          run.by_id.contains(id) ? "also from" : "also from, not in this run,",
                          escape(id));
  return html + "</ul>";
}

std::string lineage_step(const Run& run, const Entry& entry, const Entry* from,
                         const std::string& anchor, Page& page) {
  std::optional<std::vector<Change>> changed;
  if (from != nullptr) changed = changes(from->robot.body, entry.robot.body);
  return fmt::format(
      "<li><div class=\"step\"><a href=\"#{}-{}\">{}</a><div><span class=\"score\">{}</span>{}"
      "<div class=\"note\">generation {}</div></div></div></li>\n",
      anchor, entry.robot.id, page.body(entry.robot, changed.value_or(std::vector<Change>{})),
      shown(entry.fitness), from != nullptr ? descent(run, entry, *from, changed) : "",
      entry.generation);
}

std::string lineage_card(const Run& run, const std::string& anchor, Page& page) {
  const std::vector<std::size_t> line = lineage(run, *run.champion);
  std::string html = "<section class=\"card long\">\n";
  if (line.size() == 1) {
    html += heading(anchor + "-lineage", "Lineage of the champion",
                    run.robots[line[0]].robot.parents().empty()
                        ? "It has no parents: it was drawn anew, not made from another robot."
                        : "Its parents are not in this run.");
  } else {
    html += heading(anchor + "-lineage", "Lineage of the champion",
                    fmt::format("{} from the first ancestor; voxels that differ from the robot "
                                "before are outlined, and the gain in fitness stands beside it.",
                                count_of(line.size() - 1, "step")));
  }
  html += "<ol class=\"line\">\n";
  for (std::size_t k = 0; k < line.size(); ++k)
    html += lineage_step(run, run.robots[line[k]], k > 0 ? &run.robots[line[k - 1]] : nullptr,
                         anchor, page);
  return html + "</ol>\n</section>\n";
}

// ---- all robots
// -----------------------------------------------------------------------------------

// The number of a genome's genes; nothing for robots without genome.
std::optional<std::size_t> genes(const Robot& robot, const char* which) {
  const auto genome = robot.document.find("genome");
  if (genome == robot.document.end() || !genome->is_object()) return std::nullopt;
  const auto list = genome->find(which);
  if (list == genome->end() || !list->is_array()) return std::nullopt;
  return list->size();
}

std::string optional_cell(const std::optional<std::size_t>& value) {
  return value ? cell(*value) : cell("", "");
}

std::optional<std::size_t> voxels_changed(const Run& run, std::size_t robot) {
  const auto from = parent(run, robot);
  if (!from) return std::nullopt;
  const auto changed = changes(run.robots[*from].robot.body, run.robots[robot].robot.body);
  return changed ? std::optional(changed->size()) : std::nullopt;
}

std::string robot_row(const Run& run, std::size_t number, bool has_genomes,
                      const std::string& anchor, Page& page) {
  const Entry& entry = run.robots[number];
  const Body& body = entry.robot.body;
  std::string row = fmt::format("<tr id=\"{}-{}\"{}>", anchor, entry.robot.id,
                                number == run.champion ? " class=\"champion-row\"" : "");
  row += fmt::format("<td>{}</td>", page.body(entry.robot));
  row += entry.fitness ? fitness_cell(entry.fitness)
                       : cell("", "failed: " + escape(entry.failure), "n failed");
  row += cell(number + 1);
  row += cell(static_cast<std::size_t>(entry.generation));
  row += cell(static_cast<std::size_t>(count_voxels(body)));
  row += cell(static_cast<std::size_t>(count_actuators(body)));
  for (const Voxel kind : kinds)
    row += cell(static_cast<std::size_t>(std::count(body.cells.begin(), body.cells.end(), kind)));
  row += optional_cell(voxels_changed(run, number));
  if (has_genomes)
    row += optional_cell(genes(entry.robot, "nodes")) +
           optional_cell(genes(entry.robot, "connections"));
  row += cell(entry.robot.id, "<span class=\"id\">" + entry.robot.id + "</span>", "");
  return row + "</tr>\n";
}

// The fittest first, failed ones last, each in the order they were trained.
std::vector<std::size_t> ranked(const Run& run) {
  std::vector<std::size_t> order(run.robots.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return run.robots[a].fitness > run.robots[b].fitness;  // nothing is less than any number
  });
  return order;
}

std::string robots_card(const Run& run, const std::string& anchor, Page& page) {
  const bool has_genomes =
      std::any_of(run.robots.begin(), run.robots.end(),
                  [](const Entry& entry) { return genes(entry.robot, "nodes").has_value(); });
  std::vector<Column> columns{{"robot", "", nullptr},
                              {"fitness", "n", "descending", true},
                              {"number", "n", "ascending"},
                              {"generation", "n", "ascending"},
                              {"voxels"},
                              {"actuators"},
                              {"rigid"},
                              {"soft"},
                              {"horizontal"},
                              {"vertical"},
                              {"changed"}};
  if (has_genomes) columns.insert(columns.end(), {{"nodes"}, {"links"}});
  columns.push_back({"id", "", "ascending"});
  std::string rows;
  for (const std::size_t k : ranked(run)) rows += robot_row(run, k, has_genomes, anchor, page);
  return fmt::format(
      "<section class=\"card long\">\n{}<div class=\"scroll\">"
      "<table class=\"data robots sortable\">\n{}<tbody>\n{}</tbody></table></div>\n</section>\n",
      heading(anchor + "-robots", "All robots",
              fmt::format("{}. A click on a heading sorts by it. Numbers are the order of "
                          "training, "
                          "generations where a robot was new; &ldquo;changed&rdquo; counts the "
                          "voxels that differ from its parent{}.",
                          count_of(run.robots.size(), "robot"),
                          has_genomes ? ", nodes and links the genes of its network" : "")),
      table_head(columns), rows);
}

// ---- settings
// -----------------------------------------------------------------------------------------

// A row per setting, a column per run; rows in which runs differ stand out.
std::string settings_card(const std::vector<const Run*>& runs) {
  std::vector<std::string> names;
  for (const Run* run : runs)
    for (const Setting& setting : run->settings)
      if (std::find(names.begin(), names.end(), setting.name) == names.end())
        names.push_back(setting.name);
  std::string head;
  if (runs.size() > 1) {
    head = "<thead><tr><th>setting</th>";
    for (const Run* run : runs) head += "<th>" + escape(run->label) + "</th>";
    head += "</tr></thead>\n";
  }
  std::string rows;
  for (const std::string& name : names) {
    std::set<std::string> values;
    std::string cells;
    for (const Run* run : runs) {
      const std::string value = run->setting(name);
      values.insert(value);
      cells += fmt::format("<td class=\"wrap\">{}</td>", value.empty() ? "&ndash;" : escape(value));
    }
    rows += fmt::format("<tr{}><td>{}</td>{}</tr>\n", values.size() > 1 ? " class=\"differs\"" : "",
                        escape(name), cells);
  }
  return fmt::format(
      "<section class=\"card\">\n<h3 id=\"settings\">Settings</h3>\n<div class=\"scroll\">"
      "<table class=\"data\">\n{}<tbody>\n{}</tbody></table></div>\n</section>\n",
      head, rows);
}

// ---- sections
// ---------------------------------------------------------------------------------------------

std::string chart_card(const std::string& id, const std::string& title, const std::string& about,
                       const std::string& chart) {
  return "<section class=\"card\">\n" + heading(id, title, about) + chart + "</section>\n";
}

std::string curves(const Run& run, const std::string& anchor, Page& page) {
  std::string html = "<div class=\"two\">\n";
  html += chart_card(anchor + "-curves", "Fitness by robots trained",
                     "The best fitness so far, and the fitness of every robot.",
                     page.chart(progress_chart(run), anchor));
  html += chart_card("", "Fitness by generation", "Survivors included; the bands show the spread.",
                     page.chart(generation_chart(run), anchor));
  return html + "</div>\n";
}

std::string features_card(const Run& run, const std::string& anchor, Page& page) {
  std::string charts;
  for (FeatureChart& feature : feature_charts(run))
    charts += page.chart(std::move(feature.chart), anchor, "small");
  return "<section class=\"card long\">\n" +
         heading(anchor + "-body", "Fitness and the body",
                 "Every robot a point, the champion in orange. Hover over a point to see its "
                 "robot; a click leads to its row below.") +
         "<div class=\"three\">\n" + charts + "</div>\n</section>\n";
}

std::string learning_card(const Run& run, const std::string& anchor, Page& page) {
  Json chart = learning_chart(run);
  if (chart.is_null())
    return "<section class=\"card\">\n" +
           heading(anchor + "-learning", "Learning curve of the champion",
                   "Its policy file is not in the run folder, so there is no curve.") +
           "</section>\n";
  return chart_card(anchor + "-learning", "Learning curve of the champion",
                    "Returns of its evaluations during training.",
                    page.chart(std::move(chart), anchor));
}

void link_parts(const Run& run, const std::string& anchor, Page& page) {
  if (run.champion) {
    page.link(anchor + "-champion", "Champion");
    page.link(anchor + "-curves", "Curves");
    page.link(anchor + "-evolution", "Evolution");
    page.link(anchor + "-lineage", "Lineage");
    page.link(anchor + "-body", "Bodies");
    page.link(anchor + "-learning", "Learning");
  }
  page.link("settings", "Settings");
  if (!run.robots.empty()) page.link(anchor + "-robots", "Robots");
}

void add_run(const Run& run, const std::string& anchor, bool alone, Page& page) {
  std::string html;
  if (alone) link_parts(run, anchor, page);
  if (!alone)
    html += fmt::format("<details id=\"{}\">\n<summary><h2>{} {}</h2></summary>\n", anchor,
                        escape(run.label), badge(run));
  html += tiles(run);
  if (run.champion) {
    html += champion_card(run, anchor, page);
    html += curves(run, anchor, page);
    html += evolution_card(run, anchor, page);
    html += lineage_card(run, anchor, page);
    html += features_card(run, anchor, page);
    const std::string learning = learning_card(run, anchor, page);
    html +=
        alone ? "<div class=\"two\">\n" + learning + settings_card({&run}) + "</div>\n" : learning;
  } else {
    html += run.robots.empty()
                ? "<p class=\"card note\">No robot has been trained yet.</p>\n"
                : "<p class=\"card note\">No robot has a fitness: every training failed.</p>\n";
    if (alone) html += settings_card({&run});
  }
  if (!run.robots.empty()) html += robots_card(run, anchor, page);
  if (!alone) html += "</details>\n";
  page.sections += html;
}

std::string anchor_of(std::size_t run) { return fmt::format("run-{}", run + 1); }

std::string comparison_row(const Run& run, std::size_t number, Page& page) {
  const std::string anchor = anchor_of(number);
  std::string row = "<tr>";
  row += fmt::format("<td>{}</td>", run.champion ? page.body(run.robots[*run.champion].robot) : "");
  row += cell(run.label, fmt::format("<a href=\"#{}\">{}</a>", anchor, escape(run.label)), "");
  for (const char* name : {"task", "method", "seed"})
    row += cell(run.setting(name), escape(run.setting(name)), "");
  row += run.champion ? fitness_cell(run.robots[*run.champion].fitness) : cell("", "none yet");
  row += run.champion ? cell(*run.champion + 1) : cell("", "");
  row += cell(fmt::to_string(run.robots.size()), trained(run));
  row += cell(run.generations.size());
  row += cell(run.failures());
  return row + "</tr>\n";
}

void add_comparison(const std::vector<Run>& runs, Page& page) {
  std::string rows;
  std::vector<const Run*> all;
  std::vector<std::pair<std::string, std::vector<const Run*>>> tasks;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    rows += comparison_row(runs[k], k, page);
    all.push_back(&runs[k]);
    const std::string task = runs[k].setting("task");
    auto known = std::find_if(tasks.begin(), tasks.end(),
                              [&](const auto& group) { return group.first == task; });
    if (known == tasks.end()) known = tasks.insert(tasks.end(), {task, {}});
    known->second.push_back(&runs[k]);
  }
  page.sections += fmt::format(
      "<section class=\"card\">\n{}<div class=\"scroll\"><table class=\"data sortable\">\n{}"
      "<tbody>\n{}</tbody></table></div>\n</section>\n",
      heading("", "Runs", "The champion of each run, and the robot of the run it was."),
      table_head({{"champion", "", nullptr},
                  {"run", "", "ascending"},
                  {"task", "", "ascending"},
                  {"method", "", "ascending"},
                  {"seed", "", "ascending"},
                  {"best fitness"},
                  {"robot", "n", "ascending"},
                  {"trained"},
                  {"generations"},
                  {"failed"}}),
      rows);
  for (const auto& [task, group] : tasks)
    page.sections += chart_card(
        "", "Best fitness so far on " + escape(task),
        "By robots trained. Runs that differ in nothing but their seed are one curve, their mean "
        "with its standard deviation as far as all of them have come; each can be added.",
        page.chart(comparison_chart(group), ""));
  page.sections += settings_card(all);
}

// ---- the whole
// --------------------------------------------------------------------------------------------

std::string default_title(const std::vector<Run>& runs) {
  if (runs.size() > 1) {
    const std::string task = runs[0].setting("task");
    const bool same = std::all_of(runs.begin(), runs.end(),
                                  [&](const Run& run) { return run.setting("task") == task; });
    return fmt::format("{}{} runs compared", same ? task + ": " : "", runs.size());
  }
  return fmt::format("{}: {}", runs[0].setting("task"), runs[0].label);
}

std::string lead(const std::vector<Run>& runs) {
  if (runs.size() > 1) return "Co-design of soft robots, several runs side by side";
  const Run& run = runs[0];
  return fmt::format("Co-design of soft robots by {}, bodies of {} voxels, seed {} {}",
                     escape(run.setting("method")), escape(run.setting("shape")),
                     escape(run.setting("seed")), badge(run));
}

std::string legend() {
  std::string html;
  for (const Voxel kind : kinds)
    html += fmt::format("<span><span class=\"swatch {0}\"></span>{0}{1}</span> ", kind_name(kind),
                        is_actuator(kind) ? " actuator" : " voxel");
  return html;
}

// A browser's developer tools would look for the map beside the page.
std::string without_source_map(std::string_view text) {
  const std::size_t end = std::min(text.rfind("//# sourceMap"), text.rfind("/*# sourceMap"));
  return std::string(text.substr(0, end));
}

// JSON inside of a script element: no text in it can end the element.
std::string script_data(const Json& data) {
  std::string safe;
  for (const char c : compact(data)) safe += c == '<' ? "\\u003c" : std::string(1, c);
  return safe;
}

}  // namespace

std::string make_page(const std::vector<Run>& runs, const PageOptions& options) {
  Page page;
  const bool alone = runs.size() == 1;
  if (!alone) add_comparison(runs, page);
  if (!alone) page.link("settings", "Settings");
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!alone) page.link(anchor_of(k), runs[k].label);
    add_run(runs[k], anchor_of(k), alone, page);
  }
  const std::string title = escape(options.title.empty() ? default_title(runs) : options.title);
  return fill(page_template(), {{"title", title},
                                {"lead", lead(runs)},
                                {"generator", escape(options.generator)},
                                {"dygraphs_css", without_source_map(dygraphs_style())},
                                {"dygraphs_js", without_source_map(dygraphs_script())},
                                {"style", std::string(style())},
                                {"script", std::string(script())},
                                {"symbols", page.symbols},
                                {"navigation", page.navigation},
                                {"sections", page.sections},
                                {"kinds", legend()},
                                {"charts", script_data(page.charts)}});
}

}  // namespace evo::report
