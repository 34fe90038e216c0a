#include "cli/log.h"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <memory>

#include "formats/io/text.h"
#include "libevo/base/error.h"

namespace evo::cli::log {
namespace {

void say(spdlog::level::level_enum level, const std::string& text) {
  spdlog::log(level, "{}", printable(text));
}

}  // namespace

void begin(const std::string& tool) {
  const bool plain = std::getenv("NO_COLOR") != nullptr;
  const auto terminal = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(
      plain ? spdlog::color_mode::never : spdlog::color_mode::automatic);
  terminal->set_pattern("%n: %^%l%$: %v");
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(tool, terminal));
}

void set(const std::string& level, const std::optional<std::string>& file) {
  const auto logger = spdlog::default_logger();
  logger->set_level(spdlog::level::from_str(level));
  if (!file) return;
  try {
    const auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(*file);
    sink->set_pattern("%Y-%m-%dT%H:%M:%S.%e%z %n[%P] %l: %v");
    logger->sinks().push_back(sink);
    logger->flush_on(spdlog::level::debug);
  } catch (const spdlog::spdlog_ex& failure) {
    throw evo::error(Failure::cannot_create, "--log-file: {}", failure.what());
  }
}

void debug(const std::string& text) { say(spdlog::level::debug, text); }
void info(const std::string& text) { say(spdlog::level::info, text); }
void warn(const std::string& text) { say(spdlog::level::warn, text); }
void error(const std::string& text) { say(spdlog::level::err, text); }

}  // namespace evo::cli::log
