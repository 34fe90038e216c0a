#include "render/report/parts.h"

#include <fmt/format.h>

#include "render/painters/vector.h"
#include "render/report/figures.h"

namespace evo::report {

std::string Page::link(const Robot& robot, const std::string& anchor) {
  return fmt::format("<a class=\"to-robot\" href=\"#{}-{}\">{}</a>", anchor, robot.id,
                     picture(robot.id, robot.body));
}

std::string Page::chart(const render::Figure& figure, render::Size size, const Run* run,
                        const std::string& anchor) {
  const render::Theme& theme = render::theme_by_name("light");
  const render::PageStyle style{{render::hex(theme.text), "var(--text)"},
                                {render::hex(theme.text_muted), "var(--muted)"},
                                {render::hex(theme.card), "var(--card)"}};
  const auto [drawing, frame] =
      std::visit([&](const auto& content) { return draw_chart(content, size, theme, typesetter); },
                 figure.content);
  const std::string key = fmt::format("chart-{}", charts.size() + 1);
  charts[key] = figure_data(figure, frame, run);
  return fmt::format(
      "<div class=\"chart\" data-chart=\"{}\" data-run=\"{}\" data-name=\"{}\">\n{}</div>\n", key,
      anchor, escaped(figure.name), encode_svg(drawing, figure.title, typesetter, &style));
}

void Page::navigate(const std::string& anchor, const std::string& text) {
  navigation += fmt::format("<a href=\"#{}\">{}</a>\n", anchor, escaped(text));
}

std::string picture(const std::string& id, const Body& body, const std::vector<Change>& changed) {
  std::string marks;
  for (const Change& change : changed)
    marks += fmt::format("M{} {}h1v1h-1z", change.col, change.row);
  if (!marks.empty()) marks = "<path class=\"changed\" d=\"" + marks + "\"/>";
  return fmt::format(
      "<svg class=\"body\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"robot "
      "{}\"><use href=\"#b-{}\"/>{}</svg>",
      body.cols, body.rows, id, id, marks);
}

std::string stage(const std::vector<Actor>& cast) {
  Json list = Json::array();
  for (const Actor& actor : cast) list.push_back({actor.anchor, actor.id, actor.name});
  return fmt::format("<div class=\"replay\" data-cast=\"{}\"></div>\n", escaped(compact(list)));
}

std::string heading(const std::string& id, const std::string& title, const std::string& about) {
  return fmt::format("<h3{}>{}</h3>\n<p class=\"about\">{}</p>\n",
                     id.empty() ? "" : fmt::format(" id=\"{}\"", id), title, about);
}

std::string count_of(std::size_t count, const std::string& thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

std::string fact(const std::string& name, const std::string& html) {
  return fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, html);
}

std::string cell(const std::string& sort_value, const std::string& html, const std::string& look) {
  return fmt::format("<td class=\"{}\" data-v=\"{}\">{}</td>", look, escaped(sort_value), html);
}
std::string cell(std::size_t value) { return cell(fmt::to_string(value), fmt::to_string(value)); }
std::string table_head(const std::vector<Column>& columns) {
  std::string head = "<thead><tr>";
  for (const Column& column : columns) {
    head += fmt::format("<th class=\"{}\"", column.look);
    if (column.first_order != nullptr) head += fmt::format(" data-sort=\"{}\"", column.first_order);
    head += fmt::format(">{}</th>", column.name);
  }
  return head + "</tr></thead>\n";
}

}  // namespace evo::report
