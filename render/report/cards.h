// The sections about one run, each a card on the page.
#pragma once

#include <string>
#include <vector>

#include "render/report/parts.h"

namespace evo::report {

// "walk to the right over flat ground"; empty where no policy says it.
std::string purpose_in_words(const Run& run);

// What the run says.
std::string verdict_card(const Run& run);
// Commands that continue from it; nothing where there are none.
std::string next_card(const Run& run, const std::string& anchor);
// The figures of a run in one row.
std::string tiles(const Run& run);
std::string badge(const Run& run);    // finished or not
std::string trained(const Run& run);  // "24 of 250"

// It moves, in words, and what it is made of.
std::string champion_card(const Run& run, const std::string& anchor, Page& page);
// Six moments of its way; nothing without a recording.
std::string film_card(const Run& run);
// Whether it goes back to another robot of the run.
bool has_lineage(const Run& run);
// The best robots of every generation.
std::string evolution_card(const Run& run, const std::string& anchor);
std::string lineage_card(const Run& run, const std::string& anchor);
std::string robots_card(const Run& run, const std::string& anchor);
// A row a setting, a column a run; rows in which runs differ stand out.
std::string settings_card(const std::vector<const Run*>& runs);

}  // namespace evo::report
