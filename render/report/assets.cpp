#include "render/report/assets.h"

#include "render/painters/embed.h"

EVO_EMBED(evo_report_page, EVO_REPORT_PAGE);
EVO_EMBED(evo_report_style, EVO_REPORT_STYLE);
EVO_EMBED(evo_report_script, EVO_REPORT_SCRIPT);
EVO_EMBED(evo_report_charts, EVO_REPORT_CHARTS);
EVO_EMBED(evo_report_stage, EVO_REPORT_STAGE);
EVO_EMBED(evo_report_replay, EVO_REPORT_REPLAY);

namespace evo::report {

std::string_view page_template() { return EVO_EMBEDDED(evo_report_page); }
std::string_view style() { return EVO_EMBEDDED(evo_report_style); }
std::string_view script() { return EVO_EMBEDDED(evo_report_script); }
std::string_view charts_script() { return EVO_EMBEDDED(evo_report_charts); }
std::string_view stage_script() { return EVO_EMBEDDED(evo_report_stage); }
std::string_view replay_script() { return EVO_EMBEDDED(evo_report_replay); }

}  // namespace evo::report
