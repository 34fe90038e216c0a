#include "formats/io/npz.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "formats/io/files.h"
#include "libevo/base/random.h"
#include "libevo/body/operators.h"
#include "tests/unit/expect.h"
#include "tests/unit/formats/damage.h"

using namespace evo;
using namespace evo::test;
namespace fs = std::filesystem;

TEST_CASE("npz: what is written is what is read, links included") {
  for (std::uint64_t i = 0; i < 200; ++i) {
    Stream stream(1, "test/npz", i);
    Body body = sample_body(stream.integer(1, 6), stream.integer(1, 6), default_weights, stream);
    if (body.links.size() > 3 && stream.below(2) == 0) body.links.pop_back();
    const std::string bytes = body_to_npz(body);
    REQUIRE(body_from_numpy(bytes, "in") == body);
    REQUIRE(body_to_npz(body) == bytes);
  }
  const ScratchFolder folder;
  const Body single = Body::from_rows({"H"});
  write_file(folder / "r.npz", body_to_npz(single));
  CHECK(read_npz(folder / "r.npz") == single);
}

TEST_CASE("npz: the members are NumPy arrays as EvoGym writes them") {
  const std::string bytes = body_to_npz(Body::from_rows({"HV", ".R"}));
  // Stored without compression, so they can be seen.
  CHECK(contains(bytes, "arr_0.npy"));
  CHECK(contains(bytes, "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }"));
  CHECK(contains(bytes, "{'descr': '<i8', 'fortran_order': False, 'shape': (2, 2), }"));
  CHECK(contains(body_to_npz(Body::from_rows({"H"})),
                 "'<f8', 'fortran_order': False, 'shape': (2, 0)"));
}

TEST_CASE("npz: NumPy's own files are read") {
  const Body expected = Body::from_rows({"HH.", "V.S", "VRS"});
  const fs::path data = "tests/data/formats";
  // int64, as for robots from JSON
  CHECK(read_npz(data / "numpy_int64.npz") == expected);
  // float32 by columns, int32 links with one given in both directions, deflated
  CHECK(read_npz(data / "numpy_compressed_fortran.npz") == expected);
  // No links but None, as a body's default; arrays that are not in the order of their names.
  const fs::path field = "tests/data/field";
  for (const char* name : {"body_and_none.npz", "members_in_other_order.npz"})
    CHECK(read_npz(field / name) == Body::from_rows({"HHH", "V.V"}));
  CHECK(contains(error_of(Failure::data, [&] { (void)read_npz(field / "body_twice.npz"); }),
                 "two arrays are called arr_0.npy"));
}

TEST_CASE("npz: bad files are refused with member and reason") {
  const auto refused = [](std::string_view bytes) {
    return error_of(Failure::data, [&] { (void)body_from_numpy(bytes, "in.npz"); });
  };
  CHECK(contains(refused("text"), "in.npz: not an .npz file"));
  CHECK(contains(refused(""), "an archive without a body matrix"));
  Body body = Body::from_rows({"HVH", ".R."});
  body.cells[0] = Voxel::fixed;
  CHECK(contains(refused(body_to_npz(body)),
                 "arr_0.npy: unknown kind 5 at row 1, column 1; allowed 0 1 2 3 4"));
  body = Body::from_rows({"HVH", ".R."});
  body.links = {{0, 3}};
  CHECK(contains(refused(body_to_npz(body)), "arr_1.npy: connection 0-3 names the empty cell"));
  body.links = {{0, 6}};
  CHECK(contains(refused(body_to_npz(body)), "arr_1.npy: 6 is not the number of a cell, 0 to 5"));
  body.links = {{0, 2}};
  CHECK(contains(refused(body_to_npz(body)), "not adjacent"));
  Body wide;
  wide.rows = 1;
  wide.cols = largest_side + 1;
  wide.cells.assign(static_cast<std::size_t>(wide.cols), Voxel::rigid);
  CHECK(contains(refused(body_to_npz(wide)), "a body of 1x1001 cells"));
  error_of(Failure::no_input, [] { (void)read_npz("/nowhere/r.npz"); });
}

TEST_CASE("npz: a damaged file throws Error and nothing else") {
  const std::string original = body_to_npz(Body::from_rows({"RHHHR", "VSSSV", "VHRHV"}));
  const std::string compressed = read_file("tests/data/formats/numpy_compressed_fortran.npz");
  const int refused =
      refusals({original, compressed}, 6000, any_byte, [](const std::string& bytes) {
        const Body body = body_from_numpy(bytes, "in");
        CHECK_FALSE(link_defect(body));
      });
  CHECK(refused > 3000);
}
