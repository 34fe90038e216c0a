#include "cli/process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "cli/command.h"
#include "formats/io/files.h"

namespace evo::cli {
namespace {

// A file without a name that holds the text, to be read from its beginning.
int unnamed_file(const std::string& text) {
  std::FILE* file = std::tmpfile();
  if (file == nullptr || std::fwrite(text.data(), 1, text.size(), file) != text.size() ||
      std::fflush(file) != 0)
    throw error(Failure::io, "no temporary file can be written: {}", std::strerror(errno));
  const int descriptor = ::dup(::fileno(file));
  std::fclose(file);
  ::lseek(descriptor, 0, SEEK_SET);
  return descriptor;
}

std::string read_to_end(int descriptor) {
  std::string text;
  std::array<char, 1 << 16> buffer{};
  for (;;) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR && interrupted() == 0) continue;
    if (count <= 0 || text.size() > largest_value) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> list;
  for (std::string& word : words) list.push_back(word.data());
  list.push_back(nullptr);
  return list;
}

Ended run_program(std::vector<std::string> words, const std::string& input) {
  const int file = unnamed_file(input);
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0)
    throw error(Failure::io, "no pipe can be opened: {}", std::strerror(errno));
  const pid_t child = ::fork();
  if (child < 0) throw error(Failure::io, "no process can be started: {}", std::strerror(errno));
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    ::dup2(file, STDIN_FILENO);
    ::dup2(pipe[1], STDOUT_FILENO);
    ::execvp(words[0].c_str(), pointers(words).data());
    ::_exit(127);
  }
  ::close(file);
  ::close(pipe[1]);
  Ended ended;
  ended.output = read_to_end(pipe[0]);
  ::close(pipe[0]);
  if (interrupted() != 0) ::kill(child, SIGTERM);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR)
    if (interrupted() != 0) ::kill(child, SIGTERM);
  ended.status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return ended;
}

}  // namespace evo::cli
