#include "formats/io/hdf5.h"

#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "formats/io/files.h"
#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;

namespace {

void write_example(const std::filesystem::path& path) {
  hdf5::Writer file(path);
  file.attribute("/", "text", "grüße");
  file.attribute("/", "long", std::string(200'000, 'x'));  // beyond a header's 64 KiB
  file.attribute("/", "empty", "");
  file.attribute("/", "seed", std::numeric_limits<std::uint64_t>::max());
  file.attribute("/", "bounds", std::vector<double>{0.6, 1.6});
  file.group("/a/b");
  file.attribute("/a/b", "rate", 0.1);
  std::vector<double> numbers(1000 * 70);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  file.array("/a/numbers", {1000, 70}, numbers);
  file.array("/a/b/c/empty", {0, 3}, std::vector<float>{});
  file.vector("/a/floats", std::vector<float>{0.1F, -0.0F, std::numeric_limits<float>::infinity()});
  file.vector("/a/bytes", std::vector<std::uint8_t>{0, 1, 255});
  file.flags("/a/flags", {1, 0, 1});
  file.strings("/names", {"robot", "", "größer"});
  file.strings("/no_names", {});
  file.commit();
}

}  // namespace

TEST_CASE("HDF5: what is written is what is read") {
  const ScratchFolder folder;
  write_example(folder / "f.h5");
  CHECK(folder.entries() == 1);
  CHECK(hdf5::is_hdf5(folder / "f.h5"));
  const hdf5::Reader file(folder / "f.h5");
  CHECK(file.text("/", "text") == "grüße");
  CHECK(file.text("/", "long") == std::string(200'000, 'x'));
  CHECK(file.text("/", "empty").empty());
  CHECK(file.number<std::uint64_t>("/", "seed") == std::numeric_limits<std::uint64_t>::max());
  CHECK(file.numbers<double>("/", "bounds") == std::vector<double>{0.6, 1.6});
  CHECK(file.number<double>("/a/b", "rate") == 0.1);
  const auto numbers = file.array<double>("/a/numbers", {hdf5::any, 70});
  CHECK(numbers.shape == hdf5::Shape{1000, 70});
  CHECK(numbers.values[69'999] == 69'999.0);
  CHECK(file.array<float>("a/b/c/empty").shape == hdf5::Shape{0, 3});
  CHECK(file.vector<float>("/a/floats", 3)[0] == 0.1F);
  CHECK(std::signbit(file.vector<float>("/a/floats")[1]));
  CHECK(file.vector<std::uint8_t>("/a/bytes") == std::vector<std::uint8_t>{0, 1, 255});
  CHECK(file.vector<std::uint8_t>("/a/flags") == std::vector<std::uint8_t>{1, 0, 1});
  CHECK(file.vector<std::int64_t>("/a/bytes") == std::vector<std::int64_t>{0, 1, 255});
  CHECK(file.strings("/names") == std::vector<std::string>{"robot", "", "größer"});
  CHECK(file.strings("/no_names").empty());
  CHECK(file.children("/a") ==
        std::vector<std::string>{"b", "bytes", "flags", "floats", "numbers"});
  CHECK(file.exists("/a/b"));
  CHECK(file.exists("/"));
  CHECK_FALSE(file.exists("/a/x/y"));
  CHECK_FALSE(file.has_attribute("/", "nothing"));
  CHECK_FALSE(file.has_attribute("/nothing", "text"));
}

TEST_CASE("HDF5: the same content is the same file, also a second later") {
  const ScratchFolder folder;
  write_example(folder / "a.h5");
  ::usleep(1'100'000);  // time stamps would count in seconds
  write_example(folder / "b.h5");
  CHECK(read_file(folder / "a.h5") == read_file(folder / "b.h5"));
}

TEST_CASE("HDF5: a file may be written twice at once, and read from memory twice") {
  const ScratchFolder scratch;
  const auto path = scratch / "twice.h5";
  hdf5::Writer one(path);
  hdf5::Writer other(path);
  one.attribute("/", "number", 1.0);
  other.attribute("/", "number", 2.0);
  one.commit();
  const std::string first = read_file(path);
  other.commit();
  CHECK(hdf5::Reader(path).number<double>("/", "number") == 2.0);
  const hdf5::Reader earlier(first, "memory");
  CHECK(hdf5::Reader(read_file(path), "memory").number<double>("/", "number") == 2.0);
  CHECK(earlier.number<double>("/", "number") == 1.0);
}

TEST_CASE("HDF5: what does not fit is refused with file and path") {
  const ScratchFolder folder;
  write_example(folder / "f.h5");
  const hdf5::Reader file(folder / "f.h5");
  const auto refused = [&](auto&& f) {
    const std::string message = error_of(Failure::data, f);
    CHECK(contains(message, (folder / "f.h5").string()));
    return message;
  };
  CHECK(contains(refused([&] {
                   (void)file.array<double>("/a/numbers", {hdf5::any, 71});
                 }),
                 "/a/numbers: has shape [1000 x 70], expected [any x 71]"));
  CHECK(contains(refused([&] { (void)file.vector<double>("/a/numbers"); }), "expected [any]"));
  CHECK(contains(refused([&] { (void)file.array<double>("/a/b"); }), "is not a dataset"));
  CHECK(contains(refused([&] { (void)file.array<double>("/nothing"); }), "/nothing: is missing"));
  CHECK(contains(refused([&] { (void)file.array<double>("/names"); }), "does not hold numbers"));
  CHECK(contains(refused([&] { (void)file.strings("/a/bytes"); }), "does not hold text"));
  CHECK(contains(refused([&] { (void)file.children("/names"); }), "is not a group"));
  CHECK(contains(refused([&] { (void)file.children("/nothing"); }), "is missing"));
  CHECK(contains(refused([&] { (void)file.text("/", "seed"); }), "/@seed: does not hold text"));
  CHECK(contains(refused([&] { (void)file.text("/", "nothing"); }), "/@nothing: is missing"));
  CHECK(contains(refused([&] { (void)file.number<double>("/", "text"); }), "numbers"));
  CHECK(contains(refused([&] { (void)file.number<double>("/", "bounds"); }), "holds 2 numbers"));
}

TEST_CASE("HDF5: other files are told apart") {
  const ScratchFolder folder;
  CHECK_FALSE(hdf5::is_hdf5(folder / "none"));
  error_of(Failure::no_input, [&] { const hdf5::Reader file(folder / "none"); });
  error_of(Failure::no_input, [&] { const hdf5::Reader file(folder.path()); });
  write_file(folder / "text", "not HDF5");
  CHECK_FALSE(hdf5::is_hdf5(folder / "text"));
  CHECK(contains(error_of(Failure::data, [&] { const hdf5::Reader file(folder / "text"); }),
                 "not an HDF5 file"));
  write_example(folder / "f.h5");
  const std::string bytes = read_file(folder / "f.h5");
  write_file(folder / "cut.h5", bytes.substr(0, bytes.size() / 2));
  CHECK(contains(error_of(Failure::data, [&] { const hdf5::Reader file(folder / "cut.h5"); }),
                 "truncated"));
  std::string damaged = bytes;
  damaged[bytes.size() / 2] ^= 1;
  CHECK(contains(error_of(Failure::data, [&] { const hdf5::Reader file(damaged, "d"); }),
                 "checksum"));
  write_file(folder / "d.h5", damaged);
  CHECK(contains(error_of(Failure::data, [&] { const hdf5::Reader file(folder / "d.h5"); }),
                 "checksum"));
  // As others write it.
  const std::string plain = bytes.substr(0, bytes.rfind("evo sha256 "));
  CHECK(hdf5::stated_size(plain, "p") == bytes.size());
  CHECK(hdf5::Reader(plain, "p").children("/") == hdf5::Reader(bytes, "f").children("/"));
}

TEST_CASE("HDF5: nothing is left of a file that is not committed") {
  const ScratchFolder folder;
  {
    hdf5::Writer file(folder / "f.h5");
    file.vector("/v", std::vector<double>{1, 2});
  }
  CHECK(folder.entries() == 0);
  error_of(Failure::cannot_create, [&] { const hdf5::Writer file(folder / "no" / "f.h5"); });
  hdf5::Writer file(folder / "g.h5");
  error_of(Failure::io, [&] { file.array("/v", {2, 2}, std::vector<double>{1, 2}); });
}

TEST_CASE("HDF5: a heap of texts that the library would read for ever is refused") {
  const ScratchFolder folder;
  write_example(folder / "f.h5");
  std::string bytes = read_file(folder / "f.h5");
  bytes.resize(bytes.rfind("evo sha256 "));  // as of a program that seals nothing
  write_file(folder / "plain.h5", bytes);
  CHECK(hdf5::Reader(folder / "plain.h5").text("/", "text") == "grüße");
  // The first object becomes free space of no size.
  const std::size_t heap = bytes.find("GCOL");
  REQUIRE(heap != std::string::npos);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(heap + 16), 16, '\0');
  write_file(folder / "f.h5", bytes);
  CHECK_THROWS_WITH(hdf5::Reader(folder / "f.h5"), Catch::EndsWith("f.h5: damaged HDF5 file"));
}
