// Pieces of HTML and SVG. Everything that comes from a file goes through escaped().
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/text.h"
#include "libevo/body/changes.h"

namespace evo::report {

// "data:<media type>;base64,<bytes>"
std::string data_uri(const std::string& media_type, std::string_view bytes);

// {{name}} in `page` replaced by values[name]; values are not searched again.
// Throws std::logic_error for a name without value.
std::string fill(std::string_view page, const std::map<std::string, std::string>& values);

// A field of comma-separated values (RFC 4180), quoted where it has to be; and those of a line.
std::string csv_field(const std::string& text);
std::vector<std::string> csv_fields(std::string_view line);

// The body, as report.js draws each once, `changed` cells outlined.
std::string picture(const std::string& id, const Body& body,
                    const std::vector<Change>& changed = {});

}  // namespace evo::report
