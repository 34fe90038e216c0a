#include "formats/io/learners.h"

#include <fstream>

#include "libevo/base/error.h"

namespace evo {

std::optional<std::string> learner_file(std::string_view bytes) {
  const auto holds = [&](std::string_view member) { return bytes.find(member) != bytes.npos; };
  constexpr std::size_t pickle_head = 2;  // the opcode PROTO and the protocol's number
  if (bytes.starts_with("PK")) {
    if (holds("_stable_baselines3_version") || holds("policy.pth"))
      return "a model of Stable-Baselines3; evo_robots.stable_baselines3.write_sb3_policy makes a "
             "policy file of it";
    if (holds("/data.pkl"))
      return "a file of PyTorch; evo_robots.files.write_policy makes a policy file of a network's "
             "layers";
  } else if (bytes.size() >= pickle_head && bytes[0] == '\x80' && bytes[1] >= 2 && bytes[1] <= 5) {
    return "a Python pickle; evo_robots.files.write_policy makes a policy file of a network's "
           "layers";
  }
  return std::nullopt;
}

void refuse_learner_file(const std::filesystem::path& path) {
  constexpr std::streamoff most = std::streamoff{1} << 20U;  // from either end
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  std::string ends;
  const auto read = [&](std::streamoff from, std::streamoff length) {
    const std::size_t begin = ends.size();
    ends.resize(begin + static_cast<std::size_t>(length));
    file.seekg(from);
    file.read(ends.data() + begin, length);
  };
  if (size <= 2 * most) {
    read(0, std::max(size, std::streamoff{0}));
  } else {
    read(0, most);
    read(size - most, most);
  }
  if (!file) return;
  if (const auto what = learner_file(ends))
    throw error(Failure::data, "{}: {}", path.string(), *what);
}

}  // namespace evo
