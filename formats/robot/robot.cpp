#include "formats/robot/robot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/hdf5.h"
#include "formats/io/learners.h"
#include "formats/io/node_builder.h"
#include "formats/io/npz.h"
#include "formats/io/number.h"
#include "formats/io/text.h"
#include "formats/robot/evogym.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

// In the order they are written; others follow in the order they were read.
constexpr std::array canonical_fields{"format",    "version", "id",      "body",   "connections",
                                      "stiffness", "genome",  "parents", "origin", "fitness",
                                      "failure",   "task",    "steps",   "policy"};

bool is_canonical(const std::string& name) {
  return std::find(canonical_fields.begin(), canonical_fields.end(), name) !=
         canonical_fields.end();
}

// ---- body -------------------------------------------------------------------

bool is_robot_voxel(std::optional<Voxel> voxel) { return voxel && voxel != Voxel::fixed; }

// Why the voxel given as `found` is not one that a robot may have.
Error bad_voxel(const Node& node, std::optional<Voxel> voxel, const std::string& found,
                std::size_t r, std::size_t c, const char* allowed) {
  const bool fixed = voxel == Voxel::fixed;
  return node.error(fmt::format("{}{} at row {}, column {}{}; allowed {}", fixed ? "" : "unknown ",
                                found, r + 1, c + 1,
                                fixed ? " is a fixed cell, which only worlds have" : "", allowed));
}

// A row as letters, or as digits without anything between them.
void append_row(const Node& node, const std::string& row, std::size_t r,
                std::vector<Voxel>& cells) {
  const bool digits = row.find_first_not_of("01234") == std::string::npos;
  for (std::size_t c = 0; c < row.size(); ++c) {
    const auto voxel =
        digits ? std::optional(static_cast<Voxel>(row[c] - '0')) : voxel_from_letter(row[c]);
    if (!is_robot_voxel(voxel))
      throw bad_voxel(node, voxel, "letter " + shown(row[c]), r, c, ". R S H V");
    cells.push_back(*voxel);
  }
}

// Numbers may be real, as NumPy writes its matrices: 3.0.
void append_row(const std::vector<Node>& row, std::size_t r, std::vector<Voxel>& cells) {
  for (std::size_t c = 0; c < row.size(); ++c) {
    const double number = row[c].is_plain() ? finite_number(row[c].text()).value_or(-1.0) : -1.0;
    std::optional<Voxel> voxel;
    if (number >= 0.0 && number <= static_cast<double>(Voxel::fixed) &&
        number == std::floor(number))
      voxel = static_cast<Voxel>(static_cast<int>(number));
    if (!is_robot_voxel(voxel))
      throw bad_voxel(row[c], voxel, "value " + row[c].found(), r, c, "0 1 2 3 4");
    cells.push_back(*voxel);
  }
}

// The rows of a picture in one text, between line breaks or slashes.
std::vector<std::string> split_rows(std::string_view text) {
  auto rows = split(text, "\n/");
  if (rows.back().empty()) rows.pop_back();
  return {rows.begin(), rows.end()};
}

Body read_body(const Node& value) {
  // A row is a text, or a list of numbers.
  std::vector<std::string> texts;
  std::vector<Node> items;
  if (value.is_scalar() && value.is_text())
    texts = split_rows(value.text());
  else if (value.is_sequence())
    items = value.items();
  const std::size_t rows = std::max(texts.size(), items.size());
  if (rows == 0) throw value.error("a list of rows is expected, found " + value.found());
  std::vector<Voxel> cells;
  std::size_t width = 0;
  for (std::size_t r = 0; r < rows; ++r) {
    const Node& row = texts.empty() ? items[r] : value;
    if (!row.is_text() && !row.is_sequence())
      throw row.error("a row of letters or a list of numbers is expected, found " + row.found());
    const std::string& text = texts.empty() ? row.text() : texts[r];
    const std::size_t length = row.is_sequence() ? row.size() : text.size();
    if (r == 0) width = length;
    if (width == 0) throw row.error("a row without cells");
    if (width > largest_side || rows > largest_side)
      throw value.error(fmt::format("{} rows of {} cells; the largest robot is {}x{}", rows, width,
                                    largest_side, largest_side));
    if (length != width)
      throw row.error(fmt::format("row {} has {} cells, but row 1 has {}", r + 1, length, width));
    if (row.is_sequence())
      append_row(row.items(), r, cells);
    else
      append_row(row, text, r, cells);
  }
  return {static_cast<int>(rows), static_cast<int>(width), std::move(cells)};
}

// ---- connections ------------------------------------------------------------

}  // namespace

// Two lists as the benchmark has its connections: [2, k]. Two pairs ([2, 2]) could be either;
// they are pairs, as in our documents.
void read_links(const Node& value, Body& body) {
  const int last = static_cast<int>(body.cells.size()) - 1;
  std::vector<Link> links;
  const auto add = [&](const Node& a, const Node& b) {
    const auto [low, high] = std::minmax({a.integer(0, last), b.integer(0, last)});
    links.push_back({low, high});
  };
  const std::vector<Node> items = value.items();
  if (items.size() == 2 && items[0].is_sequence() && items[1].is_sequence() &&
      items[0].size() == items[1].size() && items[0].size() != 2) {
    const std::vector<Node> from = items[0].items();
    const std::vector<Node> to = items[1].items();
    for (std::size_t k = 0; k < from.size(); ++k) add(from[k], to[k]);
  } else {
    for (const Node& item : items) {
      const std::vector<Node> pair = item.items();
      if (pair.size() != 2) throw item.error("a pair of cells is expected");
      add(pair[0], pair[1]);
    }
  }
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  body.links = std::move(links);
  if (const auto wrong = link_defect(body)) throw value.error(*wrong);
}

namespace {

Json links_to_json(const std::vector<Link>& links) {
  Json pairs = Json::array();
  for (const Link& link : links) pairs.push_back({link.a, link.b});
  return pairs;
}

// ---- stiffness ----------------------------------------------------------------

// Rows of factors, of the body's shape.
std::vector<double> read_stiffness(const Node& value, const Body& body) {
  std::vector<double> factors;
  const std::vector<Node> rows = value.items();
  if (rows.size() != static_cast<std::size_t>(body.rows))
    throw value.error(
        fmt::format("{} rows are expected, as the body has, found {}", body.rows, rows.size()));
  for (const Node& row : rows) {
    const std::vector<Node> numbers = row.items();
    if (numbers.size() != static_cast<std::size_t>(body.cols))
      throw row.error(fmt::format("{} factors are expected, as the body has columns, found {}",
                                  body.cols, numbers.size()));
    for (const Node& number : numbers) factors.push_back(number.number());
  }
  return factors;
}

Json stiffness_to_json(const Body& body) {
  Json rows = Json::array();
  for (int row = 0; row < body.rows; ++row) {
    Json& factors = rows.emplace_back(Json::array());
    for (int col = 0; col < body.cols; ++col)
      factors.push_back(body.stiffness_of(static_cast<std::size_t>(body.index(row, col))));
  }
  return rows;
}

// ---- the other fields ---------------------------------------------------------

using TypeTest = bool (*)(const Json&);

bool is_list_of_text(const Json& value) {
  return value.is_array() &&
         std::all_of(value.begin(), value.end(), [](const Json& item) { return item.is_string(); });
}

// {why: text, step: number, seed: number}, and what others may have added.
bool is_failure(const Json& value) {
  if (!value.is_object()) return false;
  const auto is = [&](const char* name, auto holds) {
    const auto found = value.find(name);
    return found == value.end() || found->is_null() || holds(*found);
  };
  return is("why", [](const Json& v) { return v.is_string(); }) &&
         is("step", [](const Json& v) { return v.is_number_integer(); }) &&
         is("seed", [](const Json& v) { return v.is_number_unsigned(); });
}

struct FieldType {
  const char* name;
  TypeTest holds;
  const char* expected;
};

// Null always means absent.
constexpr std::array<FieldType, 8> field_types{{
    {"genome", [](const Json& v) { return v.is_object(); }, "an object"},
    {"parents", is_list_of_text, "a list of robot ids"},
    {"origin", [](const Json& v) { return v.is_object(); }, "an object"},
    {"fitness", [](const Json& v) { return v.is_number(); }, "a number or null"},
    {"failure", is_failure, "an object that says why"},
    {"task", [](const Json& v) { return v.is_string(); }, "the name of a task"},
    {"steps", [](const Json& v) { return v.is_number_integer() && v >= 0; }, "a number of steps"},
    {"policy", [](const Json& v) { return v.is_string(); }, "the path of a policy file"},
}};

void check_fields(const Json& document, const Node& node) {
  for (const FieldType& field : field_types) {
    const auto found = document.find(field.name);
    if (found == document.end() || found->is_null() || field.holds(*found)) continue;
    const Node value = node.at(field.name);
    throw value.error(fmt::format("{} is expected, found {}", field.expected, value.found()));
  }
}

// body, id and connections of the document as the robot has them.
void set_identity(Robot& robot) {
  robot.document["id"] = robot.id;
  robot.document["body"] = robot.body.to_rows();
  if (robot.body.links == full_links(robot.body.rows, robot.body.cols, robot.body.cells))
    robot.document.erase("connections");
  else
    robot.document["connections"] = links_to_json(robot.body.links);
  if (robot.body.stiffness.empty())
    robot.document.erase("stiffness");
  else
    robot.document["stiffness"] = stiffness_to_json(robot.body);
}

// ---- the forms of text ------------------------------------------------------

constexpr std::size_t most_robots = 1'000'000;                 // of one input
constexpr std::size_t longest_yaml = std::size_t{1} << 23;     // bytes
constexpr std::size_t longest_drawing = std::size_t{1} << 26;  // bytes, of letters

void check_count(std::size_t robots, const std::string& where) {
  if (robots > most_robots)
    throw error(Failure::data, "{}: more than {} robots in one input", where, most_robots);
}

// A matrix as the benchmark's scripts have it: [[3, 3, 3], [4, 0, 4]].
bool is_matrix(const Node& value) {
  if (!value.is_sequence() || value.size() == 0) return false;
  const Node row = value.items().front();
  if (!row.is_sequence() || row.size() == 0) return false;
  const Node first = row.items().front();
  return first.is_plain() && finite_number(first.text());
}

// A world of the benchmark's design tool.
bool is_world(const Node& value) {
  return value.find("grid_width") && value.find("objects") && !value.find("body");
}

// The robot of a document, a matrix or a world, or the robots of a list.
void add_robots(const Node& value, const std::string& where, BodyCheck check,
                std::vector<Robot>& robots) {
  if (is_world(value))
    robots.push_back(robot_from_evogym_world(read_evogym_world(value), where, check));
  else if (value.is_sequence() && !is_matrix(value))
    for (const Node& item : value.items()) robots.push_back(read_robot(item, check));
  else
    robots.push_back(read_robot(value, check));
  check_count(robots.size(), where);
}

std::vector<Robot> parse_json_robots(std::string_view text, const std::string& where,
                                     BodyCheck check) {
  std::vector<Robot> robots;
  JsonPieces pieces(text, where);
  while (const auto piece = pieces.next()) add_robots(piece->parse(where), where, check, robots);
  return robots;
}

// A document is a robot or a list of them.
std::vector<Robot> parse_yaml_robots(std::string_view text, const std::string& where,
                                     BodyCheck check) {
  if (text.size() > longest_yaml)
    throw error(Failure::data, "{}: longer than {} MiB of YAML; JSON Lines have no such bound",
                where, longest_yaml >> 20U);
  std::vector<Robot> robots;
  for (const Node& document : Node::yaml_documents(text, where))
    if (!document.is_null()) add_robots(document, where, check, robots);
  return robots;
}

std::string_view without_trailing_blanks(std::string_view line) {
  const std::size_t last = line.find_last_not_of(" \t\r");
  return line.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

// ---- drawings -----------------------------------------------------------------

// A row of letters or digits; or numbers between blanks or commas, as numpy.savetxt writes
// them, and in brackets, as numpy prints them.
void add_row(std::string_view row, NodeBuilder::Place place, NodeBuilder& builder) {
  constexpr std::string_view between = " \t,[]";
  constexpr std::string_view numbers = "0123456789.+-eE \t,[]";
  if (row.find_first_of(". \t,[]") == std::string_view::npos ||
      row.find_first_not_of(numbers) != std::string_view::npos ||
      row.find_first_of("0123456789") == std::string_view::npos) {
    builder.scalar(place, std::string(row), false);
    return;
  }
  builder.open(Node::Kind::sequence, place);
  for (std::size_t begin = row.find_first_not_of(between); begin != std::string_view::npos;) {
    const std::size_t end = std::min(row.find_first_of(between, begin), row.size());
    builder.scalar({place.line, place.column + static_cast<int>(begin)},
                   std::string(row.substr(begin, end - begin)), true);
    begin = row.find_first_not_of(between, end);
  }
  builder.close();
}

// The rows of the first robot in `text`, which is then the rest, and `line` its number;
// nothing at the end. Robots stand between empty lines.
std::optional<Node> next_drawing(std::string_view& text, int& line, const std::string& where) {
  NodeBuilder builder(where, false);
  bool begun = false;
  bool ended = false;
  for (; !text.empty() && !ended; ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view all = without_trailing_blanks(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    ended = all.ends_with("]]") || (begun && all.empty());
    for (std::size_t at = 0; at < all.size();) {
      const std::size_t slash = std::min(all.find('/', at), all.size());
      if (!begun) builder.open(Node::Kind::sequence, {line, 1});
      begun = true;
      add_row(all.substr(at, slash - at), {line, static_cast<int>(at) + 1}, builder);
      at = slash + 1;
    }
  }
  if (!begun) return std::nullopt;
  builder.close();
  return builder.take();
}

std::vector<Robot> parse_drawings(std::string_view text, const std::string& where,
                                  BodyCheck check) {
  std::vector<Robot> robots;
  for (int line = 1;;) {
    const auto rows = next_drawing(text, line, where);
    if (!rows) return robots;
    robots.push_back(read_robot(*rows, check));
    check_count(robots.size(), where);
  }
}

// A matrix as numpy prints it: no comma, no quotes.
bool looks_printed(std::string_view text) {
  return text.starts_with("[[") && text.find_first_of("0123456789") != text.npos &&
         text.find_first_not_of("0123456789.[] \t\r\n") == text.npos;
}

// ---- the forms of text ----------------------------------------------------------

enum class Form { json, yaml, drawing };

// By what the text begins with, which is no blank: YAML has a colon, a dash, a directive or a
// comment in its first line, which no row of letters has.
Form form_of(std::string_view text) {
  if (looks_printed(text)) return Form::drawing;
  if (text.front() == '{' || text.front() == '[') return Form::json;
  const std::string_view line = without_trailing_blanks(text.substr(0, text.find('\n')));
  const bool comment = line.front() == '#' && line.find_first_not_of(".RSHV#") != line.npos;
  const bool yaml =
      comment || line.front() == '-' || line.front() == '%' || line.find(':') != line.npos;
  return yaml ? Form::yaml : Form::drawing;
}

std::string_view without_blanks_before(std::string_view text) {
  text = without_byte_order_mark(text);
  return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

bool is_id(std::string_view word) {
  constexpr std::size_t digits = 12;  // of identity()
  return word.size() == digits &&
         word.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::vector<Robot> robots_of(const hdf5::Reader& file, const std::string& input, BodyCheck check) {
  if (!file.has_attribute("/", "robot"))
    throw error(Failure::data, "{}: an HDF5 file without a robot: neither a policy nor a rollout",
                file.name());
  const bool is_policy = file.format() == format::policy.name;
  check_format(file, is_policy ? format::policy : format::rollout, Head::optional);
  std::vector<Robot> robots =
      parse_robots(file.text("/", "robot"), file.name() + ": /@robot", check);
  if (is_policy && input != standard_stream)  // relative to its folder, as in documents
    for (Robot& robot : robots)
      robot.document["policy"] = std::filesystem::path(input).filename().string();
  return robots;
}

void check_size(std::size_t bytes, const std::string& where) {
  if (bytes >= largest_value)
    throw error(Failure::data, "{}: a JSON value of more than {} MiB", where, largest_value >> 20U);
}

// Of JSON, whether the first value ends within a bound and is a robot, and whether there
// are too many. How much to read until the next look.
std::size_t glance_at_json(std::string_view beginning, const std::string& where) {
  JsonPieces pieces(beginning, where);
  const auto first = pieces.next();
  if (!first || pieces.done()) {  // not ended yet
    check_size(beginning.size(), where);
    return largest_value;
  }
  (void)parse_json_robots(first->text, where, BodyCheck::any);
  if (beginning.size() < largest_value) return largest_value;
  std::size_t robots = 1;
  while (const auto piece = pieces.next()) {
    check_count(++robots, where);
    check_size(piece->text.size(), where);
  }
  return 2 * beginning.size();
}

// The rows of a drawing's first robot, the last one perhaps cut short.
std::size_t glance_at_drawing(std::string_view beginning, const std::string& where) {
  if (const auto end = beginning.rfind('\n'); end != std::string_view::npos)
    beginning = beginning.substr(0, end);
  int line = 1;
  if (const auto rows = next_drawing(beginning, line, where)) (void)read_body(*rows);
  return longest_drawing;
}

std::size_t glance_at_robots(std::string_view beginning, const std::string& where) {
  if (hdf5::begins_as_hdf5(beginning)) return hdf5::stated_size(beginning, where);
  if (const auto what = learner_file(beginning)) throw error(Failure::data, "{}: {}", where, *what);
  if (begins_as_numpy(beginning)) return largest_numpy;
  const std::size_t size = beginning.size();
  beginning = without_blanks_before(beginning);
  if (beginning.empty()) throw error(Failure::data, "{}: {} blanks and no robot", where, size);
  switch (form_of(beginning)) {
    case Form::json:
      return glance_at_json(beginning, where);
    case Form::drawing:
      return glance_at_drawing(beginning, where);
    case Form::yaml:
      break;
  }
  for (const char c : beginning.substr(0, beginning.find('\n')))
    if (static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\r')
      throw error(Failure::data, "{}:1: a control character, which no robot has", where);
  return longest_yaml;
}

}  // namespace

// ---- public -------------------------------------------------------------------

Robot::Robot(Body body_) : body(std::move(body_)), id(identity(body)) {
  document["format"] = format::robot.name;
  document["version"] = format::robot.version;
  set_identity(*this);
}

// The types of these fields are checked when a document is read, and only here.
template <typename T>
std::optional<T> field(const Json& document, const char* name) {
  const auto found = document.find(name);
  if (found == document.end() || found->is_null()) return std::nullopt;
  return found->get<T>();
}

std::optional<double> Robot::fitness() const { return field<double>(document, "fitness"); }
std::optional<std::string> Robot::task() const { return field<std::string>(document, "task"); }
std::optional<std::string> Robot::policy() const { return field<std::string>(document, "policy"); }
std::optional<std::int64_t> Robot::steps() const { return field<std::int64_t>(document, "steps"); }

std::vector<std::string> Robot::parents() const {
  return field<std::vector<std::string>>(document, "parents").value_or(std::vector<std::string>{});
}

std::optional<RobotFailure> Robot::failure() const {
  const auto found = field<Json>(document, "failure");
  if (!found) return std::nullopt;
  return RobotFailure{field<std::string>(*found, "why").value_or("no reason given"),
                      field<std::int64_t>(*found, "step"), field<std::uint64_t>(*found, "seed")};
}

void Robot::set_fitness(double fitness) {
  document.erase("failure");
  document.erase("behaviour");
  document["fitness"] = fitness;
}

Robot Robot::failed(const RobotFailure& failure) const {
  Robot result = *this;
  result.document.erase("behaviour");
  result.document["fitness"] = nullptr;
  Json& written = result.document["failure"] = {{"why", failure.why}};
  if (failure.step) written["step"] = *failure.step;
  if (failure.seed) written["seed"] = *failure.seed;
  return result;
}

std::optional<double> number_of(const Robot& robot, const std::string& name) {
  const Json* at = &robot.document;
  for (const std::string_view part : split(name, ".")) {
    const auto found = at->find(std::string(part));  // none unless it is an object
    if (found == at->end()) return std::nullopt;
    at = &*found;
  }
  return at->is_number() ? std::optional(at->get<double>()) : std::nullopt;
}

bool has_gone_on(const Robot& before, const Robot& later) {
  return later.fitness() && later.steps().value_or(0) > before.steps().value_or(0);
}

Robot checked(Robot robot, const std::string& where, BodyCheck check) {
  if (check == BodyCheck::robot)
    if (const auto wrong = defect(robot.body, true))
      throw error(Failure::data, "{}: {}", where, *wrong);
  return robot;
}

Robot read_robot(const Node& node, BodyCheck check) {
  const auto inner = node.find("robot");
  if (inner && inner->is_mapping() && !node.find("body")) return read_robot(*inner, check);
  check_format(node, format::robot);
  Json document = Json::object();
  std::optional<Node> body;
  if (node.is_sequence()) {
    body = node;
  } else {
    std::string key = "body";
    for (const char* other : {"structure", "robot"})
      if (!node.find(key) && node.find(other)) key = other;
    body = node.at(key);
    document = to_json(node, {"id", "parents"});
    if (key != "body") document.erase(key);
  }
  Robot robot;
  robot.body = read_body(*body);
  const auto links = node.find("connections");
  if (links && !links->is_null()) read_links(*links, robot.body);
  if (const auto stiffness = node.find("stiffness"); stiffness && !stiffness->is_null()) {
    std::vector<double> factors = read_stiffness(*stiffness, robot.body);
    try {
      robot.body = with_stiffness(std::move(robot.body), std::move(factors));
    } catch (const Error& failure) {
      throw stiffness->error(failure.what());
    }
  }
  if (check == BodyCheck::robot)
    if (const auto wrong = defect(robot.body, true)) throw body->error(*wrong);
  if (node.is_mapping()) check_fields(document, node);
  robot.id = identity(robot.body);
  if (const auto id = node.find("id"); id && !id->is_null() && document["id"] != robot.id)
    throw id->error(
        fmt::format("{} is not the id of this body, which is '{}'; correct or remove it",
                    id->found(), robot.id));
  robot.document = std::move(document);
  set_identity(robot);
  return robot;
}

Json robot_to_document(Robot robot) {
  set_identity(robot);
  robot.document["format"] = format::robot.name;
  robot.document["version"] = format::robot.version;
  Json ordered = Json::object();
  for (const char* name : canonical_fields)
    if (const auto found = robot.document.find(name); found != robot.document.end())
      ordered[name] = std::move(*found);
  for (auto& [name, value] : robot.document.items())
    if (!is_canonical(name)) ordered[name] = std::move(value);
  return ordered;
}

std::string robot_to_line(const Robot& robot) { return compact(robot_to_document(robot)); }

std::string robot_to_json(const Robot& robot) {
  // One field per line, but the body as a picture.
  const Json document = robot_to_document(robot);
  std::string text = "{";
  for (const auto& [name, value] : document.items()) {
    text += fmt::format("{}\n  {}: ", text.size() > 1 ? "," : "", compact(name));
    if (name != "body") {
      text += compact(value);
      continue;
    }
    for (std::size_t r = 0; r < value.size(); ++r)
      text += fmt::format("{}\n    {}", r == 0 ? "[" : ",", compact(value[r]));
    text += "\n  ]";
  }
  return text + "\n}";
}

std::string robot_to_yaml(const Robot& robot) {
  // JSON values are YAML values; only the outer level is written the YAML way.
  const Json document = robot_to_document(robot);
  std::string text;
  for (const auto& [name, value] : document.items()) {
    if (!text.empty()) text += '\n';
    text += fmt::format("{}:", is_canonical(name) ? name : compact(name));
    if (name == "body")
      for (const Json& row : value) text += fmt::format("\n  - {}", compact(row));
    else
      text += fmt::format(" {}", compact(value));
  }
  return text;
}

std::vector<Robot> parse_robots(std::string_view text, const std::string& where, BodyCheck check) {
  text = without_byte_order_mark(text);
  const std::string_view begun = without_blanks_before(text);
  if (begun.empty()) return {};
  switch (form_of(begun)) {
    case Form::json:
      return parse_json_robots(text, where, check);
    case Form::yaml:
      return parse_yaml_robots(text, where, check);
    case Form::drawing:
      break;
  }
  return parse_drawings(text, where, check);
}

std::string read_robot_text(const std::string& input) {
  return read_input(input, largest_input, [&](std::string_view beginning) {
    return glance_at_robots(beginning, input_label(input));
  });
}

std::vector<Robot> robots_in(std::string_view bytes, const std::string& input, BodyCheck check) {
  const std::string where = input_label(input);
  if (const auto what = learner_file(bytes)) throw error(Failure::data, "{}: {}", where, *what);
  if (begins_as_numpy(bytes)) return {checked(Robot(body_from_numpy(bytes, where)), where, check)};
  if (!hdf5::begins_as_hdf5(bytes)) return parse_robots(bytes, where, check);
  return robots_of(hdf5::Reader(bytes, where), input, check);
}

std::set<std::string> read_ids(const std::string& input) {
  const auto is_list = [](std::string_view text) { return is_id(text.substr(0, text.find('\n'))); };
  const std::string text = read_input(input, largest_input, [&](std::string_view beginning) {
    return is_list(beginning) ? largest_value : glance_at_robots(beginning, input_label(input));
  });
  std::set<std::string> ids;
  if (!is_list(text)) {
    for (const Robot& robot : robots_in(text, input)) ids.insert(robot.id);
    return ids;
  }
  int line = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view id = rest.substr(0, rest.find('\n'));
    ++line;
    if (!is_id(id))
      throw error(Failure::data, "{}: line {}: not an id of 12 digits, as in the lines before",
                  input_label(input), line);
    ids.emplace(id);
    rest.remove_prefix(std::min(id.size() + 1, rest.size()));
  }
  return ids;
}

std::vector<Robot> read_robots(const std::string& input, BodyCheck check) {
  if (input != standard_stream && hdf5::is_hdf5(input))
    return robots_of(hdf5::Reader(input), input, check);
  return robots_in(read_robot_text(input), input, check);
}

}  // namespace evo
