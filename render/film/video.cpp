#include "render/film/video.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <vector>

#include "formats/io/values.h"
#include "libevo/base/error.h"

namespace evo::render {
namespace {

// ---- ffmpeg --------------------------------------------------------------------

// Players expect colours of BT.709 in limited range, two by two pixels with one chroma.
constexpr const char* as_video =
    "-vf scale=out_color_matrix=bt709:out_range=tv -pix_fmt yuv420p -color_primaries bt709 "
    "-color_trc bt709 -colorspace bt709 -color_range tv";

std::string encoder_options(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  // Even colours that nothing fades in gain little by weighted prediction, trellis and a
  // wide search: files are as large without (1 % more to 3 % less) for 9 % fewer instructions.
  if (extension == ".mp4")
    return fmt::format(
        "{} -c:v libx264 -preset medium -crf 20 -x264-params weightp=0:me=dia:trellis=0 "
        "-movflags +faststart -f mp4",
        as_video);
  if (extension == ".webm")
    return fmt::format(
        "{} -c:v libvpx-vp9 -crf 30 -b:v 0 -deadline realtime -cpu-used 6 -row-mt 1 -f webm",
        as_video);
  // .gif: one palette of the whole film; colours that are even stay so.
  return "-filter_complex split[all][seen];[seen]palettegen[palette];"
         "[all][palette]paletteuse=dither=none:diff_mode=rectangle -f gif";
}

std::vector<std::string> ffmpeg_arguments(const std::filesystem::path& path,
                                          const std::filesystem::path& output, Size size,
                                          double fps) {
  const std::string options = fmt::format(
      "ffmpeg -nostdin -hide_banner -loglevel error -y -f rawvideo -pix_fmt rgb0 "
      "-video_size {}x{} -framerate {} -i pipe:0 -map_metadata -1 -fflags +bitexact {}",
      size.width, size.height, fps, encoder_options(path));
  std::vector<std::string> words = split_list(options, ' ');
  words.push_back("file:" + output.string());  // may have blanks
  return words;
}

std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t at = text.find_last_of("\r\n");
  return at == std::string::npos ? text : text.substr(at + 1);
}

// All of it. False when the reader has gone, which raises no signal here.
bool write_quietly(int descriptor, std::string_view bytes, const std::string& label) {
  while (!bytes.empty()) {
    const ssize_t put = ::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0 && (errno == EPIPE || errno == ECONNRESET)) return false;
    if (put < 0) throw error(Failure::io, "{}: cannot be written: {}", label, reason(errno));
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

// How ffmpeg ends where the disk or the quota does.
constexpr std::array out_of_room{"No space left on device", "File too large",
                                 "Disk quota exceeded"};

}  // namespace

struct FfmpegEncoder::Process {
  pid_t id = -1;
  int input = -1;       // frames go in here
  int complaints = -1;  // its standard error, an unlinked temporary file

  Process() = default;
  ~Process() {
    if (input >= 0) ::close(input);
    if (complaints >= 0) ::close(complaints);
    if (id > 0) {
      ::kill(id, SIGKILL);
      wait();
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void start(const std::vector<std::string>& arguments) {
    int ends[2];
    // Seekable, so that a talkative ffmpeg never waits for a reader.
    complaints = ::memfd_create("ffmpeg-stderr", MFD_CLOEXEC);
    if (complaints < 0 || ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
      throw error(Failure::work, "cannot open a connection to ffmpeg: {}", reason(errno));
    input = ends[1];
    const int code = spawn(arguments, ends[0]);
    ::close(ends[0]);
    if (code == ENOENT)
      throw Error(Failure::work,
                  "the program ffmpeg, which makes films, is not installed (package ffmpeg); "
                  "pictures, frames/%05d.png too, need nothing");
    if (code != 0) throw error(Failure::work, "ffmpeg cannot be started: {}", reason(code));
  }

  int spawn(const std::vector<std::string>& arguments, int frames) {
    std::vector<char*> words;
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, frames, STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, complaints, STDERR_FILENO);
    // A file that grows too large ends ffmpeg; told of it as an error, it would continue
    // and say that all is well.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t restored;
    sigemptyset(&restored);
    sigaddset(&restored, SIGXFSZ);
    posix_spawnattr_setsigdefault(&attributes, &restored);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    const int code =
        ::posix_spawnp(&id, words.front(), &actions, &attributes, words.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (code != 0) id = -1;
    return code;
  }

  int wait() {
    int status = 0;
    while (::waitpid(id, &status, 0) < 0 && errno == EINTR) {
    }
    id = -1;
    return status;
  }

  // It may end well all the same.
  bool ran_out_of_room() const {
    const std::string words = last_words();
    return std::any_of(out_of_room.begin(), out_of_room.end(),
                       [&](const char* reason) { return words.find(reason) != std::string::npos; });
  }

  Error failure(const std::filesystem::path& path, int status) const {
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ)
      return error(Failure::io, "{}: cannot be written: {}", path.string(), reason(EFBIG));
    return error(ran_out_of_room() ? Failure::io : Failure::work, "{}: ffmpeg failed: {}",
                 path.string(), last_words());
  }

  std::string last_words() const {
    std::array<char, 4096> tail{};
    const off_t end = ::lseek(complaints, 0, SEEK_END);
    const off_t start = std::max<off_t>(0, end - static_cast<off_t>(tail.size()));
    const ssize_t got = ::pread(complaints, tail.data(), tail.size(), start);
    const std::string line =
        got > 0 ? last_line({tail.data(), static_cast<std::size_t>(got)}) : std::string();
    return line.empty() ? "it said nothing" : line;
  }
};

FfmpegEncoder::FfmpegEncoder(const std::filesystem::path& path, Size size, double fps)
    : path_(path), file_(path), process_(std::make_unique<Process>()) {
  process_->start(ffmpeg_arguments(path, file_.temporary(), size, fps));
}

FfmpegEncoder::~FfmpegEncoder() = default;

void FfmpegEncoder::add(std::span<const std::uint8_t> rgba) {
  const std::string_view bytes(reinterpret_cast<const char*>(rgba.data()),  // NOLINT: bytes
                               rgba.size());
  if (write_quietly(process_->input, bytes, path_.string())) return;
  finish();  // says why it stopped
  throw error(Failure::work, "{}: ffmpeg stopped reading", path_.string());
}

void FfmpegEncoder::finish() {
  ::close(process_->input);
  process_->input = -1;
  const int status = process_->wait();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || process_->ran_out_of_room())
    throw process_->failure(path_, status);
  file_.commit();
}

}  // namespace evo::render
