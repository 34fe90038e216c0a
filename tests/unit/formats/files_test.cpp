#include "formats/io/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;
namespace fs = std::filesystem;

TEST_CASE("What is written is what is read") {
  const ScratchFolder folder;
  std::string bytes(300'000, 'x');
  bytes[7] = '\0';
  bytes += "\r\n\xFF";
  write_file(folder / "a", bytes);
  CHECK(read_file(folder / "a") == bytes);
  CHECK(read_input((folder / "a").string()) == bytes);
  write_file(folder / "a", "");
  CHECK(read_file(folder / "a").empty());
  CHECK(folder.entries() == 1);
}

TEST_CASE("Missing and unreadable inputs are named") {
  const ScratchFolder folder;
  const std::string missing = error_of(Failure::no_input, [&] { read_file(folder / "none"); });
  CHECK(contains(missing, (folder / "none").string()));
  CHECK(contains(missing, "No such file"));
  CHECK(contains(error_of(Failure::no_input, [&] { read_file(folder.path()); }), "folder"));
  CHECK(input_label("-") == "standard input");
  CHECK(input_label("a.json") == "a.json");
}

TEST_CASE("A file appears whole, or not at all") {
  const ScratchFolder folder;
  {
    AtomicFile file(folder / "new");
    file.write("half");
    CHECK_FALSE(fs::exists(folder / "new"));
    CHECK(fs::file_size(file.temporary()) == 4);
  }
  CHECK(folder.entries() == 0);

  write_file(folder / "old", "old");
  {
    AtomicFile file(folder / "old");
    file.write("new, but never finished");
  }
  CHECK(read_file(folder / "old") == "old");
  {
    AtomicFile file(folder / "old");
    file.write("n");
    file.write("ew");
    CHECK(read_file(folder / "old") == "old");
    file.commit();
  }
  CHECK(read_file(folder / "old") == "new");
  CHECK(folder.entries() == 1);
}

TEST_CASE("What a killed writer left is taken over, a file in use or of another kind is not") {
  const ScratchFolder folder;
  write_file(folder / ".f.tmp", "half of a longer text");
  {
    AtomicFile file(folder / "f");
    CHECK(file.temporary() == folder / ".f.tmp");
    const AtomicFile other(folder / "f");
    CHECK(other.temporary() == folder / ".f.1.tmp");
    file.write("whole");
    file.commit();
  }
  CHECK(read_file(folder / "f") == "whole");
  CHECK(folder.entries() == 1);

  write_file(folder / "elsewhere", "kept");
  fs::create_symlink(folder / "elsewhere", folder / ".f.tmp");
  write_file(folder / "f", "new");
  CHECK(read_file(folder / "f") == "new");
  CHECK(read_file(folder / "elsewhere") == "kept");
}

TEST_CASE("Outputs that cannot be created are refused in one line") {
  const ScratchFolder folder;
  const auto refuse = [](const fs::path& path) {
    return error_of(Failure::cannot_create, [&] { AtomicFile file(path); });
  };
  CHECK(contains(refuse(folder.path() / "no" / "such" / "folder"), "No such file"));
  CHECK(contains(refuse(folder.path()), "folder"));
  CHECK(contains(refuse(""), "cannot be created"));
  write_file(folder / "plain", "");
  CHECK(contains(refuse(folder.path() / "plain" / "x"), "Not a directory"));
  CHECK(contains(refuse(folder / std::string(300, 'x')), "too long"));
  CHECK(folder.entries() == 1);
}

TEST_CASE("A link stays a link, a device is written in place") {
  const ScratchFolder folder;
  write_file(folder / "target", "old");
  fs::create_symlink("target", folder / "link");
  write_file(folder / "link", "new");
  CHECK(fs::is_symlink(folder / "link"));
  CHECK(read_file(folder / "target") == "new");

  write_file("/dev/null", "nothing");
  CHECK(fs::is_character_file("/dev/null"));

  const fs::path pipe = folder / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  REQUIRE(reader >= 0);
  write_file(pipe, "through");
  char got[16] = {};
  CHECK(::read(reader, got, sizeof(got)) == 7);
  CHECK(std::string(got) == "through");
  ::close(reader);
  CHECK(fs::is_fifo(pipe));
}

TEST_CASE("New files have the permissions that the user's mask leaves") {
  const ScratchFolder folder;
  write_file(folder / "f", "");
  const mode_t mask = ::umask(0);
  ::umask(mask);
  CHECK(static_cast<mode_t>(fs::status(folder / "f").permissions()) == (0666 & ~mask));
}

TEST_CASE("Lines become a file with finish()") {
  const ScratchFolder folder;
  {
    LineWriter lines((folder / "f").string());
    lines.line("one");
    lines.line("");
    lines.line(std::string(200'000, 'y'));
    CHECK_FALSE(fs::exists(folder / "f"));
    lines.finish();
  }
  CHECK(read_file(folder / "f") == "one\n\n" + std::string(200'000, 'y') + "\n");
  {
    LineWriter unfinished((folder / "g").string());
    unfinished.line("one");
  }
  CHECK(folder.entries() == 1);
}

TEST_CASE("An input is not read without end, and looked at before the rest is read") {
  const ScratchFolder folder;
  write_file(folder / "long", std::string(200'000, 'x'));
  using Catch::Contains;
  expect_error(Failure::data, Contains("longer"), [&] { read_file(folder / "long", 1000); });
  expect_error(Failure::data, Contains("1 MiB"), [] { read_file("/dev/zero", 1 << 20); });
  std::size_t seen = 0;
  (void)read_file(folder / "long", largest_input,
                  [&](std::string_view text) { return seen = text.size(), largest_input; });
  CHECK(seen == 1 << 16);
  expect_error(Failure::data, Contains("1 MiB"), [] {
    read_file("/dev/zero", largest_input, [](std::string_view) { return std::size_t{1} << 20U; });
  });
}
