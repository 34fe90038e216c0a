// Messages of the tools, all of them through spdlog: on standard error, with colours on a
// terminal, as "evo-train: warning: ...", and with the time in --log-file. Control
// characters in them are written as \x1b.
#pragma once

#include <optional>
#include <string>

namespace evo::cli::log {

// The process has one logger, named after the tool; to be called before the others.
void begin(const std::string& tool);

// What is less important than this ("debug", "info", "warning", "error", "off") is not said.
// `file` gets the same lines, after those it has. Throws Error(cannot_create).
void set(const std::string& level, const std::optional<std::string>& file);

void debug(const std::string& text);
void info(const std::string& text);
void warn(const std::string& text);
void error(const std::string& text);

}  // namespace evo::cli::log
