// Whole files: read at once, written so that they appear complete or not at all
// (docs/tools.md, "Files"). "-" names standard input and standard output.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace evo {

// The name of standard input and output on every command line.
inline constexpr std::string_view standard_stream = "-";

// Inputs are read whole, but not without end: a pipe or a device may have none. Bytes.
inline constexpr std::size_t largest_input = std::size_t{1} << 30;     // of any kind
inline constexpr std::size_t largest_value = std::size_t{1} << 26;     // one JSON value
inline constexpr std::size_t largest_document = std::size_t{1} << 24;  // written by hand

// Looks at the beginning of a long input, 64 KiB of it, before the rest is read, and
// says how much to read. An input that is longer still is shown again, unless it has
// `most` bytes already; it ends where the answer is the same. Throws to refuse it.
using Glance = std::function<std::size_t(std::string_view beginning)>;

// Everything in a file. Throws Error(no_input) when it is missing, a folder or
// not readable, Error(io) when reading fails halfway, Error(data) when it is
// longer than `most` bytes.
std::string read_file(const std::filesystem::path& path, std::size_t most = largest_input,
                      const Glance& glance = {});

// As read_file; "-" reads standard input to its end.
std::string read_input(const std::string& name, std::size_t most = largest_input,
                       const Glance& glance = {});

// strerror, without its static buffer.
std::string reason(int code);

// How messages call an input: the name itself, "standard input" for "-".
std::string input_label(const std::string& name);

// What becomes of a file whose name an output takes.
enum class Existing { replaced, refused };

// A file under a hidden name in the folder of `path`, which commit() renames, with the
// permissions of the file it replaces. Until then nothing is to be seen under the final
// name; what a killed process leaves there the next writer of the file takes over. A symbolic
// link stays a link; a pipe or device is written directly, having no "whole".
class AtomicFile {
 public:
  // Throws Error(cannot_create).
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  // Where to write until commit(), for programs that open files by name.
  const std::filesystem::path& temporary() const { return temporary_; }

  // Appends. Throws Error(io).
  void write(std::string_view bytes);

  // Flushes to disk and gives the file its name. Throws Error(io), and
  // Error(cannot_create) where a file of that name came to be and is not to be
  // replaced. The file is closed after it.
  void commit(Existing existing = Existing::replaced);

 private:
  int name_file(Existing existing) const;  // the error code, or 0
  void discard();

  std::filesystem::path label_;        // as the user wrote it, for messages
  std::filesystem::path destination_;  // links followed
  std::filesystem::path temporary_;
  int descriptor_ = -1;
  bool in_place_ = false;         // a pipe or a device
  std::optional<unsigned> mode_;  // of the file to be replaced
};

// The folder and those around it, where they do not exist. Throws
// Error(cannot_create).
void make_folders(const std::filesystem::path& folder);

// A whole file at once: AtomicFile, write, commit.
void write_file(const std::filesystem::path& path, std::string_view bytes);

// As write_file; "-" writes to standard output.
void write_output(const std::string& name, std::string_view bytes);

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
