// What evo-inspect says of documents that are no robots: tasks, profiles, settings,
// NEAT states, worlds.
#pragma once

#include <string>

#include "libevo/task/spec.h"

namespace evo::cli {

// What is observed of a full body of the shape that is usual in the task, what is rewarded, and
// what ends an episode.
std::string describe_task(const TaskSpec& task);

// Checks the document and prints what it is. False, and nothing printed, for a text
// that is none of these: robots, or nothing known. Throws Error(data).
bool print_document(const std::string& text, const std::string& name);

// Checks it as well, prints nothing, and gives its kind: "evo/task"; empty where the
// other says false.
std::string document_kind(const std::string& text, const std::string& name);

}  // namespace evo::cli
