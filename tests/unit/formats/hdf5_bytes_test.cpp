#include "formats/io/hdf5_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <string>

#include "formats/io/files.h"
#include "formats/io/hdf5.h"
#include "scratch.h"

using namespace evo;
using namespace evo::test;

namespace {

// Texts of an attribute are kept in a heap.
std::string file_with_texts() {
  const ScratchFolder folder;
  hdf5::Writer file(folder / "f.h5");
  for (int i = 0; i < 100; ++i)
    file.attribute("/", "text_" + std::to_string(i), std::string(1000, 'x'));
  file.commit();
  return read_file(folder / "f.h5");
}

std::string number(std::uint64_t value, std::size_t width) {
  std::string bytes;
  for (std::size_t i = 0; i < width; ++i) bytes += static_cast<char>(value >> (8 * i) & 255U);
  return bytes;
}

bool sound_on_disk(const std::filesystem::path& path, const std::string& bytes,
                   std::uint64_t size) {
  write_file(path, bytes);
  const int descriptor = ::open(path.c_str(), O_RDWR);
  REQUIRE(descriptor >= 0);
  REQUIRE(::ftruncate(descriptor, static_cast<off_t>(size)) == 0);  // sparse
  const bool sound = hdf5::heaps_are_sound(descriptor, size);
  ::close(descriptor);
  return sound;
}

}  // namespace

TEST_CASE("HDF5 bytes: a file says how long it is, in every version of its superblock") {
  const std::string file = file_with_texts();
  CHECK(hdf5::stated_size(file, "f") == file.size());
  const auto stated = [](int version, std::size_t end_at, int width_at) {
    std::string bytes(64, '\0');
    bytes.replace(0, 8, "\x89HDF\r\n\x1a\n");
    bytes[8] = static_cast<char>(version);
    bytes[static_cast<std::size_t>(width_at)] = 8;
    bytes.replace(end_at, 8, number(123456, 8));
    return hdf5::stated_size(bytes, "f");
  };
  CHECK(stated(0, 40, 13) == 123456);
  CHECK(stated(1, 44, 13) == 123456);
  CHECK(stated(2, 28, 9) == 123456);
  CHECK(stated(3, 28, 9) == 123456);
  std::string version = file;
  version[8] = 9;
  std::string width = file;
  width[file[8] < 2 ? 13 : 9] = 7;
  for (const std::string& damaged : {file.substr(0, 20), version, width})
    CHECK(contains(error_of(Failure::data, [&] { (void)hdf5::stated_size(damaged, "f"); }), "f: "));
}

TEST_CASE("HDF5 bytes: heaps are looked at, wherever they lie") {
  const ScratchFolder folder;
  const std::string file = file_with_texts();
  const std::size_t heap = file.find("GCOL");
  REQUIRE(heap != std::string::npos);
  const auto agree = [&](const std::string& bytes) {
    const bool sound = hdf5::heaps_are_sound(bytes);
    CHECK(sound_on_disk(folder / "f.h5", bytes, bytes.size()) == sound);
    // At the edge between two pieces of a file that is read, and far behind it.
    for (const std::size_t before : {(std::size_t{1} << 20) - heap - 3, std::size_t{1} << 23}) {
      const std::string moved = std::string(before, 'y') + bytes;
      CHECK(sound_on_disk(folder / "moved.h5", moved, moved.size()) == sound);
    }
    return sound;
  };
  CHECK(agree(file));
  for (const std::uint64_t length : {0ULL, 15ULL, 1ULL << 40U, ~0ULL}) {
    std::string damaged = file;
    damaged.replace(heap + 8, 8, number(length, 8));  // of the heap
    CHECK_FALSE(agree(damaged));
    damaged = file;
    damaged.replace(heap + 24, 8, number(length | 1ULL << 41U, 8));  // of its first text
    CHECK_FALSE(agree(damaged));
  }
  CHECK_FALSE(agree(file.substr(0, heap + 20)));
}

TEST_CASE("HDF5 bytes: heaps within heaps are refused, a file that is mostly a hole is read") {
  const ScratchFolder folder;
  // Every heap goes to the end, and holds all that come after it.
  std::string nested;
  constexpr std::size_t size = std::size_t{8} << 20U;
  while (nested.size() < size) {
    nested += std::string("GCOL\1\0\0\0", 8) + number(size - nested.size(), 8);
    nested += number(1, 8) + number(16, 8);
  }
  CHECK_FALSE(hdf5::heaps_are_sound(nested));
  // What lies behind the end that a file states is not part of it.
  CHECK(sound_on_disk(folder / "sparse.h5", file_with_texts(), std::uint64_t{1} << 36U));
}
