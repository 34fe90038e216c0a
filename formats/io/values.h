// Values as people write them in options and settings. What parses one throws
// Error(usage), which names the option, what was found and what is expected.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evo {

// "512000", "512k", "3M", "5e5": a whole number, or nothing.
std::optional<std::int64_t> whole_number(std::string_view text);
// The same within the range.
std::int64_t parse_whole(const std::string& text, const std::string& option, std::int64_t low,
                         std::int64_t high);
std::uint64_t parse_unsigned(const std::string& text, const std::string& option);

// A finite number, with k and M as above; nothing for another text.
std::optional<double> number_of_text(std::string_view text);
double parse_number(const std::string& text, const std::string& option);

// "0.6,0.2,..."; at least one number.
std::vector<double> parse_numbers(const std::string& text, const std::string& option);
// "5,10,20" within the range; at least one.
std::vector<int> parse_wholes(const std::string& text, const std::string& option, int low,
                              int high);

// "1280x720" as two whole numbers from 1 to `most`; `form` says what is meant.
std::pair<int, int> parse_pair(const std::string& text, const std::string& option, int most,
                               const std::string& form);

// "5x7" as rows and columns of a body.
struct Shape {
  int rows = 0;
  int cols = 0;
};
Shape parse_shape(const std::string& text);

// "1 234 567"
std::string grouped(long long number);

// Splits at the separator, empty pieces dropped.
std::vector<std::string> split_list(const std::string& text, char separator = ',');

}  // namespace evo
