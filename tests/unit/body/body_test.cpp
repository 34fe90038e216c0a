#include "libevo/body/body.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "libevo/base/random.h"
#include "tests/unit/expect.h"

using namespace evo;

namespace {

Body random_body(Stream& stream, int rows, int cols) {
  std::vector<Voxel> cells;
  for (int i = 0; i < rows * cols; ++i) cells.push_back(static_cast<Voxel>(stream.below(5)));
  return {rows, cols, cells};
}

// Connectivity said another way: the spread of a mark along links until nothing
// changes.
bool marks_reach_all(const Body& body) {
  std::vector<bool> marked(body.cells.size(), false);
  const auto first =
      std::find_if(body.cells.begin(), body.cells.end(), [](Voxel v) { return v != Voxel::empty; });
  if (first == body.cells.end()) return false;
  marked[static_cast<std::size_t>(first - body.cells.begin())] = true;
  for (bool changed = true; changed;) {
    changed = false;
    for (const Link& link : body.links) {
      const auto a = static_cast<std::size_t>(link.a);
      const auto b = static_cast<std::size_t>(link.b);
      if (marked[a] == marked[b]) continue;
      marked[a] = marked[b] = changed = true;
    }
  }
  return std::count(marked.begin(), marked.end(), true) == count_voxels(body);
}

}  // namespace

TEST_CASE("Letters name the voxels and back") {
  const std::string letters = ".RSHV#";
  for (std::size_t i = 0; i < letters.size(); ++i) {
    CHECK(letter(static_cast<Voxel>(i)) == letters[i]);
    CHECK(voxel_from_letter(letters[i]) == static_cast<Voxel>(i));
  }
  for (const char c : {'r', 'x', ' ', '\0', '0', '\xE4'}) CHECK_FALSE(voxel_from_letter(c));
}

TEST_CASE("A body is what is drawn") {
  const Body body = Body::from_rows({"HHH", "V.S"});
  CHECK(body.rows == 2);
  CHECK(body.cols == 3);
  CHECK(body.at(0, 2) == Voxel::horizontal);
  CHECK(body.at(1, 1) == Voxel::empty);
  CHECK(body.at(1, 2) == Voxel::soft);
  CHECK(body.links == std::vector<Link>{{0, 1}, {0, 3}, {1, 2}, {2, 5}});
  CHECK(body.to_rows() == std::vector<std::string>{"HHH", "V.S"});
  CHECK(count_voxels(body) == 5);
  CHECK(count_actuators(body) == 4);
}

TEST_CASE("Malformed drawings name the cell") {
  const auto data_error = [](const std::vector<std::string>& rows) {
    return test::error_of(Failure::data, [&] { (void)Body::from_rows(rows); });
  };
  CHECK(data_error({"HH", "VXV"}) == "row 2 has 3 cells, but row 1 has 2");
  CHECK(data_error({"HHH", "V.x"}) == "unknown letter 'x' at row 2, column 3; allowed . R S H V #");
  CHECK_FALSE(data_error({}).empty());
  CHECK_FALSE(data_error({""}).empty());
}

TEST_CASE("Full links are all adjacent pairs, in sorted order") {
  Stream stream(1, "test/full links");
  for (int i = 0; i < 500; ++i) {
    const int rows = stream.integer(1, 6);
    const int cols = stream.integer(1, 6);
    const Body body = random_body(stream, rows, cols);
    CHECK(std::is_sorted(body.links.begin(), body.links.end()));
    std::vector<Link> expected;
    for (int a = 0; a < rows * cols; ++a)
      for (int b = a + 1; b < rows * cols; ++b) {
        const int distance = std::abs(a / cols - b / cols) + std::abs(a % cols - b % cols);
        if (distance == 1 && body.cells[static_cast<std::size_t>(a)] != Voxel::empty &&
            body.cells[static_cast<std::size_t>(b)] != Voxel::empty)
          expected.push_back({a, b});
      }
    CHECK(body.links == expected);
    CHECK_FALSE(link_defect(body));
  }
}

TEST_CASE("Connected means through links, for any subset of them") {
  Stream stream(2, "test/connected");
  int connected = 0;
  for (int i = 0; i < 3000; ++i) {
    Body body = random_body(stream, stream.integer(1, 4), stream.integer(1, 4));
    std::erase_if(body.links, [&](const Link&) { return stream.below(8) == 0; });
    REQUIRE(is_connected(body) == marks_reach_all(body));
    REQUIRE(is_valid_robot(body) == !defect(body, true).has_value());
    connected += is_connected(body) ? 1 : 0;
  }
  CHECK(connected > 100);  // both outcomes are tried
  CHECK(connected < 2900);

  Body square = Body::from_rows({"HV", "VH"});
  square.links = {{0, 1}, {2, 3}};
  CHECK_FALSE(is_connected(square));
  square.links = {{0, 1}, {0, 2}, {2, 3}};
  CHECK(is_connected(square));
  CHECK_FALSE(is_connected(Body::from_rows({"H.", ".V"})));  // corners do not connect
  CHECK_FALSE(is_connected(Body::from_rows({"..", ".."})));
  CHECK(is_connected(Body::from_rows({"R"})));
}

TEST_CASE("Defects are said in words that name the cell") {
  const auto said = [](const Body& body) { return defect(body, true).value_or("nothing"); };
  CHECK(said(Body::from_rows({"HH", "V."})) == "nothing");
  CHECK(said(Body::from_rows({"...", "..."})) == "there is no voxel, all cells are empty");
  CHECK(said(Body::from_rows({"RS"})) ==
        "there is no actuator (H or V), nothing can move this robot");
  CHECK_FALSE(defect(Body::from_rows({"RS"}), false));
  CHECK(said(Body::from_rows({".H.", "..V"})) ==
        "the voxel at row 2, column 3 is not connected to the one at row 1, column 2");

  Body body = Body::from_rows({"HHH", "V.S"});
  body.links = {{0, 4}};
  CHECK(said(body) == "connection 0-4 names the empty cell at row 2, column 2");
  body.links = {{2, 3}};  // next to each other in the list, not in the matrix
  CHECK(said(body) ==
        "connection 2-3 joins cells that are not adjacent: row 1, column 3 and row 2, column 1");
  body.links = {{0, 6}};
  CHECK(said(body) == "connection 0-6 names cell 6, but cells are numbered 0 to 5");
  body.links = {{-1, 0}};
  CHECK(said(body) == "connection -1-0 names cell -1, but cells are numbered 0 to 5");
  body.links = {{1, 1}};
  CHECK(link_defect(body));

  CHECK(defect(Body{}, false));
  Body short_of_cells;
  short_of_cells.rows = short_of_cells.cols = 2;
  short_of_cells.cells = {Voxel::rigid};
  CHECK(said(short_of_cells) == "2 rows of 2 columns need 4 cells, there are 1");
  Body strange = Body::from_rows({"H"});
  strange.cells[0] = static_cast<Voxel>(9);
  CHECK(said(strange) == "unknown voxel type 9 at row 1, column 1");
}

TEST_CASE("The identity is pinned") {
  // printf 'evo1\n3x5\nHHHHH\nV.R.V\nV...V\n0-1\n0-5\n1-2\n...' | sha256sum | cut -c1-12
  CHECK(identity(Body::from_rows({"HHHHH", "V.R.V", "V...V"})) == "66ea808bff25");
  CHECK(identity(Body::from_rows({"HH", "SV"})) == "c49738f11fc5");
  CHECK(identity(Body::from_rows({"H"})) == "84f928926ab9");
}

TEST_CASE("The identity depends on everything but the order of links") {
  Body body = Body::from_rows({"HHV", "VRS"});
  const std::string id = identity(body);
  CHECK(id.size() == 12);
  CHECK(id.find_first_not_of("0123456789abcdef") == std::string::npos);

  std::reverse(body.links.begin(), body.links.end());
  std::swap(body.links[0].a, body.links[0].b);
  body.links.push_back(body.links[1]);
  CHECK(identity(body) == id);

  body.links = full_links(body.rows, body.cols, body.cells);
  body.links.pop_back();
  CHECK(identity(body) != id);

  // Same cells in another shape, an untrimmed matrix, another letter.
  CHECK(identity(Body::from_rows({"HH", "VV", "RS"})) != id);
  CHECK(identity(Body::from_rows({"HHV.", "VRS."})) != id);
  CHECK(identity(Body::from_rows({"HHV", "VSS"})) != id);
}

TEST_CASE("Stiffness counts in voxels, within its range, and where it is not 1") {
  const Body body = Body::from_rows({"HS", ".V"});
  CHECK(with_stiffness(body, {1, 1, 7, 1}) == body);  // an empty cell has none
  const Body stiff = with_stiffness(body, {2, 1, 7, 0.1});
  CHECK(stiff.stiffness == std::vector<double>{2, 1, 1, 0.1});
  CHECK(identity(stiff) != identity(body));
  CHECK(identity(stiff) != identity(with_stiffness(body, {1, 2, 1, 0.1})));
  CHECK_THROWS_WITH(with_stiffness(body, {1, 1, 1}), "3 factors of stiffness for 4 cells");
  CHECK_THROWS_WITH(with_stiffness(body, {1, 10.5, 1, 1}),
                    "stiffness 10.5 at row 1, column 2: a factor from 0.1 to 10 is expected");
  CHECK_THROWS_AS(with_stiffness(body, {1, NAN, 1, 1}), Error);
}
