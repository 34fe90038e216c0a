// Pieces of HTML and SVG. Everything that comes from a file goes through escaped().
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "formats/io/text.h"
#include "libevo/body/changes.h"

namespace evo::report {

// A field of comma-separated values (RFC 4180), quoted where it has to be; and those of a line.
std::string csv_field(const std::string& text);
std::vector<std::string> csv_fields(std::string_view line);

// The body, as report.js draws each once, `changed` cells outlined.
std::string picture(const std::string& id, const Body& body,
                    const std::vector<Change>& changed = {});

}  // namespace evo::report
