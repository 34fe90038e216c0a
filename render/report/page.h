// The page: one HTML document that needs nothing else.
#pragma once

#include <string>
#include <vector>

#include "render/report/run.h"

namespace evo::report {

struct PageOptions {
  std::string title;      // empty: from the runs
  std::string generator;  // tool and version
};

// At least one run; several are compared first, then shown one by one. The same
// runs give the same bytes.
std::string make_page(const std::vector<Run>& runs, const PageOptions& options);

}  // namespace evo::report
