#include "formats/io/json_object.h"

#include <cmath>
#include <cstdint>

namespace evo {

JsonObject::JsonObject(const Json& object, std::string path)
    : object_(object), path_(std::move(path)) {
  if (!object.is_object()) throw refusal(path_, "expected a JSON object, found {}", shown(object));
}

const Json& JsonObject::at(const std::string& key) const {
  const auto found = object_.find(key);
  if (found == object_.end()) throw refusal(path_of(key), "is missing");
  return *found;
}

int JsonObject::integer(const std::string& key, int low, int high) const {
  return json_integer(at(key), path_of(key), low, high);
}

double JsonObject::number(const std::string& key) const {
  return json_number(at(key), path_of(key));
}

bool JsonObject::boolean(const std::string& key) const {
  const Json& value = at(key);
  if (!value.is_boolean())
    throw refusal(path_of(key), "expected true or false, found {}", shown(value));
  return value.get<bool>();
}

const std::string& JsonObject::text(const std::string& key) const {
  const Json& value = at(key);
  if (!value.is_string()) throw refusal(path_of(key), "expected text, found {}", shown(value));
  return value.get_ref<const std::string&>();
}

const Json& JsonObject::array(const std::string& key) const {
  const Json& value = at(key);
  if (!value.is_array()) throw refusal(path_of(key), "expected an array, found {}", shown(value));
  return value;
}

int json_integer(const Json& value, const std::string& path, int low, int high) {
  // Compared as JSON numbers: what does not fit an int is out of range, too.
  if (!value.is_number_integer() || value < low || value > high)
    throw refusal(path, "expected a whole number from {} to {}, found {}", low, high, shown(value));
  return value.get<int>();
}

double json_number(const Json& value, const std::string& path) {
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    throw refusal(path, "expected a number, found {}", shown(value));
  return value.get<double>();
}

}  // namespace evo
