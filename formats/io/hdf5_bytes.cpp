#include "formats/io/hdf5_bytes.h"

#include <unistd.h>

#include <algorithm>
#include <optional>
#include <string>

#include "libevo/base/error.h"

namespace evo::hdf5 {
namespace {

// Numbers in a file are little-endian.
std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t i = width; i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// The bytes of a file, some at a time.
class Window {
 public:
  explicit Window(std::string_view bytes) : size_(bytes.size()), view_(bytes) {}
  Window(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}

  std::uint64_t size() const { return size_; }
  void end_at(std::uint64_t size) { size_ = std::min(size_, size); }

  // What there is from `at` on: at least `least` bytes, fewer only at the end.
  std::string_view from(std::uint64_t at, std::size_t least) {
    const std::uint64_t wanted = std::min<std::uint64_t>(least, size_ - at);
    if (at < begin_ || at + wanted > begin_ + view_.size()) move_to(at);
    return view_.substr(static_cast<std::size_t>(at - begin_));
  }

 private:
  void move_to(std::uint64_t at) {
    constexpr std::size_t width = std::size_t{1} << 20;
    buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(width, size_ - at)));
    std::size_t got = 0;
    while (got < buffer_.size()) {
      const ssize_t n = ::pread(descriptor_, buffer_.data() + got, buffer_.size() - got,
                                static_cast<off_t>(at + got));
      if (n <= 0) break;
      got += static_cast<std::size_t>(n);
    }
    buffer_.resize(got);
    if (got < width) end_at(at + got);  // of a file that got shorter
    view_ = buffer_;
    begin_ = at;
  }

  int descriptor_ = -1;
  std::uint64_t size_;
  std::string buffer_;
  std::uint64_t begin_ = 0;  // of `view_` in the file
  std::string_view view_;
};

constexpr std::size_t header = 16;  // of a collection, and of each object in it

// The collection at `at` (section III.E). `objects` may
// be counted down to nothing.
bool is_sound(Window& file, std::uint64_t at, std::uint64_t& objects) {
  const std::string_view head = file.from(at, header);
  if (head.size() < header) return false;
  const std::uint64_t length = number_at(head, 8, 8);
  if (length < header || length > file.size() - at) return false;
  const std::uint64_t end = at + length;
  for (std::uint64_t object = at + header; end - object >= header;) {
    const std::string_view entry = file.from(object, header);
    if (entry.size() < header || objects-- == 0) return false;
    const bool is_free_space = number_at(entry, 0, 2) == 0;
    const std::uint64_t content = number_at(entry, 8, 8);
    if (is_free_space) return content == end - object;  // the rest, its header included
    const std::uint64_t room = end - object - header;
    const std::uint64_t padded = content > room ? room + 1 : (content + 7) / 8 * 8;
    if (padded > room) return false;
    object += header + padded;
  }
  return true;
}

// From the superblock (HDF5 file format specification, section II.A).
std::optional<std::size_t> size_in(std::string_view superblock) {
  constexpr std::size_t longest = 64;
  if (superblock.size() < longest) return std::nullopt;
  // Versions 0 and 1 have the address of the end after those of the beginning and of
  // free space, 2 and 3 after those of the beginning and of an extension.
  const std::uint64_t version = number_at(superblock, 8, 1);
  const std::size_t addresses = version == 0 ? 24 : version == 1 ? 28 : 12;
  const std::uint64_t width = number_at(superblock, version < 2 ? 13 : 9, 1);
  if (version > 3 || (width != 4 && width != 8)) return std::nullopt;
  return number_at(superblock, addresses + 2 * width, width);
}

bool all_are_sound(Window file) {
  constexpr std::string_view signature("GCOL\1\0\0\0", 8);
  const std::string_view beginning = file.from(0, header);
  if (begins_as_hdf5(beginning)) file.end_at(size_in(beginning).value_or(file.size()));
  // Collections that overlap would take time beyond all measure; true ones do not.
  std::uint64_t objects = file.size() / header;
  for (std::uint64_t at = 0; at < file.size();) {
    const std::string_view bytes = file.from(at, signature.size());
    const std::size_t found = bytes.find(signature);
    if (found != std::string_view::npos) {
      if (!is_sound(file, at + found, objects)) return false;
      at += found + header;
    } else if (bytes.size() < signature.size()) {
      break;
    } else {
      at += bytes.size() - signature.size() + 1;  // it may begin in what was seen
    }
  }
  return true;
}

}  // namespace

bool begins_as_hdf5(std::string_view bytes) { return bytes.starts_with("\x89HDF\r\n\x1a\n"); }

std::size_t stated_size(std::string_view beginning, const std::string& where) {
  if (const auto size = size_in(beginning)) return *size;
  throw error(Failure::data, "{}: damaged or truncated HDF5 file", where);
}

bool heaps_are_sound(std::string_view bytes) { return all_are_sound(Window(bytes)); }
bool heaps_are_sound(int descriptor, std::uint64_t size) {
  return all_are_sound(Window(descriptor, size));
}

}  // namespace evo::hdf5
