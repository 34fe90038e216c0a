#include "libevo/task/terrain.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/base/random.h"

using namespace evo;

namespace {

// Terrain of both kinds: a fixed staircase, a fixed roof, and a soft heap.
World make_world() {
  World world;
  world.objects.push_back({"ground", Body::from_rows({"....######", "######...."}), 0, 0});
  world.objects.push_back({"roof", Body::from_rows({"##########"}), 0, 9});
  world.objects.push_back({"heap", Body::from_rows({".S.", "SSS"}), 1, 1});
  return world;
}

// The definition, word for word (docs/tasks.md, "Floor and ceiling").
std::vector<double> by_definition(Terrain::Side side, Vec2 c, int d, double range,
                                  const std::vector<Vec2>& points) {
  std::vector<double> bins;
  for (int i = -d; i <= d; ++i) {
    std::vector<double> ys;
    for (const Vec2& p : points) {
      const double x = p.x / 0.1;
      const double y = p.y / 0.1;
      const bool near = c.x - (d + 0.5) < x && x < c.x + (d + 0.5);
      const bool inside = c.x + (i - 0.5) < x && x < c.x + (i + 0.5);
      const bool on_side = side == Terrain::Side::below ? y < c.y : y > c.y;
      if (near && inside && on_side) ys.push_back(y);
    }
    if (side == Terrain::Side::below) {
      const double e = ys.empty() ? (0 - range) + c.y : *std::max_element(ys.begin(), ys.end());
      bins.push_back(std::clamp(c.y - e, 0.0, range) * 0.1);
    } else {
      const double e = ys.empty() ? (0 + range) + c.y : *std::min_element(ys.begin(), ys.end());
      bins.push_back(std::clamp(e - c.y, 0.0, range) * 0.1);
    }
  }
  return bins;
}

struct Fixture {
  Model model{make_world(), Physics{}};
  Terrain all{model, {0, 1, 2}};
  std::vector<Vec2> positions = model.initial_positions();

  void shake(std::uint64_t index) {
    Stream stream(3, "test/terrain", index);
    for (const ModelObject& object : model.objects()) {
      if (object.is_static) continue;
      for (int i = 0; i < object.points; ++i) {
        Vec2& p = positions[static_cast<std::size_t>(object.first_point + i)];
        p.x += 0.2 * (stream.uniform() - 0.5);
        p.y += 0.2 * (stream.uniform() - 0.5);
      }
    }
  }
};

}  // namespace

TEST_CASE("clearances are what their definition says") {
  Fixture f;
  Stream stream(4, "test/terrain");
  for (std::uint64_t round = 0; round < 300; ++round) {
    if (round % 10 == 0) f.shake(round);
    Vec2 c{-2.0 + 14.0 * stream.uniform(), 11.0 * stream.uniform()};
    // Every other time on the edges, where whole columns fall out.
    if (round % 2 == 0) c.x = std::round(2.0 * c.x) / 2.0;
    if (round % 3 == 0) c.y = std::round(c.y);
    const int d = static_cast<int>(round % 6);
    const double range = round % 4 == 0 ? 2.0 : 5.0;
    for (const auto side : {Terrain::Side::below, Terrain::Side::above}) {
      std::vector<double> bins(static_cast<std::size_t>(2 * d + 1));
      f.all.clearance(side, c, range, f.positions, bins);
      CHECK(bins == by_definition(side, c, d, range, f.positions));
    }
  }
}

TEST_CASE("only the objects named count") {
  const Fixture f;
  const Terrain roof(f.model, {f.model.object_index("roof")});
  std::vector<double> bins(3);
  roof.clearance(Terrain::Side::below, {5.2, 8.0}, 5.0, f.positions, bins);
  CHECK(bins == std::vector<double>{0.5, 0.5, 0.5});
  roof.clearance(Terrain::Side::above, {5.2, 8.0}, 5.0, f.positions, bins);
  for (const double bin : bins) CHECK(bin == Approx(0.1));
}

TEST_CASE("a centre that is not a number gives no distance and does no harm") {
  const Fixture f;
  const double nan = std::nan("");
  std::vector<double> bins(11);
  f.all.clearance(Terrain::Side::below, {nan, nan}, 5.0, f.positions, bins);
  CHECK(std::isnan(bins[0]));
  f.all.clearance(Terrain::Side::below, {1e300, 2.0}, 5.0, f.positions, bins);
  CHECK(bins[5] == 0.5);
}
