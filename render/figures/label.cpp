#include "render/figures/label.h"

#include <algorithm>

namespace evo::render {
namespace {

struct Word {
  std::string text;
  Color color;
  bool bold = false;
};

// A plate with words on it, all in one line.
class Plate {
 public:
  Plate(std::vector<Word> words, float size, Typesetter& typesetter)
      : words_(std::move(words)), size_(size) {
    for (const Word& word : words_) {
      widths_.push_back(typesetter.width(word.text, size, word.bold));
      width_ += widths_.back();
    }
    width_ += gap() * static_cast<float>(words_.size() - 1) + 2 * padding();
  }
  float width() const { return width_; }
  float height() const { return 1.9F * size_; }

  void draw(float x, float y, Color background, Drawing& drawing) const {
    drawing.rounded_rectangle({x, y, width_, height()}, 0.5F * size_, background);
    float pen = x + padding();
    const float baseline = y + (height() + cap_height * size_) / 2;
    for (std::size_t k = 0; k < words_.size(); ++k) {
      drawing.text({pen, baseline}, size_, words_[k].text, words_[k].color, Align::left,
                   words_[k].bold);
      pen += widths_[k] + gap();
    }
  }

 private:
  float padding() const { return 0.75F * size_; }
  float gap() const { return 0.6F * size_; }

  std::vector<Word> words_;
  std::vector<float> widths_;
  float size_;
  float width_ = 0;
};

}  // namespace

float key_size(const Rect& panel) {
  constexpr float least = 8.0F;  // pixels; smaller text cannot be read
  return std::max(least, label_size(panel));
}

float caption_height(const Rect& panel, int rows) {
  return (0.8F + row_of_labels * static_cast<float>(rows)) * key_size(panel);
}

void draw_caption(const Caption& caption, const Theme& theme, const Rect& panel,
                  Typesetter& typesetter, Drawing& drawing) {
  const float size = key_size(panel);
  const float margin = 0.8F * size;
  if (panel.height < 6 * size) return;
  float left = panel.x + margin;
  float right = panel.x + panel.width - margin;
  float y = panel.y + margin;
  const auto put = [&](std::vector<Word> words, bool on_right) {
    std::erase_if(words, [](const Word& word) { return word.text.empty(); });
    if (words.empty()) return;
    const Plate plate(words, size, typesetter);
    if (plate.width() > right - left) return;
    if (on_right) right -= plate.width();
    plate.draw(on_right ? right : left, y, theme.label, drawing);
    if (on_right)
      right -= 0.5F * size;
    else
      left += plate.width() + 0.5F * size;
  };
  put({{caption.score, theme.text, true}}, true);
  const float both = typesetter.width(caption.title + caption.detail, size, true) + 4 * size;
  if (both < right - left)
    put({{caption.title, theme.text, true}, {caption.detail, theme.text_muted, false}}, false);
  else
    put({{caption.brief, theme.text, true}}, false);
  put({{caption.moment, theme.text, false}}, true);
  left = panel.x + margin;
  right = panel.x + panel.width - margin;
  y += row_of_labels * size;
  put({{caption.ending, theme.text, true}}, true);
  put({{caption.goal, theme.text, false}}, false);
}

}  // namespace evo::render
