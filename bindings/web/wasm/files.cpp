#include "bindings/web/wasm/files.h"

#include "formats/io/files.h"
#include "libevo/base/error.h"

namespace evo {

std::map<std::string, std::string>& given_files() {
  static std::map<std::string, std::string> files;
  return files;
}

std::string read_file(const std::filesystem::path& path, std::size_t, const Glance&) {
  const auto found = given_files().find(path.string());
  if (found == given_files().end())
    throw error(Failure::no_input, "{}: this page reads no files; put its contents here instead",
                path.string());
  return found->second;
}

std::string read_input(const std::string& name, std::size_t most, const Glance& glance) {
  return read_file(name, most, glance);
}

std::string input_label(const std::string& name) { return name; }

}  // namespace evo
