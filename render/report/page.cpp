#include "render/report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <map>

#include "formats/io/values.h"
#include "libevo/base/join.h"
#include "render/painters/embed.h"
#include "render/report/cards.h"
#include "render/report/comparison.h"
#include "render/report/figures.h"
#include "render/report/robot_data.h"
#include "render/report/verdict.h"

// Files beside this one, and bindings/web/site/stage.js.
EVO_EMBED(evo_report_page, EVO_ROOT "/render/report/page.html");
EVO_EMBED(evo_report_style, EVO_ROOT "/render/report/report.css");
EVO_EMBED(evo_report_script, EVO_ROOT "/render/report/report.js");
EVO_EMBED(evo_report_charts, EVO_ROOT "/render/report/charts.js");
EVO_EMBED(evo_report_stage, EVO_ROOT "/bindings/web/site/stage.js");
EVO_EMBED(evo_report_replay, EVO_ROOT "/render/report/replay.js");

namespace evo::report {
namespace {

// ---- sections ---------------------------------------------------------------------

constexpr render::Size half_page{440, 270};  // a chart's, in pixels of a wide screen
constexpr render::Size third_page{340, 220};
constexpr render::Size fifth_page{210, 200};

// What charts of one scale share.
std::string scale_of(const FigureGroup& group, const Run& run) {
  const auto* table = std::get_if<render::ColorTable>(&group.figures.front().content);
  if (table == nullptr || table->widest == 0) return "";
  const std::string end = number(table->widest, run.decimals());
  return fmt::format("<p class=\"scale\">\u2212{0} <span class=\"gradient\"></span> +{0}</p>\n",
                     end);
}

// A card for each group; several figures fill one as wide as the page.
std::string figure_card(const FigureGroup& group, const Run& run, const std::string& anchor,
                        Page& page) {
  const std::string id = anchor + "-" + group.id;
  const render::Figure& first = group.figures.front();
  if (group.figures.size() == 1)
    return "<section class=\"card\">\n" + heading(id, first.title, first.about) +
           page.chart(first, half_page, &run, anchor) + "</section>\n";
  const bool many = group.figures.size() == 5;
  std::string html = "<section class=\"card long\">\n" + heading(id, group.title, group.about) +
                     scale_of(group, run) +
                     fmt::format("<div class=\"{}\">\n", many ? "five" : "three");
  for (const render::Figure& figure : group.figures) {
    const render::Size size = figure.name == "archive" ? half_page : many ? fifth_page : third_page;
    html += fmt::format("<div><h4>{}</h4>\n{}</div>\n", figure.title,
                        page.chart(figure, size, &run, anchor));
  }
  return html + "</div>\n</section>\n";
}

// What everyone looks at first: the robot, what came of it, the figures and the curve.
std::string first_screen(const Run& run, const FigureGroup& curve, const std::string& anchor,
                         Page& page) {
  return "<div class=\"first\">\n" + champion_card(run, anchor, page) + "<div>\n" +
         verdict_card(run) + tiles(run) + "<section class=\"card\">\n" +
         heading(anchor + "-curve", curve.figures[0].title, "") +
         page.chart(curve.figures[0], half_page, &run, anchor) + "</section>\n</div>\n</div>\n";
}

void link_parts(const Run& run, const std::vector<FigureGroup>& groups, const std::string& anchor,
                Page& page) {
  const auto link = [&](const char* id, const char* title) {
    if (std::ranges::find(groups, id, &FigureGroup::id) != groups.end())
      page.navigate(anchor + "-" + id, title);
  };
  link("archive", "Archive");
  if (run.champion) page.navigate(anchor + "-evolution", "Evolution");
  if (run.champion && has_lineage(run)) page.navigate(anchor + "-lineage", "Lineage");
  link("controller", "Controller");
  link("tree", "Family tree");
  link("learning", "Learning");
  link("body", "Bodies");
  if (!run.robots.empty()) page.navigate(anchor + "-robots", "Robots");
  page.navigate("settings", "Settings");
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
  std::vector<FigureGroup> groups;
  if (run.champion) groups = figures(run);
  std::string html;
  if (alone) link_parts(run, groups, anchor, page);
  if (!alone)
    html += fmt::format("<details id=\"{}\">\n<summary><h2>{} {}</h2></summary>\n", anchor,
                        escaped(run.label), badge(run));
  page.runs[anchor] = robots_data(run);
  if (run.champion) {
    html += first_screen(run, groups.front(), anchor, page) + "<div class=\"cards\">\n";
    const bool archive = groups[1].id == "archive";
    if (archive) html += figure_card(groups[1], run, anchor, page);
    html += film_card(run) + evolution_card(run, anchor) + lineage_card(run, anchor);
    for (const FigureGroup& group : groups)
      if (group.id != "curve" && group.id != "archive")
        html += figure_card(group, run, anchor, page);
  } else {
    html += verdict_card(run) + tiles(run) + "<div class=\"cards\">\n";
  }
  if (!run.robots.empty()) html += robots_card(run, anchor);
  if (alone) html += settings_card({&run});
  html += next_card(run, anchor) + "</div>\n";
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
  const auto fitness = run.champion ? run.robots[*run.champion].fitness : std::nullopt;
  row += fitness ? cell(fmt::to_string(*fitness), run.text(fitness)) : cell("", "none yet");
  const auto score = run.champion ? run.robots[*run.champion].training.final_score : std::nullopt;
  row +=
      score ? cell(fmt::to_string(score->mean), with_error(run, score->mean, score->standard_error))
            : cell("", "");
  row += run.champion ? cell(*run.champion + 1) : cell("", "");
  row += cell(fmt::to_string(run.robots.size()), trained(run));
  row += cell(run.generations.size());
  row += cell(run.failures());
  return row + "</tr>\n";
}

// Champions of the best run of each method, up to four, side by side.
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
  const auto text = [&](double value) { return number(value, comparison.decimals); };
  std::string row = "<tr>" + cell(method.group.label, escaped(method.group.label), "");
  row += cell(method.best.size());
  row += cell(fmt::to_string(method.median),
              fmt::format("<b>{}</b> <small>({} to {})</small>", text(method.median),
                          text(method.interval.low), text(method.interval.high)));
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
  const std::string needed = "robots for " + number(comparison.target, comparison.decimals);
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
  const render::Figure figure = comparison_figure(task, group);
  return "<section class=\"card wide\">\n" + heading("", escaped(figure.title), figure.about) +
         page.chart(figure, {720, 320}, nullptr, "") + "</section>\n";
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
  return judge(runs[0]).result;
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
  return fmt::format("{}: soft robots by {}, bodies of {} voxels, seed {}{} {}", escaped(run.label),
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

// {{name}} in `page` replaced by values[name]; values are not searched again.
std::string fill(std::string_view page, const std::map<std::string, std::string>& values) {
  std::string filled;
  for (std::size_t at = 0;;) {
    const std::size_t open = page.find("{{", at);
    filled += page.substr(at, open - at);
    if (open == std::string_view::npos) return filled;
    const std::size_t close = page.find("}}", open);
    filled += values.at(std::string(page.substr(open + 2, close - open - 2)));
    at = close + 2;
  }
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
  return fill(EVO_EMBEDDED(evo_report_page),
              {{"title", escaped(title_of(runs))},
               {"lead", lead(runs)},
               {"generator", escaped(generator)},
               {"style", std::string(EVO_EMBEDDED(evo_report_style))},
               {"charts_script", std::string(EVO_EMBEDDED(evo_report_charts))},
               {"stage_script", std::string(EVO_EMBEDDED(evo_report_stage))},
               {"replay_script", std::string(EVO_EMBEDDED(evo_report_replay))},
               {"script", std::string(EVO_EMBEDDED(evo_report_script))},
               {"navigation", page.navigation},
               {"sections", page.sections},
               {"kinds", legend()},
               {"data", script_data({{"charts", page.charts}, {"runs", page.runs}})}});
}

}  // namespace evo::report
