// The page: one HTML document that needs nothing else.
#pragma once

#include <string>
#include <vector>

#include "render/report/run.h"

namespace evo::report {

// At least one run; several are compared first, then shown one by one. The same
// runs give the same bytes. `generator`: tool and version.
std::string make_page(const std::vector<Run>& runs, const std::string& generator);

}  // namespace evo::report
