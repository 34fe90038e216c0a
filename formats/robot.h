// The robot document (spec: formats, "Robot document"): JSON, JSON Lines, YAML,
// or a plain grid of letters.
#pragma once

#include <istream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libevo/body/body.h"

namespace evo {

// Key order is kept, so that what passes through a tool stays recognisable.
using Json = nlohmann::ordered_json;

struct Robot {
  Body body;
  std::string id;  // identity(body)
  Json document;   // all fields as read, unknown ones included; body and id set

  Robot() = default;
  explicit Robot(Body body);  // a fresh document: format, version, id, body

  // The `fitness` field: nothing when absent or null (failed).
  std::optional<double> fitness() const;
};

enum class BodyCheck { any, robot };  // robot: connected and has an actuator

// One document. `where` begins every message (a file name, "line 7", ...).
// Throws Error(data) with the JSON path or the cell.
Robot robot_from_json(const Json& document, const std::string& where,
                      BodyCheck check = BodyCheck::robot);
// The document in its canonical field order; ends without newline.
std::string robot_to_line(const Robot& robot);  // JSON Lines
std::string robot_to_json(const Robot& robot);  // indented, for a file of its own
std::string robot_to_yaml(const Robot& robot);

// Everything in `text`, whatever the form: JSON Lines, one JSON document, a JSON
// array, YAML (one or several documents), or grids of letters separated by
// empty lines.
std::vector<Robot> parse_robots(std::string_view text, const std::string& where,
                                BodyCheck check = BodyCheck::robot);

}  // namespace evo
