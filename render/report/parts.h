// The page under construction, and the pieces its sections are made of. Everything
// that comes from a file goes through escaped().
#pragma once

#include <string>
#include <vector>

#include "formats/io/text.h"
#include "libevo/body/changes.h"
#include "render/figures/chart.h"
#include "render/report/run.h"

namespace evo::report {

struct Page {
  std::string sections;
  std::string navigation;
  Json charts = Json::object();
  Json runs = Json::object();  // what report.js knows of robots, by the anchors of runs
  render::Typesetter typesetter;

  // A picture that leads to the robot's card.
  std::string link(const Robot& robot, const std::string& anchor);
  // A chart with what report.js says of its points; `run`: whose robots they are.
  std::string chart(const render::Figure& figure, render::Size size, const Run* run,
                    const std::string& anchor);
  void navigate(const std::string& anchor, const std::string& text);
};

// The body, as report.js draws each once, `changed` cells outlined.
std::string picture(const std::string& id, const Body& body,
                    const std::vector<Change>& changed = {});

// The place where report.js plays episodes side by side.
struct Actor {
  std::string anchor;  // of its run
  std::string id;
  std::string name;  // as the page calls it
};
std::string stage(const std::vector<Actor>& cast);

std::string heading(const std::string& id, const std::string& title, const std::string& about);
std::string count_of(std::size_t count, const std::string& thing);
std::string fact(const std::string& name, const std::string& html);

// ---- tables -------------------------------------------------------------------------

// A cell with what it is sorted by; empty sorts last.
std::string cell(const std::string& sort_value, const std::string& html,
                 const std::string& look = "n");
std::string cell(std::size_t value);

struct Column {
  const char* name;
  const char* look = "n";
  const char* first_order = "descending";  // nothing: not to be sorted by
};
std::string table_head(const std::vector<Column>& columns);

}  // namespace evo::report
