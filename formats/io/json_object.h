// Typed reads of the fields of a JSON object. What is missing, of the wrong type
// or out of range is thrown as a Refusal that names the path and what was found.
#pragma once

#include <string>

#include "formats/io/json.h"

namespace evo {

class JsonObject {
 public:
  // `path` is where the object stands in its document ("/genome", "" for all).
  JsonObject(const Json& object, std::string path);

  const std::string& path() const { return path_; }
  std::string path_of(const std::string& key) const { return path_ + "/" + key; }

  int integer(const std::string& key, int low, int high) const;
  double number(const std::string& key) const;  // finite
  bool boolean(const std::string& key) const;
  const std::string& text(const std::string& key) const;
  const Json& array(const std::string& key) const;
  const Json& at(const std::string& key) const;  // anything, but there

 private:
  const Json& object_;
  std::string path_;
};

// One value with its path, for the items of arrays.
int json_integer(const Json& value, const std::string& path, int low, int high);
double json_number(const Json& value, const std::string& path);

}  // namespace evo
