// HDF5 files as the other formats need them: arrays of numbers, strings, groups
// and attributes, named by path ("/episode_0/infos/positions"; groups on the way
// are made as needed). The C library stays inside hdf5.cpp.
//
// Files are a function of what is written: no time stamps, fixed layout. Strings
// are variable-length UTF-8, which h5py reads as `str`.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/files.h"

namespace evo::hdf5 {

using Shape = std::vector<std::size_t>;  // empty: a scalar

// A length that a reader leaves open.
inline constexpr std::size_t any = static_cast<std::size_t>(-1);

template <typename T>
struct Array {
  Shape shape;
  std::vector<T> values;  // row-major
};

// The numbers that can be stored. Readers convert between them.
template <typename T>
concept Number = std::same_as<T, double> || std::same_as<T, float> ||
    std::same_as<T, std::uint8_t> || std::same_as<T, std::int32_t> ||
    std::same_as<T, std::int64_t> || std::same_as<T, std::uint64_t>;

// Writes a new file that appears under its name with commit(), or not at all.
// All functions throw Error(io); the constructor Error(cannot_create).
class Writer {
 public:
  explicit Writer(const std::filesystem::path& path);
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void group(const std::string& path);

  // Chunked along the first dimension, shuffled, deflate level 1. `values` has
  // the product of `shape` elements.
  template <Number T>
  void array(const std::string& path, const Shape& shape, const std::vector<T>& values);
  template <Number T>
  void vector(const std::string& path, const std::vector<T>& values) {
    array(path, {values.size()}, values);
  }
  // h5py's bool (an enumeration of FALSE and TRUE), as Minari has it.
  void flags(const std::string& path, const std::vector<std::uint8_t>& values);
  void strings(const std::string& path, const std::vector<std::string>& values);

  // Attributes of the group or dataset `object` ("/" for the file).
  void attribute(const std::string& object, const std::string& name, const std::string& value);
  void attribute(const std::string& object, const std::string& name, const char* value);
  template <Number T>
  void attribute(const std::string& object, const std::string& name, T value);
  template <Number T>
  void attribute(const std::string& object, const std::string& name, const std::vector<T>& values);

  // The file ends with a checksum of its bytes.
  void commit(Existing existing = Existing::replaced);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

// Reads a file. The constructor throws Error(no_input) or, for something that is no HDF5
// file, damaged, or other bytes than its checksum says, Error(data); the others Error(data) with
// file and path.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path);
  // The bytes of a file, called `name`.
  Reader(std::string_view bytes, const std::string& name);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  const std::string& name() const;  // of the file, for messages

  bool exists(const std::string& path) const;
  std::vector<std::string> children(const std::string& group) const;  // by name
  Shape shape(const std::string& path) const;
  bool is_single(const std::string& path) const;  // whether a dataset is of float32

  template <Number T>
  Array<T> array(const std::string& path) const;
  // One of this shape, or Error(data) that says both.
  template <Number T>
  Array<T> array(const std::string& path, const Shape& expected) const;
  // One-dimensional, of any length or of `length`.
  template <Number T>
  std::vector<T> vector(const std::string& path, std::size_t length = any) const {
    return array<T>(path, {length}).values;
  }
  std::vector<std::string> strings(const std::string& path) const;

  // What the file says that it is; empty where it does not.
  std::string format() const;
  bool has_attribute(const std::string& object, const std::string& name) const;
  std::string text(const std::string& object, const std::string& name) const;
  template <Number T>
  T number(const std::string& object, const std::string& name) const;
  template <Number T>
  std::vector<T> numbers(const std::string& object, const std::string& name) const;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

// Whether bytes begin like an HDF5 file.
bool begins_as_hdf5(std::string_view bytes);

// How many bytes a file that begins so has at most. Throws Error(data) with `where` for a
// beginning that does not say.
std::size_t stated_size(std::string_view beginning, const std::string& where);

// Whether this is a file, no pipe or device, and begins like an HDF5 file.
bool is_hdf5(const std::filesystem::path& path);

}  // namespace evo::hdf5
