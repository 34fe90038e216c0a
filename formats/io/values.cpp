#include "formats/io/values.h"

#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "formats/io/number.h"
#include "formats/io/text.h"
#include "libevo/base/error.h"
#include "libevo/body/body.h"

namespace evo {
namespace {

// Thousands and millions, and numbers such as 5e5; exact or nothing.
template <typename Whole>
std::optional<Whole> whole_of(std::string_view text) {
  Whole unit = 1;
  if (text.ends_with('k')) unit = 1'000;
  if (text.ends_with('M')) unit = 1'000'000;
  if (unit != 1) text.remove_suffix(1);
  if (const auto digits = number_in<Whole>(text)) {
    Whole value{};
    if (__builtin_mul_overflow(*digits, unit, &value)) return std::nullopt;
    return value;
  }
  constexpr double largest_exact = 9007199254740992.0;  // 2^53
  const auto real = number_in<double>(text);
  if (!real || *real != std::floor(*real)) return std::nullopt;
  const double value = *real * static_cast<double>(unit);
  if (std::abs(value) > largest_exact) return std::nullopt;
  if (value < static_cast<double>(std::numeric_limits<Whole>::min())) return std::nullopt;
  return static_cast<Whole>(value);
}

// " from 1 to 9"; nothing of bounds that are a type's own and not what is wrong.
template <typename Whole>
std::string bounds(std::string_view text, Whole low, Whole high) {
  const bool is_number = number_in<double>(text).has_value();
  const bool has_low = std::cmp_not_equal(low, std::numeric_limits<int>::min());
  const bool has_high = high != static_cast<Whole>(std::numeric_limits<int>::max()) &&
                        high != std::numeric_limits<Whole>::max();
  if (has_low && (has_high || is_number)) return fmt::format(" from {} to {}", low, high);
  if (has_low && low != 0) return fmt::format(" of at least {}", low);
  return has_high || is_number ? fmt::format(" up to {}", high) : "";
}

// Numbers between commas, at least one.
std::vector<std::string> pieces_of(const std::string& text, const std::string& option) {
  if (text.empty()) throw error(Failure::usage, "{}: '{}' holds no numbers", option, text);
  const std::string list = "," + text + ",";
  if (list.find(",,") != std::string::npos)
    throw error(Failure::usage, "{}: '{}' has a comma without a number", option, text);
  return split_list(text);
}

}  // namespace

std::optional<std::int64_t> whole_number(std::string_view text) {
  return whole_of<std::int64_t>(text);
}

std::int64_t parse_whole(const std::string& text, const std::string& option, std::int64_t low,
                         std::int64_t high) {
  const auto value = whole_of<std::int64_t>(text);
  if (!value || *value < low || *value > high)
    throw error(Failure::usage, "{}: '{}' is not a whole number{}", option, text,
                bounds(text, low, high));
  return *value;
}

std::uint64_t parse_unsigned(const std::string& text, const std::string& option) {
  const auto value = whole_of<std::uint64_t>(text);
  if (!value)
    throw error(Failure::usage, "{}: '{}' is not a whole number{}", option, text,
                bounds<std::uint64_t>(text, 0, std::numeric_limits<std::uint64_t>::max()));
  return *value;
}

std::optional<double> number_of_text(std::string_view text) {
  const double unit = text.ends_with('k') ? 1e3 : text.ends_with('M') ? 1e6 : 1.0;
  if (unit != 1.0) text.remove_suffix(1);
  const auto value = number_in<double>(text);
  if (!value || !std::isfinite(*value * unit)) return std::nullopt;
  return *value * unit;
}

double parse_number(const std::string& text, const std::string& option) {
  const auto value = number_of_text(text);
  if (!value) throw error(Failure::usage, "{}: '{}' is not a number", option, text);
  return *value;
}

std::vector<double> parse_numbers(const std::string& text, const std::string& option) {
  std::vector<double> numbers;
  for (const std::string& piece : pieces_of(text, option))
    numbers.push_back(parse_number(piece, option));
  return numbers;
}

std::vector<int> parse_wholes(const std::string& text, const std::string& option, int low,
                              int high) {
  std::vector<int> numbers;
  for (const std::string& piece : pieces_of(text, option))
    numbers.push_back(static_cast<int>(parse_whole(piece, option, low, high)));
  return numbers;
}

std::pair<int, int> parse_pair(const std::string& text, const std::string& option, int most,
                               const std::string& form) {
  const std::size_t x = std::min(text.find('x'), text.size());
  const auto first = number_in<int>(std::string_view(text).substr(0, x));
  const auto second = number_in<int>(std::string_view(text).substr(std::min(x + 1, text.size())));
  if (!first || !second || *first < 1 || *second < 1 || *first > most || *second > most)
    throw error(Failure::usage, "{}: '{}' is not {}", option, text, form);
  return {*first, *second};
}

Shape parse_shape(const std::string& text) {
  const auto [rows, cols] =
      parse_pair(text, "--shape", static_cast<int>(largest_side),
                 fmt::format("ROWSxCOLS with numbers from 1 to {}, such as 5x5", largest_side));
  return {rows, cols};
}

std::vector<std::string> split_list(const std::string& text, char separator) {
  std::vector<std::string> pieces;
  for (const std::string_view piece : split(text, std::string_view(&separator, 1)))
    if (!piece.empty()) pieces.emplace_back(piece);
  return pieces;
}

std::string grouped(long long number) {
  std::string digits = fmt::format("{}", number < 0 ? -number : number);
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(digits.size()) - 3; i > 0; i -= 3)
    digits.insert(static_cast<std::size_t>(i), " ");
  return number < 0 ? "-" + digits : digits;
}

}  // namespace evo
