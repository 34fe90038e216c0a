// --mode binary: a header of eight bytes, then what it announces.
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "cli/env/request.h"
#include "cli/env/serve.h"
#include "cli/env/stream.h"
#include "libevo/base/error.h"

namespace evo::cli {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

constexpr std::uint32_t longest_json = std::uint32_t{64} << 20U;
constexpr std::size_t alignment = 8;

struct Header {
  std::array<char, 4> kind{};
  std::uint32_t length = 0;  // bytes that follow
};
static_assert(sizeof(Header) == 8);

std::string_view name(const Header& header) { return {header.kind.data(), header.kind.size()}; }

template <typename T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

class FrameServer {
 public:
  FrameServer(Session& session, int input, int output)
      : session_(session),
        requests_(session),
        in_(input, /*eager=*/true),
        output_(output),
        actions_(session.action_values()),
        mask_((static_cast<std::size_t>(session.environments()) + alignment - 1) / alignment *
              alignment) {}

  void serve() {
    send_text("JSON", describe(session_));
    while (take_frame()) {
    }
  }

 private:
  // False at the end of the input.
  bool take_frame() {
    Header header;
    const std::size_t got = in_.read(std::as_writable_bytes(std::span(&header, 1)));
    if (got == 0) return false;
    ++number_;
    if (got < sizeof header) lost("the input ended within a header: {} of 8 bytes", got);
    const std::size_t action_bytes = actions_.size() * sizeof(double);
    if (name(header) == "STEP") {
      if (!has_length(header, action_bytes)) return true;
      read_rest(std::as_writable_bytes(std::span(actions_)));
      step({});
    } else if (name(header) == "MASK") {
      if (!has_length(header, mask_.size() + action_bytes)) return true;
      read_rest(std::as_writable_bytes(std::span(mask_)));
      read_rest(std::as_writable_bytes(std::span(actions_)));
      step(std::span(mask_).first(static_cast<std::size_t>(session_.environments())));
    } else if (name(header) == "JSON") {
      if (header.length > longest_json)
        lost("a JSON frame may have {} bytes, not {}", longest_json, header.length);
      read_text(header);
      fulfil([&] { return requests_.answer(parse_json(text_, where()), where()); });
    } else if (name(header) == "LOOK") {
      if (has_length(header, 0)) send_views();
    } else if (name(header) == "LOAD") {
      read_text(header);
      fulfil([&] {
        try {
          return load();
        } catch (const Error& failure) {
          throw failure.at(where());
        }
      });
    } else {
      std::uint32_t kind = 0;
      std::memcpy(&kind, header.kind.data(), sizeof kind);
      lost(
          "a frame begins with STEP, MASK, JSON, LOOK or LOAD, not with the bytes 0x{:08x} "
          "(little-endian)",
          kind);
    }
    return true;
  }

  std::string where() const { return fmt::format("frame {}", number_); }

  // A frame of a wrong length is read over: the next one can be told.
  bool has_length(const Header& header, std::size_t expected) {
    if (header.length == expected) return true;
    if (in_.skip(header.length) < header.length) lost("the input ended within a frame");
    send_failure(error(Failure::data, "{}: {} has {} bytes here, not {}", where(), name(header),
                       expected, header.length));
    return false;
  }

  void read_rest(std::span<std::byte> target) {
    const std::size_t got = in_.read(target);
    if (got < target.size())
      lost("the input ended within a frame: {} of {} bytes", got, target.size());
  }

  // Memory is taken as bytes come, whatever is announced.
  void read_text(const Header& header) {
    constexpr std::size_t piece = std::size_t{1} << 20U;
    text_.clear();
    while (text_.size() < header.length) {
      const std::size_t begin = text_.size();
      text_.resize(std::min<std::size_t>(header.length, begin + piece));
      read_rest(std::as_writable_bytes(std::span(text_).subspan(begin)));
    }
  }

  // States as send_saved() has written them.
  Answer load() {
    std::size_t at = 0;
    const auto take = [&](std::uint64_t bytes) {
      if (bytes > text_.size() - at)
        throw error(Failure::data, "LOAD has the payload of a SAVE, of which {} bytes are too few",
                    text_.size());
      at += bytes;
      return text_.data() + at - bytes;
    };
    const auto number = [&] {
      std::uint64_t value = 0;
      std::memcpy(&value, take(sizeof value), sizeof value);
      return value;
    };
    std::vector<std::pair<int, std::uint64_t>> table;
    for (std::uint64_t left = number(); left > 0; --left) {
      const auto environment = static_cast<std::int64_t>(number());
      session_.check_environment(environment);
      table.emplace_back(static_cast<int>(environment), number());
    }
    std::vector<Session::Restored> states;
    for (const auto& [environment, length] : table)
      states.push_back(
          {environment, {reinterpret_cast<const std::uint8_t*>(take(length)), length}});
    if (at != text_.size())
      throw error(Failure::data, "{} bytes follow the last state", text_.size() - at);
    session_.restore(states);
    return {};
  }

  template <typename... Args>
  [[noreturn]] void lost(fmt::format_string<Args...> format, Args&&... args) {
    const Error failure(Failure::data,
                        where() + ": " + fmt::format(format, std::forward<Args>(args)...));
    send_failure(failure);
    throw failure;
  }

  void step(std::span<const std::uint8_t> active) {
    fulfil([&] {
      try {
        session_.step(actions_, active);
      } catch (const Error& failure) {
        throw failure.at(where());
      }
      return Answer{};
    });
  }

  template <typename Work>
  void fulfil(const Work& work) {
    Answer answer;
    try {
      answer = work();
    } catch (const Error& failure) {
      if (failure.kind() == Failure::io) throw;
      send_failure(failure);
      return;
    }
    switch (answer.kind) {
      case Answer::Kind::state:
        return send_state();
      case Answer::Kind::document:
        return send_text("JSON", answer.document);
      case Answer::Kind::picture:
        return send_picture(answer.picture);
      case Answer::Kind::saved:
        return send_saved(answer);
    }
  }

  void send_state() {
    begin("DATA");
    const int count = session_.environments();
    const auto observations = session_.envs().observations();
    append(out_, observations.data(), observations.size());
    for (int e = 0; e < count; ++e) {
      const double reward = session_.reward(e);
      append(out_, &reward, 1);
    }
    for (int e = 0; e < count; ++e) out_.push_back(session_.terminated(e) ? 1 : 0);
    for (int e = 0; e < count; ++e) out_.push_back(session_.truncated(e) ? 1 : 0);
    for (int e = 0; e < count; ++e) out_.push_back(static_cast<char>(session_.status(e)));
    send();
  }

  void send_views() {
    const SessionVoxels& voxels = requests_.voxels();
    views_.resize(voxels.local_values() + voxels.task_values());
    const std::span all(views_);
    voxels.look(all.first(voxels.local_values()), all.subspan(voxels.local_values()));
    begin("VIEW");
    append(out_, views_.data(), views_.size());
    send();
  }

  void send_picture(const render::Image& image) {
    begin("PICT");
    const std::array size{static_cast<std::uint32_t>(image.size.width),
                          static_cast<std::uint32_t>(image.size.height)};
    append(out_, size.data(), size.size());
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) append(out_, &image.rgba[i], 3);
    send();
  }

  void send_saved(const Answer& answer) {
    begin("SAVE");
    const auto number = [&](std::uint64_t value) { append(out_, &value, 1); };
    number(answer.saved.size());
    for (std::size_t i = 0; i < answer.saved.size(); ++i) {
      number(static_cast<std::uint64_t>(answer.environments[i]));
      number(answer.saved[i].size());
    }
    for (const std::vector<std::uint8_t>& state : answer.saved)
      append(out_, state.data(), state.size());
    if (out_.size() - sizeof(Header) > std::numeric_limits<std::uint32_t>::max())
      return send_failure(error(Failure::usage,
                                "{}: {} states are more than a frame holds; ask for fewer", where(),
                                answer.saved.size()));
    send();
  }

  void send_text(const char* kind, const Json& document) {
    begin(kind);
    out_ += compact(document);
    send();
  }
  void send_failure(const Error& failure) { send_text("FAIL", {{"error", failure.what()}}); }

  void begin(const char* kind) { out_.assign(kind).append(sizeof(std::uint32_t), '\0'); }
  void send() {
    const auto length = static_cast<std::uint32_t>(out_.size() - sizeof(Header));
    std::memcpy(out_.data() + offsetof(Header, length), &length, sizeof length);
    write_all(output_, out_);
  }

  Session& session_;
  Requests requests_;
  InputStream in_;
  int output_;
  std::size_t number_ = 0;  // of the frame being read
  std::vector<double> actions_;
  std::vector<std::uint8_t> mask_;
  std::vector<double> views_;
  std::string text_;
  std::string out_;
};

}  // namespace

void serve_frames(Session& session, int input, int output) {
  try {
    FrameServer(session, input, output).serve();
  } catch (const ClientGone&) {
    return;
  }
}

}  // namespace evo::cli
