#include "formats/robot/robot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "formats/foreign/evogym.h"
#include "formats/foreign/learners.h"
#include "formats/foreign/npz.h"
#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/hdf5.h"
#include "formats/io/number.h"
#include "formats/io/yaml_json.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

// In the order they are written; others follow in the order they were read.
constexpr std::array canonical_fields{"format", "version", "id",     "body",    "connections",
                                      "genome", "parents", "origin", "fitness", "failure",
                                      "task",   "steps",   "policy"};

bool is_canonical(const std::string& name) {
  return std::find(canonical_fields.begin(), canonical_fields.end(), name) !=
         canonical_fields.end();
}

// ---- body -------------------------------------------------------------------

bool is_robot_voxel(std::optional<Voxel> voxel) { return voxel && voxel != Voxel::fixed; }

// Why the voxel given as `found` is not one that a robot may have.
Refusal bad_voxel(std::optional<Voxel> voxel, const std::string& found, std::size_t r,
                  std::size_t c, const char* allowed) {
  const bool fixed = voxel == Voxel::fixed;
  return refusal(fmt::format("/body/{}", r), "{}{} at row {}, column {}{}; allowed {}",
                 fixed ? "" : "unknown ", found, r + 1, c + 1,
                 fixed ? " is a fixed cell, which only worlds have" : "", allowed);
}

void append_row(const std::string& row, std::size_t r, std::vector<Voxel>& cells) {
  for (std::size_t c = 0; c < row.size(); ++c) {
    const auto voxel = voxel_from_letter(row[c]);
    if (!is_robot_voxel(voxel))
      throw bad_voxel(voxel, "letter " + shown(row[c]), r, c, ". R S H V");
    cells.push_back(*voxel);
  }
}

// Numbers may be real, as NumPy writes its matrices: 3.0.
void append_row(const Json& row, std::size_t r, std::vector<Voxel>& cells) {
  for (std::size_t c = 0; c < row.size(); ++c) {
    const double number = row[c].is_number() ? row[c].get<double>() : -1.0;
    std::optional<Voxel> voxel;
    if (number >= 0.0 && number <= static_cast<double>(Voxel::fixed) &&
        number == std::floor(number))
      voxel = static_cast<Voxel>(static_cast<int>(number));
    if (!is_robot_voxel(voxel)) throw bad_voxel(voxel, "value " + shown(row[c]), r, c, "0 1 2 3 4");
    cells.push_back(*voxel);
  }
}

// A picture in one text, a line per row.
Json split_lines(const std::string& text) {
  Json rows = Json::array();
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    rows.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return rows;
}

Body body_from_json(const Json& value) {
  if (value.is_string()) return body_from_json(split_lines(value.get<std::string>()));
  if (!value.is_array() || value.empty())
    throw refusal("/body", "expected a list of rows, found {}", shown(value));
  std::vector<Voxel> cells;
  std::size_t width = 0;
  for (std::size_t r = 0; r < value.size(); ++r) {
    const Json& row = value[r];
    const std::string path = fmt::format("/body/{}", r);
    if (!row.is_string() && !row.is_array())
      throw refusal(path, "expected a row of letters or a list of numbers, found {}", shown(row));
    const std::size_t length =
        row.is_string() ? row.get_ref<const std::string&>().size() : row.size();
    if (r == 0) width = length;
    if (width == 0) throw refusal(path, "a row without cells");
    if (width > largest_side || value.size() > largest_side)
      throw refusal("/body", "{} rows of {} cells; the largest robot is {}x{}", value.size(), width,
                    largest_side, largest_side);
    if (length != width)
      throw refusal(path, "row {} has {} cells, but row 1 has {}", r + 1, length, width);
    if (row.is_string())
      append_row(row.get_ref<const std::string&>(), r, cells);
    else
      append_row(row, r, cells);
  }
  return {static_cast<int>(value.size()), static_cast<int>(width), std::move(cells)};
}

// ---- connections ------------------------------------------------------------

int cell_from_json(const Json& value, const std::string& path, const Body& body) {
  const auto last = static_cast<std::int64_t>(body.cells.size()) - 1;
  const std::int64_t cell = value.is_number_integer() ? value.get<std::int64_t>() : -1;
  if (cell < 0 || cell > last)
    throw refusal(path, "expected the number of a cell, 0 to {}, found {}", last, shown(value));
  return static_cast<int>(cell);
}

// Two lists of equal length, as the benchmark has its connections: [2, k]. Of two pairs
// ([2, 2]) nobody can tell; those are pairs, as in our documents.
bool is_two_lists(const Json& value) {
  return value.size() == 2 && value[0].is_array() && value[1].is_array() &&
         value[0].size() == value[1].size() && value[0].size() != 2;
}

Json as_pairs(const Json& value) {
  Json pairs = Json::array();
  for (std::size_t k = 0; k < value[0].size(); ++k) pairs.push_back({value[0][k], value[1][k]});
  return pairs;
}

std::vector<Link> links_from_json(const Json& value, const Body& body) {
  if (!value.is_array())
    throw refusal("/connections", "expected a list of pairs of cells, found {}", shown(value));
  if (is_two_lists(value)) return links_from_json(as_pairs(value), body);
  std::vector<Link> links;
  for (std::size_t k = 0; k < value.size(); ++k) {
    const std::string path = fmt::format("/connections/{}", k);
    if (!value[k].is_array() || value[k].size() != 2)
      throw refusal(path, "expected a pair of cells, found {}", shown(value[k]));
    const int a = cell_from_json(value[k][0], path + "/0", body);
    const int b = cell_from_json(value[k][1], path + "/1", body);
    links.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return links;
}

Json links_to_json(const std::vector<Link>& links) {
  Json pairs = Json::array();
  for (const Link& link : links) pairs.push_back({link.a, link.b});
  return pairs;
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

void check_fields(const Json& document) {
  for (const FieldType& field : field_types) {
    const auto found = document.find(field.name);
    if (found != document.end() && !found->is_null() && !field.holds(*found))
      throw refusal(fmt::format("/{}", field.name), "expected {}, found {}", field.expected,
                    shown(*found));
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
}

Robot read_document(Json document, BodyCheck check) {
  if (!document.is_object())
    throw refusal("", "expected a robot document (an object), found {}", shown(document));
  check_format(document, format::robot);
  const auto body = document.find("body");
  if (body == document.end()) throw refusal("/body", "is missing");
  Robot robot;
  robot.body = body_from_json(*body);
  const auto links = document.find("connections");
  if (links != document.end() && !links->is_null()) {
    robot.body.links = links_from_json(*links, robot.body);
    if (const auto wrong = link_defect(robot.body)) throw refusal("/connections", "{}", *wrong);
  }
  if (check == BodyCheck::robot)
    if (const auto wrong = defect(robot.body, true)) throw refusal("/body", "{}", *wrong);
  check_fields(document);
  robot.id = identity(robot.body);
  const auto id = document.find("id");
  if (id != document.end() && !id->is_null() && *id != robot.id)
    throw refusal("/id", "{} is not the id of this body, which is \"{}\"; correct or remove it",
                  shown(*id), robot.id);
  robot.document = std::move(document);
  set_identity(robot);
  return robot;
}

// The document with its fields in canonical order and complete.
Json in_canonical_order(Robot robot) {
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

// ---- the forms of text ------------------------------------------------------

constexpr std::size_t most_robots = 1'000'000;                 // of one input
constexpr std::size_t longest_yaml = std::size_t{1} << 23;     // bytes
constexpr std::size_t longest_drawing = std::size_t{1} << 26;  // bytes, of letters

Error too_many(const std::string& where) {
  return refusal("", "more than {} robots in one input", most_robots).at(where);
}

void check_count(const std::vector<Robot>& robots, const std::string& where) {
  if (robots.size() > most_robots) throw too_many(where);
}

// A matrix as the benchmark's scripts have it: [[3, 3, 3], [4, 0, 4]].
bool is_matrix(const Json& value) {
  return value.is_array() && !value.empty() && value[0].is_array() && !value[0].empty() &&
         value[0][0].is_number();
}

// The robot of a document or of a matrix, or the robots of a list.
void add_robots(Json value, BodyCheck check, std::vector<Robot>& robots) {
  if (is_matrix(value)) value = {{"body", std::move(value)}};
  if (!value.is_array()) {
    robots.push_back(read_document(std::move(value), check));
    return;
  }
  for (std::size_t i = 0; i < value.size(); ++i) {
    try {
      robots.push_back(read_document(std::move(value[i]), check));
    } catch (const Refusal& refused) {
      throw Refusal{fmt::format("/{}{}", i, refused.path), refused.message};
    }
  }
}

// A world of the benchmark's design tool.
bool is_world(const Json& value) {
  return value.is_object() && value.contains("grid_width") && value.contains("objects") &&
         !value.contains("body");
}

std::vector<Robot> parse_json_robots(std::string_view text, const std::string& where,
                                     BodyCheck check) {
  std::vector<Robot> robots;
  JsonPieces pieces(text, where);
  while (const auto piece = pieces.next()) {
    // A document that is the whole file needs no line.
    const bool alone = robots.empty() && piece->line == 1 && pieces.done();
    Json value = parse_json(*piece, where);
    if (is_world(value)) {
      robots.push_back(robot_from_evogym_world(evogym_world_from_json(value, where), where, check));
      continue;
    }
    try {
      add_robots(std::move(value), check, robots);
    } catch (const Refusal& refused) {
      throw refused.at(alone ? where : with_place(where, fmt::format("line {}", piece->line)));
    }
    check_count(robots, where);
  }
  return robots;
}

// A document is a robot or a list of them.
std::vector<Robot> parse_yaml_robots(std::string_view text, const std::string& where,
                                     BodyCheck check) {
  if (text.size() > longest_yaml)
    throw refusal("", "longer than {} MiB of YAML; JSON Lines have no such bound",
                  longest_yaml >> 20U)
        .at(where);
  std::vector<Robot> robots;
  for (YamlDocument& document : parse_yaml_documents(text, where, {"id", "parents"})) {
    try {
      add_robots(std::move(document.value), check, robots);
    } catch (const Refusal& refused) {
      throw refused.at(with_place(where, fmt::format("line {}", document.line_of(refused.path))));
    }
  }
  return robots;
}

std::string_view without_trailing_blanks(std::string_view line) {
  const std::size_t last = line.find_last_not_of(" \t\r");
  return line.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

// A row of a drawing: letters, or numbers between blanks or commas, as numpy.savetxt
// writes them.
Json grid_row(std::string_view row) {
  constexpr std::string_view between = " \t,";
  const bool has_numbers = row.find_first_of("0123456789") != std::string_view::npos &&
                           row.find_first_not_of("0123456789.+-eE \t,") == std::string_view::npos;
  if (!has_numbers) return row;
  Json numbers = Json::array();
  for (std::size_t begin = row.find_first_not_of(between); begin != std::string_view::npos;) {
    const std::size_t end = std::min(row.find_first_of(between, begin), row.size());
    const std::string_view text = row.substr(begin, end - begin);
    const auto number = number_in<double>(text);
    numbers.push_back(number ? Json(*number) : Json(text));
    begin = row.find_first_not_of(between, end);
  }
  return numbers;
}

std::vector<Robot> parse_grids(std::string_view text, const std::string& where, BodyCheck check) {
  std::vector<Robot> robots;
  Json rows = Json::array();
  std::size_t first_line = 1;
  const auto finish_grid = [&] {
    if (rows.empty()) return;
    try {
      robots.push_back(read_document({{"body", rows}}, check));
    } catch (const Refusal& refused) {
      throw Refusal{"", refused.message}.at(
          with_place(where, fmt::format("robot drawn from line {}", first_line)));
    }
    rows.clear();
    check_count(robots, where);
  };
  std::size_t line = 1;
  for (std::size_t begin = 0; begin < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view row = without_trailing_blanks(text.substr(begin, end - begin));
    begin = end + 1;
    if (row.empty()) {
      finish_grid();
      continue;
    }
    if (rows.empty()) first_line = line;
    rows.push_back(grid_row(row));
  }
  finish_grid();
  return robots;
}

// By the first line that is not blank: YAML has a colon, a dash, a directive or
// a comment there, which no row of letters has.
bool looks_like_yaml(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const std::string_view line =
      without_trailing_blanks(text.substr(begin, text.find('\n', begin) - begin));
  const bool comment = line.front() == '#' && line.find_first_not_of(".RSHV#") != line.npos;
  return comment || line.front() == '-' || line.front() == '%' || line.find(':') != line.npos;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

// Of a drawing, the rows of the first robot, the last one perhaps cut short.
void glance_at_grid(std::string_view beginning, const std::string& where) {
  Json rows = Json::array();
  while (!beginning.empty()) {
    const std::size_t end = std::min(beginning.find('\n'), beginning.size());
    const std::string_view row = without_trailing_blanks(beginning.substr(0, end));
    const bool cut = end == beginning.size();
    beginning.remove_prefix(std::min(end + 1, beginning.size()));
    if (row.empty() || (cut && !rows.empty())) break;
    rows.push_back(grid_row(row));
  }
  try {
    (void)body_from_json(rows);
  } catch (const Refusal& refused) {
    throw Refusal{"", refused.message}.at(with_place(where, "line 1"));
  }
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
  const bool is_policy =
      file.has_attribute("/", "format") && file.text("/", "format") == format::policy.name;
  check_format(file, is_policy ? format::policy : format::rollout, Head::optional);
  std::vector<Robot> robots =
      parse_robots(file.text("/", "robot"), file.name() + ": /@robot", check);
  if (is_policy && input != standard_stream)  // relative to its folder, as in documents
    for (Robot& robot : robots)
      robot.document["policy"] = std::filesystem::path(input).filename().string();
  return robots;
}

Error too_large(const std::string& where) {
  return refusal("", "a JSON value of more than {} MiB", largest_value >> 20U).at(where);
}

// Of JSON, whether the first value ends within a bound and is a robot, and whether there
// are too many. How much to read until the next look.
std::size_t glance_at_json(std::string_view beginning, const std::string& where) {
  JsonPieces pieces(beginning, where);
  const auto first = pieces.next();
  if (!first || pieces.done()) {  // not ended yet
    if (beginning.size() >= largest_value) throw too_large(where);
    return largest_value;
  }
  (void)parse_json_robots(first->text, where, BodyCheck::any);
  if (beginning.size() < largest_value) return largest_value;
  std::size_t robots = 1;
  while (const auto piece = pieces.next()) {
    if (++robots > most_robots) throw too_many(where);
    if (piece->text.size() >= largest_value) throw too_large(where);
  }
  return 2 * beginning.size();
}

std::size_t glance_at_robots(std::string_view beginning, const std::string& where) {
  if (hdf5::begins_as_hdf5(beginning)) return hdf5::stated_size(beginning, where);
  if (const auto what = learner_file(beginning)) throw error(Failure::data, "{}: {}", where, *what);
  if (begins_as_numpy(beginning)) return largest_numpy;
  beginning = without_byte_order_mark(beginning);
  const std::size_t first = beginning.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos)
    throw refusal("", "{} blanks and no robot", beginning.size()).at(where);
  if (beginning[first] == '{' || beginning[first] == '[') return glance_at_json(beginning, where);
  if (looks_like_yaml(beginning)) {
    for (const char c : beginning.substr(0, beginning.find('\n')))
      if (static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\r')
        throw refusal("", "a control character, which no robot has")
            .at(with_place(where, "line 1"));
    return longest_yaml;
  }
  glance_at_grid(beginning.substr(first), where);
  return longest_drawing;
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

void Robot::set_failure(const RobotFailure& failure) {
  document.erase("behaviour");
  document["fitness"] = nullptr;
  Json& written = document["failure"] = {{"why", failure.why}};
  if (failure.step) written["step"] = *failure.step;
  if (failure.seed) written["seed"] = *failure.seed;
}

std::optional<double> number_of(const Robot& robot, const std::string& name) {
  const Json* at = &robot.document;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('.', begin), name.size());
    const auto found = at->find(name.substr(begin, end - begin));  // none in what is no object
    if (found == at->end()) return std::nullopt;
    at = &*found;
    begin = end + 1;
  }
  return at->is_number() ? std::optional(at->get<double>()) : std::nullopt;
}

bool has_gone_on(const Robot& before, const Robot& later) {
  return later.fitness() && later.steps().value_or(0) > before.steps().value_or(0);
}

Robot make_child(Body body, const std::vector<std::string>& parents, const std::string& tool,
                 std::uint64_t seed, std::uint64_t index) {
  Robot child(std::move(body));
  if (!parents.empty()) child.document["parents"] = parents;
  child.document["origin"] = {{"tool", tool}, {"seed", seed}, {"index", index}};
  return child;
}

Robot robot_from_json(const Json& document, const std::string& where, BodyCheck check) {
  try {
    return read_document(document, check);
  } catch (const Refusal& refused) {
    throw refused.at(where);
  }
}

std::string robot_to_line(const Robot& robot) { return compact(in_canonical_order(robot)); }

std::string robot_to_json(const Robot& robot) {
  // One field per line, but the body as a picture.
  const Json document = in_canonical_order(robot);
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
  const Json document = in_canonical_order(robot);
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
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  if (text[first] == '{' || text[first] == '[') return parse_json_robots(text, where, check);
  if (looks_like_yaml(text)) return parse_yaml_robots(text, where, check);
  return parse_grids(text, where, check);
}

std::string read_robot_text(const std::string& input) {
  return read_input(input, largest_input, [&](std::string_view beginning) {
    return glance_at_robots(beginning, input_label(input));
  });
}

std::vector<Robot> robots_in(std::string_view bytes, const std::string& input, BodyCheck check) {
  const std::string where = input_label(input);
  if (const auto what = learner_file(bytes)) throw error(Failure::data, "{}: {}", where, *what);
  if (begins_as_numpy(bytes))
    return {robot_from_json(Robot(body_from_numpy(bytes, where)).document, where, check)};
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
