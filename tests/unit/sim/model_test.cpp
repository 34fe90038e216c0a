#include "libevo/sim/model.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/sim/compiled.h"
#include "tests/unit/sim/fixtures.h"

namespace evo {
namespace {

Object object(const std::string& name, const std::vector<std::string>& rows, int x, int y) {
  return {name, Body::from_rows(rows), x, y};
}

}  // namespace

TEST_CASE("objects come in world order, points in order of creation") {
  const Model model({{object("b", {"#"}, 0, 0), object("a10", {"S"}, 1, 0),
                      object("a2", {"S"}, 2, 0), object("walker", {".H", "VV"}, 3, 0)}},
                    Physics{});
  const auto& objects = model.objects();
  REQUIRE(objects.size() == 4);
  CHECK(objects[0].name == "walker");
  CHECK(objects[1].name == "a10");
  CHECK(objects[2].name == "a2");
  CHECK(objects[3].name == "b");
  CHECK(objects[3].is_static);
  CHECK(objects[0].points == 8);
  CHECK(objects[1].first_point == 8);
  CHECK(model.actuators() == 3);
  CHECK(model.object_index("a2") == 2);
  CHECK(model.object_index("c") == -1);
  // The top cell's corners first: top left, top right, bottom left, bottom right.
  const auto& p = model.initial_positions();
  CHECK(p[0].x == 1 * 0.1 + 3 * 0.1);
  CHECK(p[0].y == (2 * 0.1 + 0 * 0.1) - 0 * 0.1);
  CHECK(p[3].y == (2 * 0.1 + 0 * 0.1) - 1 * 0.1);
}

TEST_CASE("springs of two cells: factors of stiffness, strain limits") {
  const Physics physics;
  const Model model({{object("robot", {"RH"}, 1, 1)}}, physics);
  const Dynamics& d = model.compiled().dynamics;
  // Factors of stiffness: a voxel's own, and their mean where two share an edge.
  World world{{object("robot", {"RH"}, 1, 1)}};
  world.objects[0].body = with_stiffness(world.objects[0].body, {2.0, 0.5});
  const Model scaled(world, physics);
  const std::vector<Spring>& springs = scaled.compiled().dynamics.springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    INFO("spring " << s);
    const double factor = s == 3 ? 1.25 : s < 3 || s == 7 || s == 8 ? 2.0 : 0.5;
    CHECK(springs[s].stiffness == factor * d.springs[s].stiffness);
    CHECK(springs[s].rest == d.springs[s].rest);
  }

  const StrainLimit& limit = model.compiled().plan.strain.limits[0];
  CHECK_FALSE(std::sqrt(limit.longest_square) / 0.1 > 1.25);
  CHECK(std::sqrt(std::nextafter(limit.longest_square, 1.0)) / 0.1 > 1.25);
  CHECK_FALSE(std::sqrt(limit.shortest_square) / 0.1 < 0.75);
  CHECK(std::sqrt(std::nextafter(limit.shortest_square, 0.0)) / 0.1 < 0.75);
}

TEST_CASE("cells that touch at a corner only have two points there") {
  const Model linked({{object("robot", {"HH", "HH"}, 0, 0)}}, Physics{});
  CHECK(linked.points() == 9);
  const Model corner({{object("robot", {"HH.", "H.H", "HHH"}, 0, 0)}}, Physics{});
  CHECK(corner.points() == 15 + 1);
}

TEST_CASE("fixed points that nothing feels are left out of the work") {
  const Model model({{object("bridge", {"#SS#", "#..#", "#..#", "####"}, 0, 0)}}, Physics{});
  const Plan& plan = model.compiled().plan;
  REQUIRE(plan.blocks.size() == 1);
  CHECK(plan.blocks[0].count == model.points());
  CHECK(plan.blocks[0].integrated < plan.blocks[0].count);
  CHECK(plan.live_springs > 0);
  CHECK(plan.first_frozen < plan.springs);
  CHECK(plan.springs < static_cast<int>(model.compiled().dynamics.springs.size()));
}

TEST_CASE("mirror images of springs make every point of a fully linked body regular") {
  const Model model({{object("robot", {"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"}, 0, 0)}},
                    Physics{});
  const Model::Compiled& world = model.compiled();
  const Plan& plan = world.plan;
  CHECK(plan.regular == static_cast<std::size_t>(model.points()));
  CHECK(plan.ends.size() == 2 * Plan::regular_ends * plan.regular);
  // Springs and images: as many ends are gathered as there are.
  const auto is_spring = [&](std::int32_t s) { return s < plan.live_springs; };
  CHECK(std::count_if(plan.ends.begin(), plan.ends.end(), is_spring) ==
        static_cast<std::ptrdiff_t>(2 * world.dynamics.springs.size()));
  CHECK(plan.live_springs > static_cast<int>(world.dynamics.springs.size()));
}

TEST_CASE("impossible worlds are refused") {
  const auto model = [](std::vector<Object> objects) {
    return Model({std::move(objects)}, Physics{});
  };
  CHECK_THROWS_WITH(model({object("a", {"S"}, 0, 0), object("a", {"S"}, 1, 0)}),
                    Catch::Contains("'a'"));
  CHECK_THROWS_WITH(model({object("a", {"SS"}, 0, 0), object("b", {"S"}, 1, 0)}),
                    Catch::Contains("'a'") && Catch::Contains("'b'") && Catch::Contains("(1, 0)"));
  CHECK_THROWS_WITH(model({object("a", {"S"}, -1, 0)}), Catch::Contains("(-1, 0)"));
  CHECK_THROWS_WITH(model({object("a", {"S.S"}, 0, 0)}), Catch::Contains("'a'"));
  // An object may stand in an empty cell of another one's matrix.
  CHECK_NOTHROW(model({object("a", {"#.#", "###"}, 0, 0), object("b", {"S"}, 1, 1)}));
}

}  // namespace evo
