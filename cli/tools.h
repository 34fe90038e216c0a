// The tools by name: what each is for, in the order in which a run uses them. Their helps
// and `evo help` say it from here.
#pragma once

#include <string>
#include <vector>

namespace evo::cli {

struct Tool {
  std::string name;  // as a command of `evo`; the executable is evo-NAME
  std::string purpose;
};

struct Chapter {
  std::string title;
  std::vector<Tool> tools;
};

const std::vector<Chapter>& chapters();

// What evo-NAME is for, which must be one of them.
const std::string& purpose_of(const std::string& executable);

}  // namespace evo::cli
