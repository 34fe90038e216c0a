// Without libFuzzer: every file named, or in a folder named, as it is and damaged.
//   fuzz_robots [--damaged N] FILE|FOLDER...
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "target.h"

namespace {

namespace fs = std::filesystem;

void feed(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

// One to four changes: a byte, a run of bytes away, a run again, the end away.
std::string damaged(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (std::size_t change = 1 + below(4); change > 0 && !text.empty(); --change) {
    const std::size_t at = below(text.size());
    const std::size_t run = 1 + below(std::min<std::size_t>(32, text.size() - at));
    switch (below(4)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, run);
        break;
      case 2:
        text.insert(at, text.substr(at, run));
        break;
      default:
        if (below(4) == 0) text.resize(at);
    }
  }
  return text;
}

std::vector<fs::path> files_of(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path))
    if (entry.is_regular_file()) files.push_back(entry.path());
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  unsigned long repetitions = 0;
  if (words.size() > 1 && words[0] == "--damaged") {
    repetitions = std::stoul(words[1]);
    words.erase(words.begin(), words.begin() + 2);
  }
  std::mt19937 random(1);  // the same damage every time
  unsigned long runs = 0;
  for (const std::string& word : words)
    for (const fs::path& file : files_of(word)) {
      std::ifstream in(file, std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      feed(text);
      for (unsigned long i = 0; i < repetitions; ++i) feed(damaged(text, random));
      runs += 1 + repetitions;
    }
  std::cout << runs << " inputs\n";
  return runs > 0 ? 0 : 1;
}
