#include "render/film/video.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <ctime>
#include <system_error>
#include <vector>

#include "libevo/base/error.h"

namespace evo::render {
namespace {

std::string reason(int code) { return std::generic_category().message(code); }

// Keeps SIGPIPE from the calling thread while it lives; one that was raised
// meanwhile is taken away.
class NoSigpipe {
 public:
  NoSigpipe() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoSigpipe() {
    if (sigismember(&before_, SIGPIPE) == 1) return;  // somebody else waits for it
    constexpr timespec at_once{0, 0};
    while (sigtimedwait(&pipe_, nullptr, &at_once) < 0 && errno == EINTR) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoSigpipe(const NoSigpipe&) = delete;
  NoSigpipe& operator=(const NoSigpipe&) = delete;

 private:
  sigset_t pipe_{};
  sigset_t before_{};
};

// ---- colour -------------------------------------------------------------------

// BT.709 luma and chroma of 8-bit values, limited range, in 1/65536.
constexpr int luma(int r, int g, int b) {
  return (11966 * r + 40254 * g + 4064 * b + (16 << 16) + 32768) >> 16;
}
constexpr int blue(int r, int g, int b) {
  return (-6596 * r - 22189 * g + 28784 * b + (128 << 16) + 32768) >> 16;
}
constexpr int red(int r, int g, int b) {
  return (28784 * r - 26145 * g - 2639 * b + (128 << 16) + 32768) >> 16;
}

int half(int n) { return (n + 1) / 2; }

// ---- ffmpeg --------------------------------------------------------------------

using Arguments = std::vector<std::string>;

Arguments encoder_arguments(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  // Even colours that nothing fades in gain little by weighted prediction, trellis and a
  // wide search: files are as large without (1 % more to 3 % less) for 9 % fewer instructions.
  if (extension == ".mp4")
    return {"-c:v",     "libx264", "-preset",      "medium",
            "-crf",     "20",      "-x264-params", "weightp=0:me=dia:trellis=0",
            "-pix_fmt", "yuv420p", "-movflags",    "+faststart",
            "-f",       "mp4"};
  if (extension == ".webm")
    return {"-c:v",      "libvpx-vp9", "-crf",      "30",  "-b:v",    "0",
            "-deadline", "realtime",   "-cpu-used", "6",   "-row-mt", "1",
            "-pix_fmt",  "yuv420p",    "-f",        "webm"};
  throw error(Failure::usage, "{}: a video ends in .mp4 or .webm", path.string());
}

Arguments ffmpeg_arguments(const std::filesystem::path& path, const std::filesystem::path& output) {
  Arguments all{
      "ffmpeg", "-nostdin",     "-hide_banner", "-loglevel",        "error", "-y",
      "-f",     "yuv4mpegpipe", "-i",           "pipe:0",           "-an",   "-map_metadata",
      "-1",     "-fflags",      "+bitexact",    "-color_primaries", "bt709", "-color_trc",
      "bt709",  "-colorspace",  "bt709",        "-color_range",     "tv"};
  const Arguments encoder = encoder_arguments(path);
  all.insert(all.end(), encoder.begin(), encoder.end());
  all.push_back("file:" + output.string());
  return all;
}

std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t at = text.find_last_of("\r\n");
  return at == std::string::npos ? text : text.substr(at + 1);
}

}  // namespace

std::size_t yuv_bytes(Size size) {
  const auto luma_bytes =
      static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  return luma_bytes + 2 * static_cast<std::size_t>(half(size.width)) *
                          static_cast<std::size_t>(half(size.height));
}

void to_yuv(const PixelView& image, std::span<std::uint8_t> out) {
  const auto [width, height] = image.size;
  const std::uint8_t* pixels = image.rgba.data();
  std::uint8_t* y_plane = out.data();
  std::uint8_t* u_plane = y_plane + static_cast<std::ptrdiff_t>(width) * height;
  std::uint8_t* v_plane = u_plane + static_cast<std::ptrdiff_t>(half(width)) * half(height);
  for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(width) * height; ++k)
    y_plane[k] =
        static_cast<std::uint8_t>(luma(pixels[4 * k], pixels[4 * k + 1], pixels[4 * k + 2]));
  for (int y = 0; y < height; y += 2) {
    const std::uint8_t* upper = pixels + 4 * static_cast<std::ptrdiff_t>(y) * width;
    const std::uint8_t* lower =
        y + 1 < height ? upper + 4 * static_cast<std::ptrdiff_t>(width) : upper;
    for (int x = 0; x < width; x += 2) {
      const int here = 4 * x;
      const int next = x + 1 < width ? here + 4 : here;
      const auto mean = [&](int channel) {
        return (upper[here + channel] + upper[next + channel] + lower[here + channel] +
                lower[next + channel] + 2) /
               4;
      };
      const int r = mean(0);
      const int g = mean(1);
      const int b = mean(2);
      *u_plane++ = static_cast<std::uint8_t>(blue(r, g, b));
      *v_plane++ = static_cast<std::uint8_t>(red(r, g, b));
    }
  }
}

std::string y4m_header(Size size, double fps) {
  constexpr int denominator = 1000;
  return fmt::format("YUV4MPEG2 W{} H{} F{}:{} Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n", size.width,
                     size.height, std::lround(fps * denominator), denominator);
}

bool write_quietly(int descriptor, std::string_view bytes, const std::string& label) {
  const NoSigpipe guard;
  while (!bytes.empty()) {
    const ssize_t put = ::write(descriptor, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0 && errno == EPIPE) return false;
    if (put < 0) throw error(Failure::io, "{}: cannot be written: {}", label, reason(errno));
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

// How ffmpeg ends where the disk or the quota does.
constexpr std::array out_of_room{"No space left on device", "File too large",
                                 "Disk quota exceeded"};

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

  void start(const Arguments& arguments) {
    int ends[2];
    // Seekable, so that a talkative ffmpeg never waits for a reader.
    complaints = ::memfd_create("ffmpeg-stderr", MFD_CLOEXEC);
    if (complaints < 0 || ::pipe2(ends, O_CLOEXEC) != 0)
      throw error(Failure::work, "cannot open a pipe to ffmpeg: {}", reason(errno));
    input = ends[1];
    const int code = spawn(arguments, ends[0]);
    ::close(ends[0]);
    if (code == ENOENT)
      throw Error(Failure::work,
                  "the program ffmpeg, which makes MP4 and WebM, is not installed (package "
                  "ffmpeg); .gif, .png and '-' (Y4M) need nothing");
    if (code != 0) throw error(Failure::work, "ffmpeg cannot be started: {}", reason(code));
  }

  int spawn(const Arguments& arguments, int frames) {
    std::vector<char*> words;
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, frames, STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, complaints, STDERR_FILENO);
    // A file that grows too large ends ffmpeg; told of it as an error, it would go on
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
  process_->start(ffmpeg_arguments(path, file_.temporary()));
  const std::string header = y4m_header(size, fps);
  (void)write_quietly(process_->input, header, path_.string());
}

FfmpegEncoder::~FfmpegEncoder() = default;

void FfmpegEncoder::add(std::span<const std::uint8_t> planes) {
  const std::string_view bytes(reinterpret_cast<const char*>(planes.data()),  // NOLINT: bytes
                               planes.size());
  if (write_quietly(process_->input, y4m_frame_line, path_.string()) &&
      write_quietly(process_->input, bytes, path_.string()))
    return;
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
