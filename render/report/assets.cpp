// The files as bytes of the program: the assembler includes them where CMake
// found them.
#include "render/report/assets.h"

// NOLINTBEGIN(bugprone-macro-parentheses): a path is one of several adjacent literals
#define EVO_EMBED(symbol, path)            \
  __asm__(".section .rodata\n" #symbol     \
          ":\n"                            \
          ".incbin \"" path "\"\n" #symbol \
          "_end:\n"                        \
          ".byte 0\n"                      \
          ".previous\n");                  \
  extern "C" const char symbol[];          \
  extern "C" const char symbol##_end[]
// NOLINTEND(bugprone-macro-parentheses)

EVO_EMBED(evo_report_page, EVO_REPORT_PAGE);
EVO_EMBED(evo_report_style, EVO_REPORT_STYLE);
EVO_EMBED(evo_report_script, EVO_REPORT_SCRIPT);
EVO_EMBED(evo_report_charts, EVO_REPORT_CHARTS);
EVO_EMBED(evo_report_stage, EVO_REPORT_STAGE);
EVO_EMBED(evo_report_replay, EVO_REPORT_REPLAY);

namespace evo::report {
namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::string_view page_template() { return between(evo_report_page, evo_report_page_end); }
std::string_view style() { return between(evo_report_style, evo_report_style_end); }
std::string_view script() { return between(evo_report_script, evo_report_script_end); }
std::string_view charts_script() { return between(evo_report_charts, evo_report_charts_end); }
std::string_view stage_script() { return between(evo_report_stage, evo_report_stage_end); }
std::string_view replay_script() { return between(evo_report_replay, evo_report_replay_end); }

}  // namespace evo::report
