// Whole files: read at once, written so that they appear complete or not at all
// (spec: cli, "Files"). "-" names standard input and standard output.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace evo {

// The name of standard input and output on every command line.
inline constexpr std::string_view standard_stream = "-";

// Everything in a file. Throws Error(no_input) when it is missing, a folder or
// not readable, Error(io) when reading fails halfway.
std::string read_file(const std::filesystem::path& path);

// As read_file; "-" reads standard input to its end.
std::string read_input(const std::string& name);

// How messages call an input: the name itself, "standard input" for "-".
std::string input_label(const std::string& name);

// A file under a temporary name in the folder of `path`, given its own name by
// commit(). Destroyed before that, it leaves nothing behind. A symbolic link
// stays a link; a pipe or device is written directly, having no "whole".
class AtomicFile {
 public:
  // Throws Error(cannot_create).
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  // Where to write until commit(), for libraries that open files by name.
  const std::filesystem::path& temporary() const { return temporary_; }

  // Appends. Throws Error(io).
  void write(std::string_view bytes);

  // Flushes to disk and renames. Throws Error(io). The file is closed after it.
  void commit();

 private:
  void discard();

  std::filesystem::path label_;        // as the user wrote it, for messages
  std::filesystem::path destination_;  // links followed
  std::filesystem::path temporary_;
  int descriptor_ = -1;
  bool in_place_ = false;  // a pipe or a device
};

// A whole file at once: AtomicFile, write, commit.
void write_file(const std::filesystem::path& path, std::string_view bytes);

// Lines, one at a time: to standard output ("-"), each handed on as soon as it
// is written so that pipes flow, or to a file that appears with finish().
class LineWriter {
 public:
  // Throws Error(cannot_create).
  explicit LineWriter(const std::string& target);

  // `text` without its newline. Throws Error(io).
  void line(std::string_view text);

  // To be called after the last line. Throws Error(io).
  void finish();

 private:
  std::optional<AtomicFile> file_;  // nothing: standard output
  std::string buffer_;
};

}  // namespace evo
