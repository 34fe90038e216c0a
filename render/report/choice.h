// Which robots of a run a page shows one by one. In a run of a thousand that is all of
// them; a page about a hundred thousand would be more than a browser bears.
#pragma once

#include <algorithm>
#include <cstddef>
#include <set>
#include <vector>

#include "render/report/run.h"

namespace evo::report {

// At most so many of a list, evenly, the first and the last among them.
template <typename T>
std::vector<T> spread(const std::vector<T>& list, std::size_t most) {
  if (list.size() <= most) return list;
  std::vector<T> chosen;
  for (std::size_t k = 0; k < most; ++k)
    chosen.push_back(list[k * (list.size() - 1) / std::max<std::size_t>(1, most - 1)]);
  return chosen;
}

// The fittest first, failed ones last, each in the order they were trained.
std::vector<std::size_t> ranked(const Run& run);

inline constexpr std::size_t sheet_rows = 4;  // best robots of a generation

// A column of the sheet "Evolution": a generation and the best of its robots.
struct SheetColumn {
  const Generation* generation = nullptr;
  std::vector<std::size_t> best;  // in its `members`
};
// All generations begun, or as many as fit, evenly chosen, the first and the last among
// them.
std::vector<SheetColumn> sheet(const Run& run);

// Those with a card, a row in the table and a point in charts, in the order of training:
// all, or of more than `most` a choice. Half of `most` are the fittest, half evenly
// spread over the run. Beside them are what other parts of the page point to: the
// champion and its ancestors, robots that were the best of the run when they came, and
// those of the sheet.
std::vector<std::size_t> shown_one_by_one(const Run& run, std::size_t most);

// Those that are looked at first: the champion, the `most` fittest, and ancestors of the
// champion, evenly chosen of a long line.
std::set<std::size_t> looked_at_first(const Run& run, std::size_t most);

}  // namespace evo::report
