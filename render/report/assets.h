// The parts of a page that are files beside this one.
#pragma once

#include <string_view>

namespace evo::report {

std::string_view page_template();  // page.html
std::string_view style();          // report.css
std::string_view charts_script();  // charts.js
std::string_view stage_script();   // bindings/web/site/stage.js
std::string_view replay_script();  // replay.js
std::string_view script();         // report.js

}  // namespace evo::report
