#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/io/text.h"
#include "render/painters/vector.h"

namespace evo::render {

std::string hex(Color color) {
  return fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b);
}

namespace {

// ---- pieces of text ---------------------------------------------------------------------

// Hundredths of a pixel, nothing that says nothing: "12.5", "-.25".
std::string hundredths(double value) {
  const double rounded = std::round(value * 100) / 100;
  std::string text = fmt::format("{}", rounded == 0 ? 0.0 : rounded);
  if (const auto zero = text.find("0."); zero != std::string::npos && text.size() > 2)
    if (zero == 0 || (zero == 1 && text[0] == '-')) text.erase(zero, 1);
  return text;
}

// With a space before it unless its sign parts it from what is there.
void append(std::string& path, double value) {
  const std::string text = hundredths(value);
  const bool parted = path.empty() || path.back() < '.' || path.back() > '9' || text[0] == '-';
  if (!parted) path += ' ';
  path += text;
}
void append(std::string& path, Point p) {
  append(path, p.x);
  append(path, p.y);
}

double signed_area(const std::vector<Point>& points) {
  double sum = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point a = points[k];
    const Point b = points[(k + 1) % points.size()];
    sum += static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y;
  }
  return sum;
}

// ---- the document ---------------------------------------------------------------------------

// Shapes painted alike, one after the other, become one path: cells of a colour
// that share a border leave no hairline between them, and the file stays small.
class Document {
 public:
  explicit Document(const PageStyle* style) : page_(style) {}

  void clip(const Rect& area, const Rect& whole) {
    if (open_ && area == clip_) return;
    flush();
    if (open_ && grouped_) body_ += "</g>\n";
    open_ = true;
    clip_ = area;
    grouped_ = area != whole;
    if (grouped_) body_ += fmt::format("<g clip-path=\"url(#{})\">\n", clip_name(area));
  }

  void operator()(const Polygon& shape) {
    Polygon same = shape;  // all turn the same way, so that none cuts a hole into another
    if (signed_area(shape.points) < 0) std::ranges::reverse(same.points);
    same.color.a = 255;
    start(paint("fill", same.color));
    lines_path(same.points);
    path_ += 'z';
  }

  void operator()(const Gradient& shape) {
    const auto [area, top, bottom] = shape;
    if (area.width <= 0 || area.height <= 0) return;
    Color flat = top;
    flat.a = 255;
    const std::string fill = top == bottom
                                 ? paint("fill", flat)
                                 : fmt::format("fill=\"url(#{})\"", gradient_name(top, bottom));
    start(fill);
    rectangle_path(area);
  }

  void operator()(const Stroke& shape) {
    start(fmt::format("fill=\"none\" {} stroke-width=\"{}\"{}", paint("stroke", shape.color),
                      hundredths(shape.width), shape.round ? " stroke-linecap=\"round\"" : ""));
    const bool dot = shape.round && shape.points.front() == shape.points.back();
    lines_path(std::span(shape.points).first(dot ? 1 : shape.points.size()));
    if (dot) path_ += "h0";
    if (shape.closed) path_ += 'z';
  }

  void operator()(const RoundedRectangle& shape) {
    flush();
    const Rect& area = shape.area;
    body_ +=
        fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\" {}/>\n",
                    hundredths(area.x), hundredths(area.y), hundredths(area.width),
                    hundredths(area.height), hundredths(shape.radius), paint("fill", shape.color));
  }

  void operator()(const Band& shape) {
    start(paint("fill", shape.color));
    path_ += 'M';
    for (const Point p : shape.points) append(path_, p);
    path_ += 'z';
  }

  void text(const Text& text, Typesetter& typesetter) {
    if (text.text.empty()) return;
    const char* anchor = text.align == Align::left     ? ""
                         : text.align == Align::centre ? " text-anchor=\"middle\""
                                                       : " text-anchor=\"end\"";
    const std::string length =
        page_ != nullptr
            ? ""
            : fmt::format(" textLength=\"{}\"",
                          hundredths(typesetter.width(text.text, text.size, text.bold)));
    texts_ += fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\"{}{}{} {}>{}</text>\n",
                          hundredths(text.at.x), hundredths(text.at.y), hundredths(text.size),
                          anchor, text.bold ? " font-weight=\"bold\"" : "", length,
                          paint("fill", text.color), escaped(text.text));
  }

  std::string finish(Size size, const std::string& title) {
    flush();
    if (open_ && grouped_) body_ += "</g>\n";
    if (page_ != nullptr)
      return fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n{}{}</svg>\n",
                         size.width, size.height, escaped(title), body_, texts_);
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
        "viewBox=\"0 0 {0} {1}\" role=\"img\">\n<title>{2}</title>\n<defs>\n{3}</defs>\n"
        "<g stroke-miterlimit=\"2\">\n{4}</g>\n"
        "<g font-family=\"DejaVu Sans, Verdana, sans-serif\" xml:space=\"preserve\">\n{5}</g>\n"
        "</svg>\n",
        size.width, size.height, escaped(title), definitions_, body_, texts_);
  }

 private:
  std::string paint(const char* what, Color color) const {
    std::string name = hex(color);
    if (page_ != nullptr)
      if (const auto known = page_->find(name); known != page_->end()) name = known->second;
    std::string text = fmt::format("{}=\"{}\"", what, name);
    if (color.a != 255)
      text += fmt::format(" {}-opacity=\"{}\"", what, hundredths(color.a / 255.0));
    return text;
  }
  void start(const std::string& style) {
    if (style == style_) return;
    flush();
    style_ = style;
  }
  void flush() {
    if (!path_.empty()) body_ += fmt::format("<path {} d=\"{}\"/>\n", style_, path_);
    path_.clear();
    style_.clear();
  }
  void lines_path(std::span<const Point> points) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      path_ += k == 0 ? 'M' : 'L';
      append(path_, points[k]);
    }
  }
  void rectangle_path(const Rect& area) {
    path_ += 'M';
    append(path_, Point{area.x, area.y});
    path_ += 'h';
    append(path_, area.width);
    path_ += 'v';
    append(path_, area.height);
    path_ += 'h';
    append(path_, -area.width);
    path_ += 'z';
  }

  std::string clip_name(const Rect& area) {
    const std::string shape =
        fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>", hundredths(area.x),
                    hundredths(area.y), hundredths(area.width), hundredths(area.height));
    return define("c", "<clipPath id=\"{}\">" + shape + "</clipPath>\n");
  }
  std::string gradient_name(Color top, Color bottom) {
    return define("g", "<linearGradient id=\"{}\" x2=\"0\" y2=\"1\"><stop stop-color=\"" +
                           hex(top) + "\"/><stop offset=\"1\" stop-color=\"" + hex(bottom) +
                           "\"/></linearGradient>\n");
  }
  // The name of what is defined as `element`, in which {} stands for the name.
  std::string define(const char* kind, const std::string& element) {
    const auto [known, fresh] =
        names_.emplace(element, fmt::format("{}{}", kind, names_.size() + 1));
    if (fresh) {
      std::string named = element;
      definitions_ += named.replace(named.find("{}"), 2, known->second);
    }
    return known->second;
  }

  const PageStyle* page_;
  std::string definitions_, body_, texts_;
  std::map<std::string, std::string> names_;  // of definitions
  std::string style_, path_;                  // of the path under way
  Rect clip_;
  bool open_ = false;
  bool grouped_ = false;
};

}  // namespace

std::string encode_svg(const Drawing& drawing, const std::string& title, Typesetter& typesetter,
                       const PageStyle* style) {
  Document document(style);
  for (const Drawing::Item& item : drawing.items()) {
    document.clip(item.clip, drawing.whole());
    std::visit(document, item.shape);
  }
  for (const Text& text : drawing.texts()) document.text(text, typesetter);
  return document.finish(drawing.size(), title);
}

}  // namespace evo::render
