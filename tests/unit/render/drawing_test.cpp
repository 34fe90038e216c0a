#include "render/painters/triangles.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace evo::render {
namespace {

double area(const Drawing& drawing) {
  double sum = 0;
  const Triangles triangles = triangulate(drawing);
  const auto& v = triangles.vertices;
  for (std::size_t k = 0; k + 2 < v.size(); k += 3)
    sum += std::abs((v[k + 1].x - v[k].x) * (v[k + 2].y - v[k].y) -
                    (v[k + 1].y - v[k].y) * (v[k + 2].x - v[k].x)) /
           2;
  return sum;
}

TEST_CASE("a deformed cell is filled inside its border, convex or not") {
  const Point tip = GENERATE(Point{10, 10}, Point{3, 3}, Point{12, 9});  // {3, 3}: a dent
  const std::array<Point, 4> corners{Point{0, 0}, Point{10, 0}, tip, Point{0, 10}};
  double shoelace = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Point a = corners[k];
    const Point b = corners[(k + 1) % 4];
    shoelace += static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y;
  }
  // Whichever corner comes first.
  for (std::size_t turn = 0; turn < 4; ++turn) {
    Drawing drawing({20, 20});
    drawing.quad(
        {corners[turn], corners[(turn + 1) % 4], corners[(turn + 2) % 4], corners[(turn + 3) % 4]},
        {});
    CHECK(area(drawing) == Approx(std::abs(shoelace) / 2));
  }
}

TEST_CASE("a line's box surrounds it on all sides and a pale one stands for a thin one") {
  Drawing drawing({20, 20});
  drawing.line({2, 3}, {8, 3}, 2, {1, 2, 3, 255});
  REQUIRE(triangulate(drawing).vertices.size() == 6);
  const Triangles triangles = triangulate(drawing);
  for (const Vertex& v : triangles.vertices) {
    CHECK((v.x < 1.01F || v.x > 8.99F));
    CHECK((v.y < 2.01F || v.y > 3.99F));
    CHECK(v.radius == 1.0F);
  }
  Drawing thin({20, 20});
  thin.line({2, 3}, {8, 3}, 0.5F, {1, 2, 3, 200});
  CHECK(triangulate(thin).vertices.at(0).color.a == 100);
  CHECK(triangulate(thin).vertices.at(0).radius == 0.5F);
}

TEST_CASE("the pieces of a stroke share their corners") {
  const std::array<Point, 4> square{Point{5, 5}, Point{15, 5}, Point{15, 15}, Point{5, 15}};
  Drawing drawing({20, 20});
  drawing.stroke(square, true, 2, {});
  REQUIRE(triangulate(drawing).vertices.size() == 24);
  // Half a pixel wider than the line, for smoothing: a frame of 13 x 13 less 7 x 7.
  CHECK(area(drawing) == Approx(13 * 13 - 7 * 7));
  Drawing open({20, 20});
  open.stroke(square, false, 2, {});
  CHECK(triangulate(open).vertices.size() == 18);

  // A hairpin, a piece without length, a single point: nothing infinite.
  Drawing odd({20, 20});
  const std::array<Point, 4> hairpin{Point{1, 1}, Point{9, 1}, Point{9, 1}, Point{1, 1}};
  odd.stroke(hairpin, false, 2, {});
  odd.stroke(std::span(hairpin).first(1), false, 2, {});
  const Triangles triangles = triangulate(odd);
  for (const Vertex& v : triangles.vertices) CHECK((std::abs(v.x) < 20 && std::abs(v.y) < 20));
}

TEST_CASE("batches change with what is drawn and where") {
  Drawing drawing({20, 10});
  drawing.rectangle(drawing.whole(), {});
  drawing.rectangle({1, 1, 2, 2}, {});
  drawing.line({0, 0}, {5, 5}, 1, {});
  drawing.clip({5, 5, 5, 5});
  drawing.line({0, 0}, {5, 5}, 1, {});
  const auto batches = triangulate(drawing).batches;
  REQUIRE(batches.size() == 3);
  CHECK(batches[0].kind == Triangles::Kind::fill);
  CHECK(batches[1].first_vertex == 12);
  CHECK(batches[1].clip.width == 20);
  CHECK(batches[2].clip.x == 5);
}

}  // namespace
}  // namespace evo::render
