// The state of a training: named arrays, which formats/training/policy.h writes as one HDF5 data
// set each, and the best controller so far, as in a policy. It is what a training needs to
// continue to the same bytes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

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

  void put(const std::string& name, const Stream& stream) {
    const Stream::Position position = stream.tell();
    put<std::uint64_t>(name, {position.block, position.used});
  }

  void get(const std::string& name, Stream& stream) const {
    const auto& values = get<std::uint64_t>(name, 2);
    if (values[1] > 4) throw error(Failure::data, "checkpoint: '{}' is no position", name);
    stream.seek({values[0], static_cast<std::uint32_t>(values[1])});
  }

  // Another checkpoint as a part of this one, "<name>/...", and back.
  void put(const std::string& name, const Checkpoint& part) {
    const std::string prefix = name + "/";
    for (const auto& [inner, array] : part.arrays)
      arrays[std::string(prefix).append(inner)] = array;
  }
  Checkpoint part(const std::string& name) const {
    const std::string prefix = name + "/";
    Checkpoint part;
    for (auto it = arrays.lower_bound(prefix);
         it != arrays.end() && it->first.compare(0, prefix.size(), prefix) == 0; ++it)
      part.arrays[it->first.substr(prefix.size())] = it->second;
    return part;
  }
  bool has(const std::string& name) const { return arrays.count(name) != 0; }

  bool operator==(const Checkpoint&) const = default;
};

}  // namespace evo
