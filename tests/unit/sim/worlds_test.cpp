// Random worlds against what the benchmark's own package computed in them, which
// benchmarks/peer/worlds.py wrote down.
#include <bit>
#include <catch2/catch.hpp>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "libevo/base/digest.h"
#include "tests/unit/sim/fixtures.h"

namespace evo {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
  return parts;
}

// "robot 15 3 .HVS/VHV. 1-2,1-5": name, place, rows from the top, and links if not all.
Object object_of(std::string text) {
  if (text.front() == ' ') text.erase(0, 1);
  const std::vector<std::string> words = split(text, ' ');
  Object object{words.at(0), Body::from_rows(split(words.at(3), '/')), std::stoi(words[1]),
                std::stoi(words[2])};
  if (words.size() < 5) return object;
  object.body.links.clear();
  for (const std::string& pair : split(words[4], ',')) {
    const std::size_t dash = pair.find('-');
    object.body.links.push_back(
        {std::stoi(pair.substr(0, dash)), std::stoi(pair.substr(dash + 1))});
  }
  return object;
}

// As `targets` of worlds.py.
class Targets {
 public:
  explicit Targets(std::uint64_t number) : state_(number) {}
  double next() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return 0.6 + static_cast<double>(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

void append(const std::vector<Vec2>& values, std::string& bytes) {
  for (const Vec2& value : values)
    for (const double x : {value.x + 0.0, value.y + 0.0}) {  // -0 is 0
      const auto bits = std::bit_cast<std::uint64_t>(x);
      for (int shift = 0; shift < 64; shift += 8)
        bytes.push_back(static_cast<char>(bits >> shift & 0xFFU));
    }
}

}  // namespace

TEST_CASE("2 000 random worlds have the bits of the benchmark's package in every step") {
  std::ifstream table("tests/data/pinned/worlds.tsv");
  std::string line;
  REQUIRE(std::getline(table, line));
  std::uint64_t number = 0;
  std::uint64_t folded = 0;
  for (; std::getline(table, line); ++number) {
    const std::vector<std::string> row = split(line, '\t');  // kind, steps, folds, hash, world
    INFO("world " << number << ", " << row.at(0));
    World world;
    for (const std::string& object : split(row.at(4), ';'))
      world.objects.push_back(object_of(object));
    const Model model(world, Physics{});
    std::vector<Vec2> positions = model.initial_positions();  // of what never moves, too
    std::vector<Vec2> velocities(positions.size());
    Batch batch(1);
    batch.place(0, model);
    Targets targets(number);
    std::string bytes;
    const auto step = [&] {
      for (double& target : batch.targets(0)) target = targets.next();
      batch.step();
      return batch.status(0);
    };
    for (int t = 0; t < std::stoi(row[1]); ++t) {
      REQUIRE(step() == LaneStatus::done);
      batch.read_moving(0, positions, velocities);
      append(positions, bytes);
      append(velocities, bytes);
    }
    if (row[2] == "1") {
      CHECK(step() == LaneStatus::self_folding);
      ++folded;
    }
    CHECK(sha256_hex(bytes).substr(0, 16) == row[3]);
  }
  CHECK(number == 2000);
  CHECK(folded > 0);
}

}  // namespace evo
