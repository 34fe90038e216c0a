// The comparison as data: for statistics programs, spreadsheets and papers.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/io/text.h"
#include "formats/run/run.h"
#include "render/report/comparison.h"
#include "render/report/figures.h"

namespace evo::report {
namespace {

const std::vector<std::string> columns{"task", "method", "runs",         "robots", "median",
                                       "low",  "high",   "leader_ahead", "p",      "needed"};

const char* separator(TableFormat format) { return format == TableFormat::csv ? "," : "\t"; }

std::string tsv_field(std::string text) {
  for (char& c : text)
    if (c == '\t' || c == '\r' || c == '\n') c = ' ';
  return text;
}

std::string latex_text(const std::string& text) {
  std::string made;
  for (const char c : text) {
    if (c == '\\')
      made += "\\textbackslash{}";
    else if (c == '~' || c == '^')
      made += fmt::format("\\{}{{}}", c);
    else
      made += std::string_view("#$%&_{}").find(c) == std::string_view::npos
                  ? std::string(1, c)
                  : fmt::format("\\{}", c);
  }
  return made;
}

std::string data_line(const std::string& task, const Comparison& comparison,
                      const MethodResult& method, TableFormat format) {
  const bool csv = format == TableFormat::csv;
  const auto text = [&](const std::string& word) {
    return csv ? csv_field(word) : tsv_field(word);
  };
  const std::vector<std::string> fields{text(task),
                                        text(method.group.label),
                                        fmt::to_string(method.best.size()),
                                        fmt::to_string(comparison.robots),
                                        fmt::to_string(method.median),
                                        fmt::to_string(method.interval.low),
                                        fmt::to_string(method.interval.high),
                                        fmt::to_string(method.leader_ahead),
                                        fmt::to_string(method.p),
                                        method.needed ? fmt::to_string(*method.needed) : ""};
  return fmt::format("{}", fmt::join(fields, separator(format)));
}

// "< 0.001" or three digits; nothing for the leader.
std::string p_value(double p) { return p < 0.001 ? "< 0.001" : fmt::format("{:.3f}", p); }

std::string latex_line(const Comparison& comparison, std::size_t number) {
  const MethodResult& method = comparison.methods[number];
  const std::string against =
      number == 0 ? "-- & --"
                  : fmt::format("{:.2f} & ${}$", method.leader_ahead, p_value(method.p));
  return fmt::format("{} & {} & ${:.3f}$ [${:.3f}$, ${:.3f}$] & {} & {} \\\\",
                     latex_text(method.group.label), method.best.size(), method.median,
                     method.interval.low, method.interval.high, against,
                     method.needed ? fmt::to_string(*method.needed) : "--");
}

std::string text_line(const Comparison& comparison, std::size_t number) {
  const MethodResult& method = comparison.methods[number];
  return fmt::format("  {:>2}  {:<24} {:>4} {:>9.3f}  {:<19} {:>7}", number + 1,
                     printable(method.group.label), method.best.size(), method.median,
                     fmt::format("{:.3f} to {:.3f}", method.interval.low, method.interval.high),
                     number == 0 ? "" : p_value(method.p));
}

}  // namespace

std::string comparison_table(const std::vector<Run>& runs, TableFormat format) {
  std::vector<std::string> lines;
  if (format == TableFormat::latex)
    lines.insert(
        lines.end(),
        {"% Median best fitness of the runs with its 95 % interval (percentile bootstrap), Vargha",
         "% and Delaney's A of the best method against this one, p of Mann and Whitney's U test",
         "% with Holm's correction, robots until half of the runs had the lowest median.",
         "% \\usepackage{booktabs}", "\\begin{tabular}{lrrrrr}", "\\toprule",
         "method & runs & median [95\\,\\%] & $A$ & $p$ & robots \\\\"});
  else if (format != TableFormat::text)
    lines.push_back(fmt::format("{}", fmt::join(columns, separator(format))));
  for (const auto& [subject, group] : by_task(runs)) {
    const std::string task = group.front()->is_evaluated() ? subject : task_label(subject);
    const Comparison comparison = compare(group);
    if (format == TableFormat::latex && !comparison.methods.empty())
      lines.insert(lines.end(),
                   {"\\midrule", fmt::format("\\multicolumn{{6}}{{l}}{{{}, {} robots}} \\\\",
                                             latex_text(task), comparison.robots)});
    if (format == TableFormat::text)
      lines.insert(lines.end(),
                   {fmt::format("{}, {} robots of each run", printable(task), comparison.robots),
                    "      method                   runs    median  95 %                      p"});
    for (std::size_t k = 0; k < comparison.methods.size(); ++k)
      lines.push_back(format == TableFormat::latex ? latex_line(comparison, k)
                      : format == TableFormat::text
                          ? text_line(comparison, k)
                          : data_line(task, comparison, comparison.methods[k], format));
  }
  if (format == TableFormat::latex) lines.insert(lines.end(), {"\\bottomrule", "\\end{tabular}"});
  return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace evo::report
