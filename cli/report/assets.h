// The parts of a page that are files beside this one, and dygraphs.
#pragma once

#include <string_view>

namespace evo::report {

std::string_view page_template();  // page.html
std::string_view style();          // report.css
std::string_view script();         // report.js
std::string_view dygraphs_script();
std::string_view dygraphs_style();

}  // namespace evo::report
