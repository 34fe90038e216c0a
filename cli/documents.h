// What evo-inspect says of documents that are no robots: tasks, profiles, settings,
// NEAT states, worlds.
#pragma once

#include <optional>
#include <string>

#include "libevo/task/spec.h"

namespace evo::cli {

// What is observed of a full body of the shape that is usual in the task, what is rewarded, and
// what ends an episode.
std::string describe_task(const TaskSpec& task);

struct Document {
  std::string kind;  // "evo/task"
  std::string says;  // what it is, in lines
};

// Checks the document. Nothing for a text that is none of these: robots, or nothing known. Throws
// Error(data).
std::optional<Document> describe_document(const std::string& text, const std::string& name);

}  // namespace evo::cli
