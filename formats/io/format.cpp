#include "formats/io/format.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "libevo/base/error.h"

namespace evo {
namespace {

Error refused(const hdf5::Reader& file, const char* attribute, const std::string& problem) {
  return error(Failure::data, "{}: /@{}: {}", file.name(), attribute, problem);
}

// What is wrong with a head that says `name` (nothing: it does not say) or `version`, as words
// for a message that begins with the place.
std::optional<std::string> wrong_name(const Format& format,
                                      const std::optional<std::string>& name) {
  if (name == format.name) return std::nullopt;
  return fmt::format("format '{}' is expected, found {}", format.name,
                     name ? "'" + *name + "'" : "none");
}

std::optional<std::string> wrong_version(const Format& format, std::int64_t version) {
  if (version < 1) return fmt::format("a whole number from 1 is expected, found '{}'", version);
  if (version > format.version)
    return fmt::format("{} version {} is newer than this program, which reads up to {}",
                       format.name, version, format.version);
  return std::nullopt;
}

}  // namespace

void check_format(const Node& document, const Format& format, Head head) {
  const auto name = document.find("format");
  const auto version = document.find("version");
  if (name)
    if (const auto problem = wrong_name(format, name->string())) throw name->error(*problem);
  if (version)
    if (const auto problem = wrong_version(format, version->integer()))
      throw version->error(*problem);
  if (head != Head::required) return;
  if (!name) throw document.error(*wrong_name(format, std::nullopt));
  if (!version)
    throw document.error(fmt::format("there is no version, such as version: {}", format.version));
}

void check_format(const hdf5::Reader& file, const Format& format, Head head) {
  std::optional<std::string> name;
  if (file.has_attribute("/", "format")) name = file.text("/", "format");
  if (name || head == Head::required)
    if (const auto problem = wrong_name(format, name)) throw refused(file, "format", *problem);
  if (!name && !file.has_attribute("/", "version")) return;
  const double version = file.number<double>("/", "version");
  constexpr double largest_whole = 1e15;
  if (!(version == std::floor(version) && std::abs(version) < largest_whole))
    throw refused(file, "version",
                  fmt::format("a whole number from 1 is expected, found '{}'", version));
  if (const auto problem = wrong_version(format, static_cast<std::int64_t>(version)))
    throw refused(file, "version", *problem);
}

}  // namespace evo
