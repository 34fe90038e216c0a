// The state of a training: named arrays, which formats/training/policy.h writes as one HDF5 data
// set each, and the best controller so far, as in a policy. It is what a training needs to
// continue to the same bytes.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "libevo/base/bytes.h"
#include "libevo/base/error.h"
#include "libevo/base/random.h"
#include "libevo/control/controller.h"

namespace evo {

struct Checkpoint {
  using Array = std::variant<std::vector<double>, std::vector<float>, std::vector<std::uint64_t>,
                             std::vector<std::uint8_t>>;
  std::map<std::string, Array> arrays;
  std::optional<TrainedController> best;

  template <typename T>
  void put(const std::string& name, std::vector<T> values) {
    arrays[name] = std::move(values);
  }

  // Throws Error(data) where the array is missing or of another type.
  template <typename T>
  const std::vector<T>& get(const std::string& name) const {
    const auto found = arrays.find(name);
    if (found == arrays.end()) throw error(Failure::data, "checkpoint: no array '{}'", name);
    const auto* values = std::get_if<std::vector<T>>(&found->second);
    if (values == nullptr)
      throw error(Failure::data, "checkpoint: '{}' holds values of another type", name);
    return *values;
  }

  // As above, of a known length.
  template <typename T>
  const std::vector<T>& get(const std::string& name, std::size_t length) const {
    const std::vector<T>& values = get<T>(name);
    if (values.size() != length)
      throw error(Failure::data, "checkpoint: '{}' has {} values, {} expected", name, values.size(),
                  length);
    return values;
  }

  bool operator==(const Checkpoint&) const = default;
};

// A checkpoint that is written or read: what a class keeps there its serialize() says once, for
// both. Saving leaves the values as they are. Loading throws Error(data) where an array is missing,
// of another type or of another length.
class Archive {
 public:
  static Archive saving(Checkpoint& to) { return {&to, to, ""}; }
  static Archive loading(const Checkpoint& from) { return {nullptr, from, ""}; }

  bool loads() const { return to_ == nullptr; }
  // Of names that begin with "<name>/".
  Archive part(const std::string& name) const { return {to_, *from_, prefix_ + name + "/"}; }
  // Whether an array is there that is not always: `present` when saving.
  bool optional(const std::string& name, bool present) const {
    return loads() ? from_->arrays.count(prefix_ + name) != 0 : present;
  }

  // Of any length.
  template <typename T>
  void array(const std::string& name, std::vector<T>& values) const {
    if (loads())
      values = from_->get<T>(prefix_ + name);
    else
      to_->put(prefix_ + name, values);
  }

  // A range of the length that it has.
  template <typename Stored, typename Range>
  void row(const std::string& name, Range&& values) const {
    const auto length = static_cast<std::size_t>(values.size());
    if (loads()) {
      auto next = from_->get<Stored>(prefix_ + name, length).begin();
      for (auto& value : values) value = static_cast<std::decay_t<decltype(value)>>(*next++);
    } else {
      std::vector<Stored> stored;
      stored.reserve(length);
      for (const auto& value : values) stored.push_back(static_cast<Stored>(value));
      to_->put(prefix_ + name, std::move(stored));
    }
  }

  template <typename Stored, typename... Numbers>
  void numbers(const std::string& name, Numbers&... each) const {
    std::array<Stored, sizeof...(each)> values{static_cast<Stored>(each)...};
    row<Stored>(name, values);
    auto next = values.begin();
    ((each = static_cast<Numbers>(*next++)), ...);
  }

  // Parameters as runs of floats, one after the other.
  template <typename Blocks>
  void blocks(const std::string& name, const Blocks& parameters) const {
    std::vector<float> values;
    for (std::size_t b = 0; b < parameters.size(); ++b)
      values.insert(values.end(), parameters[b].begin(), parameters[b].end());
    row<float>(name, values);
    auto next = values.begin();
    for (std::size_t b = 0; b < parameters.size(); ++b) {
      const std::span<float> block = parameters[b];
      std::copy_n(next, block.size(), block.begin());
      next += std::ssize(block);
    }
  }

  // What bytes.h can pass.
  template <typename T>
  void bytes(const std::string& name, T& value) const {
    Bytes out;
    if (!loads()) out(value);
    std::vector<std::uint8_t> stored = out.take();
    array(name, stored);
    if (!loads()) return;
    Bytes in(stored, fmt::format("checkpoint: '{}' is damaged", prefix_ + name));
    in(value);
    in.finish();
  }

  void stream(const std::string& name, Stream& stream) const {
    Stream::Position position = stream.tell();
    numbers<std::uint64_t>(name, position.block, position.used);
    if (position.used > 4) throw error(Failure::data, "checkpoint: '{}' is no position", name);
    stream.seek(position);
  }

  void best(std::optional<TrainedController>& controller) const {
    if (loads())
      controller = from_->best;
    else
      to_->best = controller;
  }

 private:
  Archive(Checkpoint* to, const Checkpoint& from, std::string prefix)
      : to_(to), from_(&from), prefix_(std::move(prefix)) {}

  Checkpoint* to_;  // none: it loads
  const Checkpoint* from_;
  std::string prefix_;  // of all names
};

}  // namespace evo
