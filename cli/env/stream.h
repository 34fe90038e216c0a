// Bytes between a client and evo-env, over descriptors: a client that goes away
// in the middle is an ordinary event.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evo::cli {

// The client has closed its end: there is nobody left to answer.
struct ClientGone {};

class InputStream {
 public:
  explicit InputStream(int descriptor) : descriptor_(descriptor) {}

  // Fills `target`, or as much as comes before the end; how many bytes those
  // are. Throws Error(io).
  std::size_t read(std::span<std::byte> target);

  // Reads and forgets; how many bytes came before the end.
  std::size_t skip(std::size_t bytes);

  // The next line without its newline. The end of the input ends a line, too.
  enum class Line { whole, too_long, none };
  Line read_line(std::string& line, std::size_t longest);

 private:
  bool fill();  // false at the end

  int descriptor_;
  std::vector<std::byte> buffer_ = std::vector<std::byte>(std::size_t{1} << 16U);
  std::size_t begin_ = 0;  // of what was not taken yet
  std::size_t end_ = 0;
};

// All of it. Throws ClientGone or Error(io).
void write_all(int descriptor, std::string_view bytes);

}  // namespace evo::cli
