// The robot document (docs/formats/robot.md): JSON, JSON Lines, YAML,
// or a plain grid of letters.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/json.h"
#include "libevo/body/body.h"

namespace evo {

// Why a robot has no fitness.
struct RobotFailure {
  std::string why;
  std::optional<std::int64_t> step = {};   // environment steps of training until then
  std::optional<std::uint64_t> seed = {};  // that it can be repeated with
};

struct Robot {
  Body body;
  std::string id;  // identity(body)
  Json document;   // all fields as read, unknown ones included; body and id set

  Robot() = default;
  explicit Robot(Body body);  // a fresh document: format, version, id, body

  // Fields by name: nothing when absent or null.
  std::optional<double> fitness() const;
  std::optional<RobotFailure> failure() const;
  std::optional<std::string> task() const;
  std::optional<std::string> policy() const;  // path of a file
  std::optional<std::int64_t> steps() const;
  std::vector<std::string> parents() const;  // ids

  // How the robot was last measured, in place of the time before; how it behaved then
  // goes, too.
  void set_fitness(double fitness);
  Robot failed(const RobotFailure& failure) const;  // a copy, whose fitness is null
};

// A number of the robot's document, within objects by dots: "fitness", "final.mean".
// Nothing where there is none.
std::optional<double> number_of(const Robot& robot, const std::string& name);

// Whether `later` is a robot that was scored `before`, after more steps of its training. One
// whose training failed when it continued has its fitness from before.
bool has_gone_on(const Robot& before, const Robot& later);

enum class BodyCheck {
  any,   // rows, letters, size and links make sense
  robot  // and it is connected and has an actuator
};

// One document, or a body alone: a matrix, rows of letters. Throws Error(data) with the place
// or the cell. Fields that are known have the right type; an `id` that is not the body's own is
// an error, `connections` are kept in the document only if they differ from all adjacent pairs.
// What other programs call `structure` or `robot` is the body, too, and an object called `robot`
// the whole document.
Robot read_robot(const Node& document, BodyCheck check = BodyCheck::robot);
// The robot itself. Throws Error(data), which begins with `where`, unless the body is what
// `check` asks for.
Robot checked(Robot robot, const std::string& where, BodyCheck check = BodyCheck::robot);
// Sets the body's links to those of a document: pairs of its cells, or two lists of equal length.
// Throws Error(data).
void read_links(const Node& connections, Body& body);
// The document in its canonical field order, unknown fields last; body, links
// and id as in `robot`. Ends without newline.
Json robot_to_document(Robot robot);
std::string robot_to_line(const Robot& robot);  // JSON Lines
std::string robot_to_json(const Robot& robot);  // indented, for a file of its own
std::string robot_to_yaml(const Robot& robot);

// Everything in `text`, whatever the form: JSON Lines, one JSON document, a JSON
// array, YAML (one or several documents), grids of letters or of numbers separated by
// empty lines (rows also by slashes: 333/404), matrices as lists of lists or as NumPy prints
// them, a world of the benchmark's design tool. Nothing but blanks is no robots. Throws
// Error(data) with line and column.
std::vector<Robot> parse_robots(std::string_view text, const std::string& where,
                                BodyCheck check = BodyCheck::robot);

// The bytes of robots in an input as named on a command line: a file, or "-"; what
// cannot be robots is refused after its first 64 KiB. Throws Error(no_input, io, data).
std::string read_robot_text(const std::string& input);

// The robots in such bytes: text, NumPy's (.npz of the benchmark, .npy of a body matrix), or
// an HDF5 file (rollout, policy), which stands for the robot it holds. A policy's robot
// has that policy.
std::vector<Robot> robots_in(std::string_view bytes, const std::string& input,
                             BodyCheck check = BodyCheck::robot);

// Both at once.
std::vector<Robot> read_robots(const std::string& input, BodyCheck check = BodyCheck::robot);

// The ids of the robots in an input, or those that are listed in it, one per line.
std::set<std::string> read_ids(const std::string& input);

}  // namespace evo
