#include "render/report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>

#include "formats/io/values.h"
#include "libevo/base/join.h"
#include "render/report/assets.h"
#include "render/report/cards.h"
#include "render/report/charts.h"
#include "render/report/comparison.h"
#include "render/report/markup.h"
#include "render/report/robot_data.h"
#include "render/report/verdict.h"

namespace evo::report {
namespace {

// ---- sections ---------------------------------------------------------------------

std::string chart_card(const std::string& id, const std::string& title, const std::string& about,
                       const std::string& chart) {
  return "<section class=\"card\">\n" + heading(id, title, about) + chart + "</section>\n";
}

// What a chart shows of the robots, `all` of them or some.
std::string points_of(const Run& run, const std::string& anchor, const std::string& all) {
  if (run.shown.size() == run.robots.size()) return all;
  return fmt::format("{} <a href=\"#{}-robots\">{} of {} robots</a> are shown.", all, anchor,
                     grouped(static_cast<long long>(run.shown.size())),
                     grouped(static_cast<long long>(run.robots.size())));
}

std::string curves(const Run& run, const std::string& anchor, Page& page) {
  std::string html = "<div class=\"two\">\n";
  html += chart_card(anchor + "-curves", fmt::format("Fitness by robots {}", run.done()),
                     points_of(run, anchor, "The best fitness so far, and that of each robot."),
                     page.chart(progress_chart(run), anchor, "fitness-by-robots"));
  html += chart_card(
      "", "Fitness by generation",
      "Best over all robots of the generation; the median over those that were new in it, so "
      "that it does not jump as survivors thin out, with its quartiles.",
      page.chart(generation_chart(run), anchor, "fitness-by-generation"));
  return html + "</div>\n";
}

std::string features_card(const Run& run, const std::string& anchor, Page& page) {
  std::string charts;
  for (FeatureChart& feature : feature_charts(run))
    charts += page.chart(std::move(feature.chart), anchor, "fitness-by-" + feature.name, "small");
  return "<section class=\"card long\">\n" +
         heading(anchor + "-body", "Fitness and the body",
                 points_of(run, anchor,
                           "Every robot a point, the champion in orange. Point at one to "
                           "see its robot; a click or tap opens its card.")) +
         "<div class=\"three\">\n" + charts + "</div>\n</section>\n";
}

std::string tree_card(const Run& run, const std::string& anchor, Page& page) {
  return chart_card(
      anchor + "-tree", "Family tree",
      points_of(run, anchor,
                "Every robot where it was new, with lines from its parents; the champion's line "
                "of descent is drawn thick."),
      page.chart(tree_chart(run), anchor, "family-tree"));
}

// Where bodies were looked for, and which voxels go with fitness.
std::string maps_card(const Run& run, const std::string& anchor, Page& page) {
  std::string positions;
  std::string widest;
  for (FeatureChart& map : position_charts(run)) {
    widest = map.chart["widest"].dump();
    positions += "<div><h4>" + map.name + "</h4>" +
                 page.chart(std::move(map.chart), anchor, "positions-" + map.name, "small") +
                 "</div>\n";
  }
  std::string archive;
  if (Json chart = archive_chart(run); !chart.is_null())
    archive = heading(anchor + "-archive", "The archive",
                      "The fittest robot of every kind: the best fitness by the archive's first "
                      "axes; what lies beyond an end counts to the cell there. A click opens the "
                      "robot.") +
              page.chart(std::move(chart), anchor, "archive", "small");
  return "<section class=\"card long\">\n" + archive +
         heading(anchor + "-maps", "Where evolution looked",
                 "The best fitness of all robots with so many voxels and actuators. A click opens "
                 "the robot.") +
         page.chart(coverage_chart(run), anchor, "coverage", "small") +
         (positions.empty()
              ? ""
              : heading("", "Which voxels matter",
                        "For every place of the body: the median fitness of robots "
                        "with such a voxel there, less the median of all; the number "
                        "is how many robots that are. Of one or two nothing is said.") +
                    "<p class=\"scale\" data-scale=\"" + widest +
                    "\"></p>\n<div class=\"five\">\n" + positions + "</div>\n") +
         "</section>\n";
}

std::string learning_card(const Run& run, const std::string& anchor, Page& page) {
  Json chart = learning_chart(run);
  if (chart.is_null())
    return "<section class=\"card\">\n" +
           heading(anchor + "-learning", "Learning curves",
                   run.shared.empty()
                       ? "No policy files are in the run folder, so there are no curves."
                       : "No robot has had a training of its own, so there are no curves.") +
           "</section>\n";
  return chart_card(
      anchor + "-learning", "Learning curves",
      points_of(run, anchor,
                std::string(run.shared.empty()
                                ? "Returns of every robot's evaluations during its training"
                                : "Returns of robots that had trainings of their own") +
                    "; entropy, KL divergence and explained variance are on its card."),
      page.chart(std::move(chart), anchor, "learning-curves"));
}

// How the controller of all robots learnt, generation by generation.
std::string shared_card(const Run& run, const std::string& anchor, Page& page) {
  std::vector<FeatureChart> charts = shared_charts(run);
  if (charts.empty()) return "";
  std::string html =
      "<section class=\"card long\">\n" +
      heading(anchor + "-controller", "The controller of all robots",
              "The mean return over all robots of a generation while one controller learnt on "
              "them, and that of the best robot at its end. Where a generation begins the mean "
              "changes with the robots; training goes on from the controller of the one before.") +
      page.chart(std::move(charts[0].chart), anchor, "controller");
  std::string logged;
  for (std::size_t k = 1; k < charts.size(); ++k)
    logged +=
        page.chart(std::move(charts[k].chart), anchor, "controller-" + charts[k].name, "small");
  if (!logged.empty()) html += "<div class=\"three\">\n" + logged + "</div>\n";
  return html + "</section>\n";
}

void link_parts(const Run& run, const std::string& anchor, Page& page) {
  if (run.champion) {
    page.navigate(anchor + "-champion", "Champion");
    page.navigate(anchor + "-curves", "Curves");
    if (!run.shared.empty()) page.navigate(anchor + "-controller", "Controller");
    page.navigate(anchor + "-evolution", "Evolution");
    page.navigate(anchor + "-lineage", "Lineage");
    page.navigate(anchor + "-tree", "Family tree");
    page.navigate(anchor + "-body", "Bodies");
    page.navigate(anchor + "-learning", "Learning");
  }
  page.navigate("settings", "Settings");
  if (!run.robots.empty()) page.navigate(anchor + "-robots", "Robots");
  if (!judge(run).commands.empty()) page.navigate(anchor + "-next", "What next");
}

// Cards begin with h3, being parts of a run among several; on a page of their own, with h2.
std::string one_level_up(std::string html) {
  for (const auto& [from, to] :
       {std::pair{"<h3", "<h2"}, {"</h3>", "</h2>"}, {"<h4", "<h3"}, {"</h4>", "</h3>"}})
    for (std::size_t at = html.find(from); at != std::string::npos; at = html.find(from, at))
      html.replace(at, std::string_view(from).size(), to);
  return html;
}

void add_run(const Run& run, const std::string& anchor, bool alone, Page& page) {
  std::string html;
  if (alone) link_parts(run, anchor, page);
  if (!alone)
    html += fmt::format("<details id=\"{}\">\n<summary><h2>{} {}</h2></summary>\n", anchor,
                        escaped(run.label), badge(run));
  page.runs[anchor] = robots_data(run);
  if (run.champion) html += champion_card(run, anchor, page);
  html += verdict_card(run);
  html += tiles(run);
  if (run.champion) {
    html += curves(run, anchor, page);
    html += shared_card(run, anchor, page);
    html += evolution_card(run, anchor, page);
    html += lineage_card(run, anchor, page);
    html += tree_card(run, anchor, page);
    html += features_card(run, anchor, page);
    html += maps_card(run, anchor, page);
    const std::string learning = run.is_evaluated() ? "" : learning_card(run, anchor, page);
    html +=
        alone ? "<div class=\"two\">\n" + learning + settings_card({&run}) + "</div>\n" : learning;
  } else {
    html +=
        run.robots.empty()
            ? fmt::format("<p class=\"card note\">No robot has been {} yet.</p>\n", run.done())
            : fmt::format("<p class=\"card note\">No robot has a fitness: every {} failed.</p>\n",
                          run.is_evaluated() ? "one" : "training");
    if (alone) html += settings_card({&run});
  }
  if (!run.robots.empty()) html += robots_card(run, anchor, page);
  html += next_card(run, anchor);
  if (!alone) html += "</details>\n";
  page.sections += alone ? one_level_up(std::move(html)) : html;
}

std::string anchor_of(std::size_t run) { return fmt::format("run-{}", run + 1); }

std::string comparison_row(const Run& run, std::size_t number, Page& page) {
  const std::string anchor = anchor_of(number);
  std::string row = "<tr>";
  row += fmt::format("<td>{}</td>",
                     run.champion ? page.link(run.robots[*run.champion].robot, anchor) : "");
  row += cell(run.label, fmt::format("<a href=\"#{}\">{}</a>", anchor, escaped(run.label)), "");
  row += cell(run.subject(), escaped(run.subject()), "");
  for (const std::string& text : {run.method(), run.setting("seed")})
    row += cell(text, escaped(text), "");
  row += run.champion ? fitness_cell(run.robots[*run.champion].fitness) : cell("", "none yet");
  const auto score = run.champion ? run.robots[*run.champion].training.final_score : std::nullopt;
  row += score ? cell(fmt::to_string(score->mean), with_error(score->mean, score->standard_error))
               : cell("", "");
  row += run.champion ? cell(*run.champion + 1) : cell("", "");
  row += cell(fmt::to_string(run.robots.size()), trained(run));
  row += cell(run.generations.size());
  row += cell(run.failures());
  return row + "</tr>\n";
}

// Of the best run of each method, up to four, side by side.
std::string champions_of(const Comparison& comparison, const std::vector<Run>& runs) {
  constexpr std::size_t most = 4;
  std::vector<Actor> cast;
  for (const MethodResult& method : comparison.methods) {
    const Run* best = nullptr;
    for (const Run* run : method.group.runs)
      if (run->champion && run->replays.contains(*run->champion) &&
          (best == nullptr ||
           *run->robots[*run->champion].fitness > *best->robots[*best->champion].fitness))
        best = run;
    if (best == nullptr || cast.size() == most) continue;
    cast.push_back({anchor_of(static_cast<std::size_t>(best - runs.data())),
                    best->robots[*best->champion].robot.id, "Champion of " + best->label});
  }
  return cast.empty() ? "" : stage(cast);
}

std::string method_row(const Comparison& comparison, std::size_t k) {
  const MethodResult& method = comparison.methods[k];
  std::string row = "<tr>" + cell(method.group.label, escaped(method.group.label), "");
  row += cell(method.best.size());
  row += cell(fmt::to_string(method.median),
              fmt::format("<b>{}</b> <small>({} to {})</small>", shown(method.median),
                          shown(method.interval.low), shown(method.interval.high)));
  row += method.needed ? cell(*method.needed)
                       : cell("", fmt::format("more than {}", comparison.robots));
  if (comparison.methods.size() > 1) {
    row += k == 0 ? cell("", "&ndash;")
                  : cell(fmt::to_string(method.leader_ahead),
                         fmt::format("{:.0f} %", 100.0 * method.leader_ahead));
    row += k == 0 ? cell("", "&ndash;")
                  : cell(fmt::to_string(method.p),
                         method.p < 0.001 ? "&lt; 0.001" : fmt::format("{:.2g}", method.p));
  }
  return row + "</tr>\n";
}

// What the runs on one task say about the methods.
std::string answer_card(const std::string& task, const std::vector<const Run*>& group,
                        const std::vector<Run>& runs) {
  const Comparison comparison = compare(group);
  if (comparison.methods.empty()) return "";
  std::string purpose;
  for (const Run* run : group)
    if (purpose.empty()) purpose = purpose_in_words(*run);
  const std::string best = "median best fitness (95 %)";
  const std::string needed = "robots for " + shown(comparison.target);
  const std::string ahead = escaped(comparison.methods.front().group.label) + " ahead in";
  std::vector<Column> columns{
      {"method", "", "ascending"}, {"runs"}, {best.c_str()}, {needed.c_str(), "n", "ascending"}};
  if (comparison.methods.size() > 1)
    columns.insert(columns.end(), {{ahead.c_str()}, {"p", "n", "ascending"}});
  std::string rows;
  for (std::size_t k = 0; k < comparison.methods.size(); ++k) rows += method_row(comparison, k);
  return fmt::format(
      "<section class=\"card answer\">\n<h3>{}</h3>\n<p class=\"introduction\">{}{}</p>\n{}"
      "<div class=\"scroll\"><table class=\"data sortable\">\n{}<tbody>\n{}</tbody></table></div>\n"
      "<p class=\"about\">{}</p>\n</section>\n",
      escaped(task + ": " + comparison.headline),
      escaped(purpose.empty() ? ""
                              : fmt::format("Each run evolves robots to {}; what counts is the "
                                            "fitness of its best robot. ",
                                            purpose)),
      escaped(joined(comparison.sentences, " ")), champions_of(comparison, runs),
      table_head(columns), rows,
      "Runs count as far as the shortest of them goes. In brackets the 95 % interval of the median "
      "(percentile bootstrap, 10 000 resamples); &ldquo;ahead in&rdquo; is Vargha and "
      "Delaney&rsquo;s A, 50 % where there is no difference; p is of Mann and Whitney&rsquo;s U "
      "test, two-sided, with Holm&rsquo;s correction for several methods; robots are those until "
      "half of the runs had that fitness.");
}

std::string curve_of_task(const std::string& task, const std::vector<const Run*>& group,
                          Page& page) {
  return chart_card(
      "", "Best fitness so far on " + escaped(task),
      "By robots. Runs that differ in nothing but their seed are one curve, their "
      "median with its range (quartiles of eight runs or more), as far as all of them have "
      "come; each can be added.",
      page.chart(comparison_chart(group), "", "best-so-far-" + task));
}

void add_comparison(const std::vector<Run>& runs, Page& page) {
  std::string rows;
  std::vector<const Run*> all;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    rows += comparison_row(runs[k], k, page);
    all.push_back(&runs[k]);
  }
  std::string html;
  for (const auto& [task, group] : by_task(runs)) {
    html += answer_card(task, group, runs);
    html += curve_of_task(task, group, page);
  }
  html += fmt::format(
      "<section class=\"card\">\n{}<div class=\"scroll\"><table class=\"data sortable\">\n{}"
      "<tbody>\n{}</tbody></table></div>\n</section>\n",
      heading("", "Runs", "The champion of each run, and the robot of the run it was."),
      table_head({{"champion", "", nullptr},
                  {"run", "", "ascending"},
                  {"task", "", "ascending"},
                  {"method", "", "ascending"},
                  {"seed", "", "ascending"},
                  {"best fitness"},
                  {"perturbed starts"},
                  {"robot", "n", "ascending"},
                  {"robots"},
                  {"generations"},
                  {"failed"}}),
      rows);
  page.sections += one_level_up(html + settings_card(all));
}

// ---- the whole ---------------------------------------------------------------------

std::string title_of(const std::vector<Run>& runs) {
  if (runs.size() > 1) {
    const std::string task = runs[0].subject();
    const bool same = std::all_of(runs.begin(), runs.end(),
                                  [&](const Run& run) { return run.subject() == task; });
    return fmt::format("{}{} runs compared", same ? task + ": " : "", runs.size());
  }
  return fmt::format("{}: {}", runs[0].subject(), runs[0].label);
}

// "; trained on 2026-11-22 on host with evo-train 1.2", as far as it is known.
std::string when_and_where(const Run& run) {
  std::string text;
  if (run.ended > 0) {
    std::array<char, 16> day{};
    const std::time_t ended = run.ended;
    std::strftime(day.data(), day.size(), " on %Y-%m-%d", std::gmtime(&ended));
    text += day.data();
  }
  if (run.machines.size() == 1) text += " on " + escaped(run.machines.front());
  if (run.machines.size() > 1) text += " on " + count_of(run.machines.size(), "machine");
  if (run.champion)
    if (const std::string& tool = run.robots[*run.champion].training.created_by; !tool.empty())
      text += " with " + escaped(tool);
  return text.empty() ? "" : fmt::format("; {}{}", run.done(), text);
}

std::string lead(const std::vector<Run>& runs) {
  if (runs.size() > 1)
    return "Soft robots, bodies and controllers evolved together: what several runs say, and each";
  const Run& run = runs[0];
  return fmt::format("Co-design of soft robots by {}, bodies of {} voxels, seed {}{} {}",
                     escaped(run.method()), escaped(run.setting("shape")),
                     escaped(run.setting("seed")), when_and_where(run), badge(run));
}

std::string legend() {
  std::string html;
  for (const Voxel kind : voxel_kinds)
    html += fmt::format("<span><span class=\"swatch {0}\"></span>{0}{1}</span> ", kind_name(kind),
                        is_actuator(kind) ? " actuator" : " voxel");
  return html;
}

// JSON inside of a script element: no text in it can end the element.
std::string script_data(const Json& data) {
  std::string safe;
  for (const char c : compact(data)) safe += c == '<' ? "\\u003c" : std::string(1, c);
  return safe;
}

}  // namespace

std::string make_page(const std::vector<Run>& runs, const std::string& generator) {
  Page page;
  const bool alone = runs.size() == 1;
  if (!alone) add_comparison(runs, page);
  if (!alone) page.navigate("settings", "Settings");
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!alone) page.navigate(anchor_of(k), runs[k].label);
    add_run(runs[k], anchor_of(k), alone, page);
  }
  return fill(page_template(),
              {{"title", escaped(title_of(runs))},
               {"lead", lead(runs)},
               {"generator", escaped(generator)},
               {"style", std::string(style())},
               {"charts_script", std::string(charts_script())},
               {"stage_script", std::string(stage_script())},
               {"replay_script", std::string(replay_script())},
               {"script", std::string(script())},
               {"symbols", page.symbols},
               {"navigation", page.navigation},
               {"sections", page.sections},
               {"kinds", legend()},
               {"data", script_data({{"charts", page.charts}, {"runs", page.runs}})}});
}

}  // namespace evo::report
