#include "libevo/base/error.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace evo {
namespace {

std::string lower(const std::string& word) {
  std::string folded = word;
  std::transform(folded.begin(), folded.end(), folded.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return folded;
}

// Optimal string alignment distance: insertions, deletions, substitutions and
// swaps of neighbours, the four slips of a typing hand.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t cost = a[i - 1] == b[j - 1] ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + cost});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& candidates) {
  constexpr std::size_t shortest_beginning = 3;
  const std::string folded = lower(word);
  // Two slips leave nothing of a word as short as "top".
  const std::size_t slips = folded.size() <= 3 ? 1 : std::max<std::size_t>(2, folded.size() / 3);
  std::string best;
  std::size_t best_distance = slips + 1;
  for (const std::string& candidate : candidates) {
    const std::string whole = lower(candidate);
    std::size_t d = distance(folded, whole);
    if (folded.size() >= shortest_beginning && whole.starts_with(folded))
      d = std::min<std::size_t>(d, 1);
    if (d < best_distance) {
      best_distance = d;
      best = candidate;
    }
  }
  return best;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string best = nearest(word, candidates);
  return best.empty() ? "" : " (did you mean '" + best + "'?)";
}

}  // namespace evo
