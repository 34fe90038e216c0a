#include "render/painters/text.h"

#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "render/painters/font_data.h"

namespace evo::render {
namespace {

constexpr float sixty_fourth = 1.0F / 64.0F;  // FreeType's unit

// Code points of UTF-8; a malformed byte becomes U+FFFD.
std::vector<char32_t> decode(std::string_view utf8) {
  std::vector<char32_t> points;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const int extra = lead < 0x80 ? 0 : lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : -1;
    if (extra < 0 || i + static_cast<std::size_t>(extra) >= utf8.size()) {
      points.push_back(U'\uFFFD');
      ++i;
      continue;
    }
    constexpr unsigned masks[] = {0x7F, 0x1F, 0x0F, 0x07};
    char32_t point = lead & masks[extra];
    for (int k = 1; k <= extra; ++k)
      point =
          point << 6U | (static_cast<unsigned char>(utf8[i + static_cast<std::size_t>(k)]) & 0x3FU);
    points.push_back(point);
    i += static_cast<std::size_t>(extra) + 1;
  }
  return points;
}

struct Glyph {
  int left = 0;  // pixels from the pen to the bitmap
  int top = 0;   // pixels from the baseline up to its first row
  int width = 0;
  int rows = 0;
  float advance = 0;
  std::vector<std::uint8_t> coverage;
};

void blend(std::uint8_t* pixel, Color color, unsigned coverage) {
  const unsigned alpha = coverage * color.a / 255U;
  const auto channel = [alpha](std::uint8_t below, std::uint8_t above) {
    return static_cast<std::uint8_t>((below * (255U - alpha) + above * alpha + 127U) / 255U);
  };
  pixel[0] = channel(pixel[0], color.r);
  pixel[1] = channel(pixel[1], color.g);
  pixel[2] = channel(pixel[2], color.b);
}

void paste(const Glyph& glyph, int pen_x, int baseline, Color color, PixelTarget target) {
  for (int row = 0; row < glyph.rows; ++row) {
    const int y = baseline - glyph.top + row;
    if (y < 0 || y >= target.size.height) continue;
    for (int col = 0; col < glyph.width; ++col) {
      const int x = pen_x + glyph.left + col;
      if (x < 0 || x >= target.size.width) continue;
      const auto source = static_cast<std::size_t>(row) * static_cast<std::size_t>(glyph.width) +
                          static_cast<std::size_t>(col);
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(target.size.width) +
                      static_cast<std::size_t>(x);
      blend(&target.rgba[4 * at], color, glyph.coverage[source]);
    }
  }
}

}  // namespace

struct Typesetter::Faces {
  // Pen positions are rounded to quarters of a pixel, so that small text is
  // evenly spaced; a glyph is cached for each.
  static constexpr int subpixels = 4;
  using Key = std::tuple<bool, int, char32_t, int>;  // bold, size in 64ths, letter, subpixel

  FT_Library library = start_freetype();
  FT_Face regular = open_font(library, false);
  FT_Face bold = open_font(library, true);
  std::map<Key, Glyph> glyphs;

  Faces() = default;
  ~Faces() { FT_Done_FreeType(library); }
  Faces(const Faces&) = delete;
  Faces& operator=(const Faces&) = delete;

  const Glyph& glyph(char32_t letter, float size, bool is_bold, int subpixel) {
    const int size64 = static_cast<int>(std::lround(size / sixty_fourth));
    const auto [entry, fresh] = glyphs.try_emplace({is_bold, size64, letter, subpixel});
    if (fresh) entry->second = rasterise(is_bold ? bold : regular, letter, size64, subpixel);
    return entry->second;
  }

  static Glyph rasterise(FT_Face face, char32_t letter, int size64, int subpixel) {
    Glyph glyph;
    FT_Set_Char_Size(face, 0, size64, 72, 72);
    FT_Vector shift{subpixel * 64 / subpixels, 0};
    FT_Set_Transform(face, nullptr, &shift);
    // Light hinting moves outlines vertically only: sharp baselines, true widths.
    if (FT_Load_Char(face, letter, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) != 0) return glyph;
    const FT_GlyphSlot slot = face->glyph;
    glyph.left = slot->bitmap_left;
    glyph.top = slot->bitmap_top;
    glyph.width = static_cast<int>(slot->bitmap.width);
    glyph.rows = static_cast<int>(slot->bitmap.rows);
    glyph.advance = static_cast<float>(slot->linearHoriAdvance) / 65536.0F;
    for (int row = 0; row < glyph.rows; ++row) {
      const unsigned char* from =
          slot->bitmap.buffer + static_cast<std::ptrdiff_t>(row) * slot->bitmap.pitch;
      glyph.coverage.insert(glyph.coverage.end(), from, from + glyph.width);
    }
    return glyph;
  }
};

Typesetter::Typesetter() : faces_(std::make_unique<Faces>()) {}
Typesetter::~Typesetter() = default;

float Typesetter::width(std::string_view utf8, float size, bool bold) {
  float width = 0;
  for (const char32_t letter : decode(utf8)) width += faces_->glyph(letter, size, bold, 0).advance;
  return width;
}

std::string Typesetter::shortened(std::string_view utf8, float size, bool bold, float most) {
  if (width(utf8, size, bold) <= most) return std::string(utf8);
  constexpr std::string_view ellipsis = "…";
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  std::string text(utf8);
  while (!text.empty()) {
    while (!text.empty() && continues(text.back())) text.pop_back();
    if (!text.empty()) text.pop_back();
    std::string candidate = text + std::string(ellipsis);
    if (width(candidate, size, bold) <= most) return candidate;
  }
  return {};
}

void Typesetter::draw(const Text& text, PixelTarget target) {
  float pen = text.at.x;
  if (text.align != Align::left) {
    const float w = width(text.text, text.size, text.bold);
    pen -= text.align == Align::centre ? w / 2 : w;
  }
  const int baseline = static_cast<int>(std::lround(text.at.y));
  for (const char32_t letter : decode(text.text)) {
    const auto quarters = static_cast<int>(std::floor(pen * Faces::subpixels + 0.5F));
    const int whole = quarters >= 0 ? quarters / Faces::subpixels
                                    : -((-quarters + Faces::subpixels - 1) / Faces::subpixels);
    const Glyph& glyph =
        faces_->glyph(letter, text.size, text.bold, quarters - whole * Faces::subpixels);
    paste(glyph, whole, baseline, text.color, target);
    pen += glyph.advance;
  }
}

}  // namespace evo::render
