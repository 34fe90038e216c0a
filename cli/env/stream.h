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

// Whether input is worth looking out for before the process is put to sleep for it.
// One asleep on an idle processor is woken some 50 us after its input has come: as
// long as a control step of a small robot takes. Looking out in vain costs others
// the processor, so the next turn is put off, each time for twice as long.
class LookOut {
 public:
  // Returns once there is input (or its end), or after a moment without.
  void wait(int descriptor);

 private:
  unsigned put_off_ = 0;  // waits that the last turn in vain put the next one off for
  unsigned left_ = 0;     // of them
};

class InputStream {
 public:
  // eager: the client is expected to answer at once, again and again.
  explicit InputStream(int descriptor, bool eager = false)
      : descriptor_(descriptor), eager_(eager) {}

  // Fills `target`, or as much as comes before the end; how many bytes those
  // are. Throws Error(io).
  std::size_t read(std::span<std::byte> target);

  // Reads and forgets; how many bytes came before the end.
  std::size_t skip(std::size_t bytes);

  // The next line without its newline. The end of the input ends a line, too. One that
  // is too long is read over, unless it seems to have no end.
  enum class Line { whole, too_long, endless, none };
  Line read_line(std::string& line, std::size_t longest);

 private:
  bool fill();  // false at the end
  std::size_t read_some(std::span<std::byte> target);

  int descriptor_;
  bool eager_;
  LookOut look_out_;
  std::vector<std::byte> buffer_ = std::vector<std::byte>(std::size_t{1} << 16U);
  std::size_t begin_ = 0;  // of what was not taken yet
  std::size_t end_ = 0;
};

// All of it. Throws ClientGone or Error(io).
void write_all(int descriptor, std::string_view bytes);

}  // namespace evo::cli
