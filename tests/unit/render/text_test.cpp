#include "render/painters/text.h"

#include <catch2/catch.hpp>

namespace evo::render {
namespace {

int ink(const Image& image) {
  int count = 0;
  for (std::size_t k = 0; k < image.rgba.size(); k += 4) count += image.rgba[k] < 128 ? 1 : 0;
  return count;
}

Image white(Size size) {
  Image image(size);
  for (auto& byte : image.rgba) byte = 255;
  return image;
}

TEST_CASE("digits and both signs are equally wide, so that numbers stand still") {
  Typesetter typesetter;
  CHECK(typesetter.width("1", 20) == typesetter.width("8", 20));
  CHECK(typesetter.width("\u2007", 20) == typesetter.width("8", 20));  // figure space
  CHECK(typesetter.width("+", 20) == typesetter.width("\u2212", 20));
  CHECK(typesetter.width("robot", 40) == Approx(2 * typesetter.width("robot", 20)).epsilon(0.02));
}

TEST_CASE("shortened text fits and keeps whole letters") {
  Typesetter typesetter;
  const std::string text = "Größe des Roboters";
  CHECK(typesetter.shortened(text, 16, false, 1000) == text);
  for (float most = 5; most < 150; most += 7) {
    const std::string cut = typesetter.shortened(text, 16, false, most);
    CHECK(typesetter.width(cut, 16) <= most);
    CHECK(cut.find("\xC3\xE2") == std::string::npos);  // half an ö before the ellipsis
  }
}

TEST_CASE("text leaves ink where it is put and nothing outside the picture") {
  Typesetter typesetter;
  Image image = white({60, 30});
  typesetter.draw({{5, 22}, 20, "evo", {0, 0, 0}, Align::left, false}, target(image));
  CHECK(ink(image) > 60);
  Image edge = white({60, 30});
  typesetter.draw({{-30, 5}, 60, "evo", {0, 0, 0}, Align::centre, true}, target(edge));
  typesetter.draw({{90, 60}, 60, "evo", {0, 0, 0}, Align::left, true}, target(edge));
  SUCCEED("no access outside (AddressSanitizer)");
}

TEST_CASE("bytes that are no UTF-8 are drawn as replacement characters") {
  Typesetter typesetter;
  const float one = typesetter.width("\uFFFD", 20);
  CHECK(typesetter.width("\xFF", 20) == one);
  CHECK(typesetter.width("\xC3", 20) == one);  // cut off
  CHECK(typesetter.width("\x80", 20) == one);
}

}  // namespace
}  // namespace evo::render
