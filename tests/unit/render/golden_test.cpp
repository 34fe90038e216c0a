// Pictures compared with those in tests/data/render, and the shapes of every task's
// picture with their pinned hashes. Set UPDATE_GOLDEN=1 to write both anew, then look
// at them. A picture that differs is left in the current folder as differs-NAME.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>

#include "formats/io/files.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "libevo/base/digest.h"
#include "render/painters/vector.h"
#include "render/render.h"
#include "tests/unit/render/example.h"
#include "tests/unit/render/read_png.h"

namespace evo::render {
namespace {

namespace fs = std::filesystem;

// Other versions of Mesa and FreeType may smooth an edge a little differently;
// a shape that moved by a pixel changes far more.
constexpr double most_mean_difference = 0.5;      // of 255
constexpr int large_difference = 48;              // of a channel
constexpr double most_large_differences = 0.002;  // share of pixels

void compare(const std::string& name, const Drawing& drawing) {
  const Image picture = paint(drawing);
  const fs::path golden = "tests/data/render/" + name + ".png";
  if (std::getenv("UPDATE_GOLDEN") != nullptr) write_file(golden, encode_png(picture));
  const Image expected = read_png(golden);
  REQUIRE(picture.size == expected.size);
  double sum = 0;
  std::size_t large = 0;
  for (std::size_t k = 0; k < picture.rgba.size(); k += 4) {
    int worst = 0;
    for (std::size_t c = k; c < k + 3; ++c)
      worst = std::max(worst, std::abs(picture.rgba[c] - expected.rgba[c]));
    sum += worst;
    large += worst > large_difference ? 1 : 0;
  }
  const std::size_t count = picture.rgba.size() / 4;
  const auto pixels = static_cast<double>(count);
  const bool same = sum / pixels <= most_mean_difference &&
                    static_cast<double>(large) / pixels <= most_large_differences;
  if (!same) write_file("differs-" + name + ".png", encode_png(picture));
  INFO(name << ": mean difference " << sum / pixels << ", " << large << " pixels differ much");
  CHECK(same);
}

std::vector<Robot> robots(std::size_t n) {
  std::vector<Robot> result;
  const std::vector<std::vector<std::string>> bodies{
      example::walker, example::small_box, {"S.V", "SHV", "RRR"}};
  for (std::size_t k = 0; k < n; ++k) {
    Robot robot(Body::from_rows(bodies[k % bodies.size()]));
    if (k % 5 == 3)
      robot.document["failure"] = Json::object({{"why", "folded"}});
    else
      robot.document["fitness"] = 10.25 - 1.5 * static_cast<double>(k);
    result.push_back(std::move(robot));
  }
  return result;
}

TEST_CASE("golden: both themes, with all overlays") {
  const Rollout rollout = example::simulate("Carrier-v0", example::walker, 60);
  RenderOptions options;
  options.size = {480, 270};
  compare("frame-light", draw_moment({&rollout, 0, ""}, 60, options));
  options.theme = "dark";
  options.overlays.trail = options.overlays.velocities = true;
  compare("frame-dark", draw_moment({&rollout, 0, "seed 7"}, 40.5, options));
}

TEST_CASE("golden: strain with velocities; contacts with a curve") {
  Rollout rollout = example::simulate("Carrier-v0", example::walker, 60);
  rollout.physics_yaml = physics_profiles().to_yaml(example::task("Carrier-v0").physics);
  rollout.episodes[0].truncations.back() = 1;
  RenderOptions options;
  options.size = {480, 270};
  options.overlays.tint = Tint::strain;
  options.overlays.velocities = true;
  compare("strain", draw_moment({&rollout, 0, ""}, 60, options));
  options.overlays = {};
  options.overlays.contacts = true;
  options.overlays.plot = Plot::actuation;
  compare("contacts", draw_moment({&rollout, 0, ""}, 22, options));
  Rollout climber = example::simulate("Climber-v0", example::walker, 60);
  options.overlays.contacts = false;
  options.overlays.plot = Plot::reward_sum;
  options.theme = "dark";
  compare("heights", draw_moment({&climber, 0, ""}, 40, options));
}

TEST_CASE("golden: a thumbnail, a tall picture, and a picture without overlays") {
  const Rollout rollout = example::simulate("BridgeWalker-v0", example::small_box, 40);
  RenderOptions options;
  options.size = {160, 90};
  compare("thumbnail", draw_moment({&rollout, 0, ""}, 40, options));
  options.size = {90, 200};
  compare("tall", draw_moment({&rollout, 0, ""}, 20, options));
  options.overlays = {false, false, false, Tint::none, false, false, false, Plot::none};
  options.size = {160, 90};
  compare("bare", draw_moment({&rollout, 0, ""}, 40, options));
}

TEST_CASE("golden: sheets") {
  RenderOptions options;
  options.size = {480, 480};
  compare("robot", draw_robot(robots(1)[0], options));
  compare("robots", draw_robots(robots(7), options));
  const Rollout rollout = example::simulate("Walker-v0", example::walker, 100);
  options.size.width = 720;
  compare("moments", draw_moments({&rollout, 0, ""}, {6}, options));
}

// Shapes and text, without the rasteriser, whose pixels the pictures above compare.
TEST_CASE("pinned: every task at reset and after 100 steps") {
  const fs::path table = "tests/data/render/tasks.tsv";
  const auto tasks = task_names({"tasks"});
  CHECK(tasks.size() == 32);
  std::map<std::string, std::string> pinned;
  std::istringstream rows(read_file(table));
  for (std::string picture, hash; rows >> picture >> hash;) pinned[picture] = hash;
  std::string found;
  Typesetter typesetter;
  const auto check = [&](const std::string& picture, const Drawing& drawing) {
    const std::string shapes = encode_svg(drawing, picture, typesetter);
    const std::string hash = sha256_hex(shapes).substr(0, 12);
    found += picture + "\t" + hash + "\n";
    if (pinned[picture] != hash) write_file("differs-" + picture + ".svg", shapes);
    CHECK(pinned[picture] == hash);
  };
  for (const std::string& task : tasks) {
    RenderOptions options;
    options.size = {208, 118};
    const Rollout rollout = example::simulate(task, example::walker, 100);
    check(task + "-100", draw_moment({&rollout, 0, ""}, 100, options));
    options.camera.mode = CameraMode::world;
    check(task + "-0", draw_moment({&rollout, 0, ""}, 0, options));
  }
  if (std::getenv("UPDATE_GOLDEN") != nullptr) write_file(table, found);
}

}  // namespace
}  // namespace evo::render
