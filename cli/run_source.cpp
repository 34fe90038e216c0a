#include "cli/run_source.h"

#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "cli/data.h"
#include "cli/run_makefile.h"
#include "formats/io/files.h"
#include "formats/task/task.h"
#include "libevo/base/digest.h"
#include "libevo/base/error.h"

namespace evo::cli {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(path, unknown);
}

// "a" and "c" of "import a.b as x, c", "a" of "from a.b import c".
std::vector<std::string> imported(const std::string& line) {
  static const std::regex form(R"(^\s*(import|from)\s+(.*))");
  static const std::regex name(R"((?:^|,)\s*(\w+))");
  std::smatch found;
  if (!std::regex_match(line, found, form)) return {};
  const std::string rest = found[2];
  std::vector<std::string> names;
  for (std::sregex_iterator it(rest.begin(), rest.end(), name), end; it != end; ++it) {
    names.push_back((*it)[1]);
    if (found[1] == "from") break;
  }
  return names;
}

// The file, and what it imports from its folder: a module with what that imports, a package
// with all that is in it.
void add_python(const fs::path& file, std::map<fs::path, std::string>& texts) {
  if (!is_file(file) || texts.contains(file)) return;
  const std::string text = texts[file] = read_file(file, largest_document);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    for (const std::string& name : imported(line)) {
      add_python(file.parent_path() / (name + ".py"), texts);
      const fs::path package = file.parent_path() / name;
      if (!is_file(package / "__init__.py")) continue;
      for (const auto& entry : fs::recursive_directory_iterator(package))
        if (entry.path().extension() == ".py") add_python(entry.path(), texts);
    }
}

// Hash of what the run was or will be made from: "" where no file is named, or it has gone.
std::string digest_of(const RunSettings& settings, const std::string& source) {
  std::string all;
  if (settings.is_evaluated()) {
    if (!is_file(source)) return "";
    all = read_file(source);
  } else if (is_python_task(settings.text("task"))) {
    std::map<fs::path, std::string> texts;
    add_python(source, texts);
    if (texts.empty()) return "";
    for (const auto& [path, text] : texts)
      all += path.lexically_relative(fs::path(source).parent_path()).string() + "\n" + text;
  } else {
    const bool may_be_file = source.find('/') != std::string::npos;
    if (may_be_file && !is_file(source)) return "";
    all = load_task(source, data_folders()).source;
  }
  for (const char* name : {"physics", "train", "mutate", "propose"})
    if (const std::string* value = settings.find(name); value != nullptr && is_file(*value))
      all += read_file(*value, largest_document);
  return sha256_hex(all);
}

// Where a run is begun.
std::string source_of(const RunSettings& settings) {
  if (!settings.is_evaluated()) {
    const std::string& task = settings.text("task");
    return is_python_task(task) ? task.substr(0, task.rfind(':')) : task;
  }
  std::istringstream words(settings.text("evaluate"));
  for (std::string word; words >> word;)
    if (is_file(word)) return fs::absolute(word).lexically_normal().string();
  for (const char* name : {"mutate", "propose"})
    if (const std::string* value = settings.find(name); value != nullptr && is_file(*value))
      return *value;
  return "";
}

}  // namespace

void set_source(RunSettings& settings) {
  const std::string source = source_of(settings);
  settings.set_source(source, digest_of(settings, source));
}

void check_source(const RunSettings& settings, const std::string& where) {
  if (settings.source_hash().empty()) return;
  const std::string now = digest_of(settings, settings.source());
  if (now.empty() || now == settings.source_hash()) return;
  throw error(
      Failure::cannot_create,
      "{}: {} is another one than when the run began, or a file that run.yaml names is; undo the "
      "change, or begin a run in another folder",
      where, settings.source());
}

}  // namespace evo::cli
