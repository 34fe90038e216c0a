// The bytes of a state, written or read: what it consists of is said once, for both. Writing
// leaves it as it is. Numbers are as this build lays them out, lengths have 64 bits.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "libevo/base/error.h"

namespace evo {

class Bytes {
 public:
  Bytes() = default;  // to be written
  // To be read. Bytes that do not fit are refused: Error(data) of these words.
  Bytes(std::span<const std::uint8_t> from, std::string refusal)
      : reads_(true), rest_(from), refusal_(std::move(refusal)) {}

  bool reads() const { return reads_; }
  [[noreturn]] void refuse() const { throw Error(Failure::data, refusal_); }
  // All has been read.
  void finish() const {
    if (!rest_.empty()) refuse();
  }
  std::vector<std::uint8_t> take() { return std::move(written_); }

  // Numbers, texts, vectors of numbers, maps, and whatever has a pass(Bytes&) of its own.
  template <typename... T>
  void operator()(T&... each) {
    (one(each), ...);
  }

  // A range of numbers, or of points, of the length that it has.
  template <typename Range>
  void known(Range&& values) {
    std::uint64_t length = values.size();
    one(length);
    if (length != values.size()) refuse();
    raw(std::span(values));
  }

 private:
  template <typename T>
  void raw(std::span<T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    auto* bytes = reinterpret_cast<std::uint8_t*>(values.data());
    const std::size_t length = values.size_bytes();
    if (!reads_) {
      written_.resize(written_.size() + length);
      std::copy_n(bytes, length, written_.end() - static_cast<std::ptrdiff_t>(length));
      return;
    }
    if (length > rest_.size()) refuse();
    std::copy_n(rest_.begin(), length, bytes);
    rest_ = rest_.subspan(length);
  }

  template <typename T>
  void one(T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      raw(std::span(&value, 1));
    } else if constexpr (requires { value.data(); }) {
      std::uint64_t length = value.size();
      one(length);
      if (reads_ && length > rest_.size() / sizeof(*value.data())) refuse();
      value.resize(static_cast<std::size_t>(length));
      raw(std::span(value));
    } else {
      value.pass(*this);
    }
  }
  void one(bool& value) {
    std::uint8_t byte = value ? 1 : 0;
    one(byte);
    value = byte != 0;
  }
  template <typename Key, typename Value>
  void one(std::map<Key, Value>& values) {
    std::uint64_t length = values.size();
    one(length);
    if (reads_) {
      values.clear();
      for (; length > 0; --length) {
        Key key{};
        one(key);
        one(values[key]);
      }
    } else {
      for (auto& [key, value] : values) {
        Key same = key;
        (*this)(same, value);
      }
    }
  }

  bool reads_ = false;
  std::span<const std::uint8_t> rest_;  // to be read
  std::string refusal_;
  std::vector<std::uint8_t> written_;
};

}  // namespace evo
