#include "render/film/gif.h"

#include <gif_lib.h>

#include <algorithm>
#include <array>

#include "libevo/base/error.h"
#include "render/film/animation.h"

namespace evo::render {
namespace {

constexpr int color_bits = 8;
constexpr int transparent = 255;

using ColorMap = std::unique_ptr<ColorMapObject, void (*)(ColorMapObject*)>;

int append(GifFileType* gif, const GifByteType* bytes, int count) {
  static_cast<std::string*>(gif->UserData)
      ->append(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(count));  // NOLINT
  return count;
}

ColorMap color_map(const std::vector<Color>& palette) {
  ColorMap map(GifMakeMapObject(1 << color_bits, nullptr), GifFreeMapObject);
  for (std::size_t k = 0; k < palette.size(); ++k)
    map->Colors[k] = {palette[k].r, palette[k].g, palette[k].b};
  return map;
}

}  // namespace

struct GifEncoder::File {
  std::string bytes;
  GifFileType* gif = nullptr;

  File() {
    int code = 0;
    gif = EGifOpen(&bytes, append, &code);
    if (gif == nullptr) throw error(Failure::work, "giflib cannot start: {}", GifErrorString(code));
    EGifSetGifVersion(gif, true);
  }
  ~File() { close(); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void close() {
    int code = 0;
    if (gif != nullptr) EGifCloseFile(gif, &code);
    gif = nullptr;
  }

  void check(int result) const {
    if (result != GIF_OK)
      throw error(Failure::work, "giflib cannot encode a frame: {}", GifErrorString(gif->Error));
  }

  void repeat_for_ever() const {
    constexpr char name[] = "NETSCAPE2.0";
    constexpr std::array<unsigned char, 3> count{1, 0, 0};
    check(EGifPutExtensionLeader(gif, APPLICATION_EXT_FUNC_CODE));
    check(EGifPutExtensionBlock(gif, sizeof name - 1, name));
    check(EGifPutExtensionBlock(gif, static_cast<int>(count.size()), count.data()));
    check(EGifPutExtensionTrailer(gif));
  }

  void control(int delay) const {
    const GraphicsControlBlock block{DISPOSE_DO_NOT, false, delay, transparent};
    std::array<GifByteType, 4> packed{};
    EGifGCBToExtension(&block, packed.data());
    check(EGifPutExtension(gif, GRAPHICS_EXT_FUNC_CODE, static_cast<int>(packed.size()),
                           packed.data()));
  }
};

GifEncoder::GifEncoder(Size size, std::vector<Color> palette)
    : file_(std::make_unique<File>()), map_(std::move(palette)), size_(size) {
  const ColorMap colors = color_map(map_.palette());
  file_->check(EGifPutScreenDesc(file_->gif, size.width, size.height, color_bits, 0, colors.get()));
  file_->repeat_for_ever();
}

GifEncoder::~GifEncoder() = default;

void GifEncoder::add(const PixelView& frame, int delay) {
  std::vector<std::uint8_t> indices(frame.rgba.size() / 4);
  for (std::size_t k = 0; k < indices.size(); ++k)
    indices[k] = map_.index(frame.rgba[4 * k], frame.rgba[4 * k + 1], frame.rgba[4 * k + 2]);
  const Area area = changed_area(size_, previous_, indices, 1);
  file_->control(delay);
  file_->check(EGifPutImageDesc(file_->gif, area.x, area.y, area.size.width, area.size.height,
                                false, nullptr));
  std::vector<std::uint8_t> line(static_cast<std::size_t>(area.size.width));
  for (int y = 0; y < area.size.height; ++y) {
    const auto start =
        static_cast<std::size_t>(area.y + y) * static_cast<std::size_t>(size_.width) +
        static_cast<std::size_t>(area.x);
    for (std::size_t x = 0; x < line.size(); ++x) {
      const bool as_before = !previous_.empty() && previous_[start + x] == indices[start + x];
      line[x] = as_before ? transparent : indices[start + x];
    }
    file_->check(EGifPutLine(file_->gif, line.data(), area.size.width));
  }
  previous_ = std::move(indices);
}

std::string GifEncoder::finish() {
  file_->close();
  return std::move(file_->bytes);
}

}  // namespace evo::render
