// What the C++ library of emscripten 3.1.6 (Debian 12) has not yet: included before every
// file of the WebAssembly build, and of no other.
#pragma once

#include <charconv>
#include <cstdlib>
#include <string>
#include <system_error>
#include <type_traits>

// NOLINTBEGIN(cert-dcl58-cpp): declared as the standard has them, until the library does.
namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From) && is_trivially_copyable_v<From>);
  return __builtin_bit_cast(To, from);
}

// Decimal numbers; musl's strtod rounds correctly, as GCC's from_chars does.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const auto digits = [last](const char* at) {
    while (at != last && *at >= '0' && *at <= '9') ++at;
    return at;
  };
  const char* whole = first != last && *first == '-' ? first + 1 : first;
  const char* end = digits(whole);
  bool some = end != whole;
  if (end != last && *end == '.') {
    const char* part = digits(end + 1);
    some = some || part != end + 1;
    if (some) end = part;
  }
  if (!some) return {first, errc::invalid_argument};
  if (end != last && (*end == 'e' || *end == 'E')) {
    const char* power = end + 1 != last && (end[1] == '-' || end[1] == '+') ? end + 2 : end + 1;
    if (digits(power) != power) end = digits(power);
  }
  const double read = strtod(string(first, end).c_str(), nullptr);
  if (read - read != 0.0) return {end, errc::result_out_of_range};
  value = read;
  return {end, errc{}};
}

}  // namespace std
// NOLINTEND(cert-dcl58-cpp)
