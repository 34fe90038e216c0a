#include "cli/pick.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "formats/io/values.h"

namespace evo::cli {

std::vector<Robot> pick(std::vector<Robot> robots, const std::optional<std::string>& places) {
  if (!places) return robots;
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  const std::size_t dash = places->find('-');
  const std::int64_t first = parse_whole(places->substr(0, dash), "--pick", 0, most);
  std::int64_t last = first;
  if (dash != std::string::npos)
    last = dash + 1 == places->size()
               ? most
               : parse_whole(places->substr(dash + 1), "--pick", first, most);
  const auto count = static_cast<std::int64_t>(robots.size());
  const auto begin = robots.begin() + std::min(first, count);
  const auto end = last >= count ? robots.end() : robots.begin() + last + 1;
  return {std::make_move_iterator(begin), std::make_move_iterator(end)};
}

}  // namespace evo::cli
