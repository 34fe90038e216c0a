// Drawings by cairo: PDF, and pixels where OpenGL is not wanted.
#include <cairo-ft.h>
#include <cairo-pdf.h>

#include <cstring>
#include <memory>

#include "libevo/base/error.h"
#include "render/painters/font_data.h"
#include "render/painters/raster.h"
#include "render/painters/vector.h"

namespace evo::render {
namespace {

constexpr double points_a_pixel = 72.0 / 96.0;

template <auto Free>
struct Release {
  template <typename T>
  void operator()(T* thing) const {
    Free(thing);
  }
};
using Surface = std::unique_ptr<cairo_surface_t, Release<cairo_surface_destroy>>;
using Context = std::unique_ptr<cairo_t, Release<cairo_destroy>>;
using FontFace = std::unique_ptr<cairo_font_face_t, Release<cairo_font_face_destroy>>;

// The built-in fonts. cairo keeps a face as long as a surface uses it, so they live
// as long as the program.
cairo_font_face_t* font_face(bool bold) {
  static const FT_Library library = start_freetype();
  const auto open = [](bool heavy) {
    return FontFace(cairo_ft_font_face_create_for_ft_face(open_font(library, heavy), 0));
  };
  static const FontFace faces[] = {open(false), open(true)};
  return faces[bold ? 1 : 0].get();
}

// Shapes on a surface of cairo's.
class Page {
 public:
  enum class Borders {
    smooth,  // of fills
    sharp,   // fills beside each other have no seam, as when OpenGL paints them
  };
  Page(cairo_t* context, Borders borders) : cairo_(context), borders_(borders) {
    cairo_set_miter_limit(cairo_, 2.0);
  }

  void shapes(const Drawing& drawing) {
    for (const Drawing::Item& item : drawing.items()) {
      clip(item.clip);
      std::visit(*this, item.shape);
    }
  }

  void clip(const Rect& area) {
    cairo_reset_clip(cairo_);
    rectangle(area);
    cairo_clip(cairo_);
  }

  void operator()(const Polygon& shape) {
    path(shape.points);
    cairo_close_path(cairo_);
    if (borders_ == Borders::sharp) cairo_set_antialias(cairo_, CAIRO_ANTIALIAS_NONE);
    fill(shape.color, 1.0);
    cairo_set_antialias(cairo_, CAIRO_ANTIALIAS_DEFAULT);
  }

  void operator()(const Gradient& shape) {
    const auto [area, top, bottom] = shape;
    rectangle(area);
    if (top == bottom) return fill(top, 1.0);
    cairo_pattern_t* pattern = cairo_pattern_create_linear(0, area.y, 0, area.y + area.height);
    for (const auto& [offset, color] : {std::pair{0.0, top}, {1.0, bottom}})
      cairo_pattern_add_color_stop_rgb(pattern, offset, color.r / 255.0, color.g / 255.0,
                                       color.b / 255.0);
    cairo_set_source(cairo_, pattern);
    cairo_pattern_destroy(pattern);
    cairo_fill(cairo_);
  }

  void operator()(const Stroke& shape) {
    cairo_set_line_cap(cairo_, shape.round ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
    path(shape.points);
    if (shape.closed) cairo_close_path(cairo_);
    source(shape.color, shape.color.a / 255.0);
    cairo_set_line_width(cairo_, shape.width);
    cairo_stroke(cairo_);
  }

  void operator()(const RoundedRectangle& shape) {
    constexpr double right_angle = 1.5707963267948966;
    const auto& [area, radius, color] = shape;
    const double r = radius;
    const double left = area.x + r;
    const double right = area.x + area.width - r;
    const double top = area.y + r;
    const double low = area.y + area.height - r;
    cairo_new_sub_path(cairo_);
    cairo_arc(cairo_, right, top, r, -right_angle, 0);
    cairo_arc(cairo_, right, low, r, 0, right_angle);
    cairo_arc(cairo_, left, low, r, right_angle, 2 * right_angle);
    cairo_arc(cairo_, left, top, r, 2 * right_angle, 3 * right_angle);
    cairo_close_path(cairo_);
    fill(color, color.a / 255.0);
  }

  void operator()(const Band& shape) {
    path(shape.points);
    fill(shape.color, shape.color.a / 255.0);
  }

  void text(const Text& text, Typesetter& typesetter) {
    cairo_reset_clip(cairo_);
    cairo_set_font_face(cairo_, font_face(text.bold));
    cairo_set_font_size(cairo_, text.size);
    double x = text.at.x;
    if (text.align != Align::left) {
      const double width = typesetter.width(text.text, text.size, text.bold);
      x -= text.align == Align::centre ? width / 2 : width;
    }
    source(text.color, text.color.a / 255.0);
    cairo_move_to(cairo_, x, text.at.y);
    cairo_show_text(cairo_, text.text.c_str());
  }

 private:
  void path(const std::vector<Point>& points) {
    for (const Point& p : points) cairo_line_to(cairo_, p.x, p.y);
  }
  void rectangle(const Rect& area) {
    cairo_rectangle(cairo_, area.x, area.y, area.width, area.height);
  }
  void source(Color color, double alpha) {
    cairo_set_source_rgba(cairo_, color.r / 255.0, color.g / 255.0, color.b / 255.0, alpha);
  }
  void fill(Color color, double alpha) {
    source(color, alpha);
    cairo_fill(cairo_);
  }

  cairo_t* cairo_;
  Borders borders_;
};

void check(const cairo_surface_t* surface, const char* what) {
  if (const cairo_status_t status = cairo_surface_status(const_cast<cairo_surface_t*>(surface));
      status != CAIRO_STATUS_SUCCESS)
    throw error(Failure::work, "cairo cannot make {}: {}", what, cairo_status_to_string(status));
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data),  // NOLINT: bytes
                                           length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string encode_pdf(const Drawing& drawing, const std::string& title, Typesetter& typesetter) {
  std::string bytes;
  const Surface surface(
      cairo_pdf_surface_create_for_stream(append, &bytes, drawing.size().width * points_a_pixel,
                                          drawing.size().height * points_a_pixel));
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, title.c_str());
  // No clock: the same drawing gives the same bytes.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                 "2000-01-01T00:00:00Z");
  {
    const Context context(cairo_create(surface.get()));
    cairo_scale(context.get(), points_a_pixel, points_a_pixel);
    Page page(context.get(), Page::Borders::smooth);
    page.shapes(drawing);
    for (const Text& text : drawing.texts()) page.text(text, typesetter);
    cairo_show_page(context.get());
  }
  cairo_surface_finish(surface.get());
  check(surface.get(), "a PDF");
  return bytes;
}

void rasterise(const Drawing& drawing, PixelTarget target) {
  const auto [width, height] = drawing.size();
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  check(surface.get(), "a picture");
  {
    const Context context(cairo_create(surface.get()));
    Page(context.get(), Page::Borders::sharp).shapes(drawing);
  }
  cairo_surface_flush(surface.get());
  const unsigned char* const rows = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  std::size_t at = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::uint32_t pixel = 0;  // cairo's own order: 0x00RRGGBB
      std::memcpy(&pixel, rows + static_cast<std::ptrdiff_t>(y) * stride + 4 * x, sizeof pixel);
      for (const unsigned shift : {16U, 8U, 0U})
        target.rgba[at++] = static_cast<std::uint8_t>(pixel >> shift);
      target.rgba[at++] = 255;
    }
  Typesetter typesetter;
  for (const Text& text : drawing.texts()) typesetter.draw(text, target);
}

}  // namespace evo::render
