#include "formats/io/npz.h"

#include <zip.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "formats/io/files.h"
#include "formats/io/json.h"
#include "formats/io/number.h"
#include "formats/io/text.h"
#include "libevo/base/error.h"

namespace evo {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "NumPy arrays are read in place");

constexpr const char* body_member = "arr_0.npy";
constexpr const char* links_member = "arr_1.npy";

// ---- one NumPy array ------------------------------------------------------------

// NumPy's .npy format: magic, version, length of the header, the header as the
// text of a Python dictionary, the numbers.
constexpr std::string_view npy_magic = "\x93NUMPY";
constexpr std::size_t npy_version_1_prefix = 10;  // magic, version, 16-bit length
constexpr std::size_t npy_alignment = 64;

// What stands after 'key': in the header, up to the comma or brace that ends it.
std::string_view header_value(std::string_view header, const std::string& key) {
  const std::size_t found = header.find("'" + key + "':");
  if (found == std::string_view::npos) return {};
  std::string_view value = header.substr(found + key.size() + 3);
  value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
  const char closing = value.starts_with('(') ? ')' : ',';
  return value.substr(0, value.find(closing));
}

// "(5, 5" and "(3," -> the sizes.
std::optional<std::vector<std::size_t>> sizes_in(std::string_view shape) {
  if (!shape.starts_with('(')) return std::nullopt;
  std::vector<std::size_t> sizes;
  shape.remove_prefix(1);
  while (!shape.empty()) {
    const std::size_t end = std::min(shape.find_first_not_of("0123456789"), shape.size());
    const auto n = number_in<std::size_t>(shape.substr(0, end));
    if (!n) return std::nullopt;
    sizes.push_back(*n);
    shape.remove_prefix(end);
    shape.remove_prefix(std::min(shape.find_first_not_of(", "), shape.size()));
  }
  return sizes;
}

template <typename T>
double number_at(const char* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

struct NumberType {
  std::string_view name;  // without the byte order
  std::size_t size;
  double (*read)(const char*);
};

constexpr NumberType number_types[] = {
    {"f8", 8, number_at<double>},        {"f4", 4, number_at<float>},
    {"i8", 8, number_at<std::int64_t>},  {"i4", 4, number_at<std::int32_t>},
    {"i2", 2, number_at<std::int16_t>},  {"i1", 1, number_at<std::int8_t>},
    {"u8", 8, number_at<std::uint64_t>}, {"u4", 4, number_at<std::uint32_t>},
    {"u2", 2, number_at<std::uint16_t>}, {"u1", 1, number_at<std::uint8_t>},
};

const NumberType& number_type(std::string_view descr) {
  for (const NumberType& type : number_types)
    if (descr.size() == 5 && descr.substr(2, 2) == type.name && (type.size == 1 || descr[1] == '<'))
      return type;
  throw error(Failure::data, "numbers of type {}, expected little-endian integers or reals",
              shown(descr));
}

// The header of an array and where the numbers begin.
std::pair<std::string_view, std::size_t> split_npy(std::string_view npy) {
  if (!npy.starts_with(npy_magic) || npy.size() < npy_version_1_prefix + 2)
    throw Error(Failure::data, "is not a NumPy array");
  const bool short_length = npy[npy_magic.size()] == 1;
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(npy[i]));
  };
  const std::size_t prefix = npy_version_1_prefix + (short_length ? 0 : 2);
  std::size_t length = byte(8) | byte(9) << 8;
  if (!short_length) length |= byte(10) << 16 | byte(11) << 24;
  if (length > npy.size() - prefix)
    throw Error(Failure::data, "the header of the array is cut off");
  return {npy.substr(prefix, length), prefix + length};
}

// What numpy.savez makes of None: one object, whose pickle ends by appending it (opcodes N, a, t)
// to the list of the array's items.
bool is_none(std::string_view npy) {
  const std::string_view header = split_npy(npy).first;
  constexpr std::size_t longest_end = 7;
  return header_value(header, "descr") == "'|O'" && header_value(header, "shape") == "(" &&
         npy.substr(npy.size() - longest_end).find("Nat") != std::string_view::npos;
}

NumpyMatrix parse_npy(std::string_view npy) {
  const auto [header, begin] = split_npy(npy);
  const NumberType& type = number_type(header_value(header, "descr"));
  const auto sizes = sizes_in(header_value(header, "shape"));
  const bool by_columns = header_value(header, "fortran_order") == "True";
  if (!sizes || sizes->empty() || sizes->size() > 2)
    throw Error(Failure::data, "expected an array of two dimensions");
  const auto most = (npy.size() - begin) / type.size;
  NumpyMatrix array;
  array.dimensions = static_cast<int>(sizes->size());
  array.is_single = type.name == "f4";
  array.rows = sizes->size() == 2 ? sizes->front() : 1;
  array.cols = sizes->back();
  if (array.cols != 0 && array.rows > most / array.cols)
    throw error(Failure::data, "{} x {} numbers are announced, there are {}", array.rows,
                array.cols, most);
  const std::size_t count = array.rows * array.cols;
  array.values.resize(count);
  const std::size_t stride = by_columns ? array.rows : array.cols;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t to = by_columns ? i % stride * array.cols + i / stride : i;
    array.values[to] = type.read(npy.data() + begin + i * type.size);
  }
  return array;
}

template <typename T>
std::string npy_of(const std::vector<T>& values, std::size_t rows, std::size_t cols,
                   std::string_view type) {
  std::string header = fmt::format(
      "{{'descr': '<{}', 'fortran_order': False, 'shape': ({}, {}), }}", type, rows, cols);
  const std::size_t used = npy_version_1_prefix + header.size() + 1;
  header.append((npy_alignment - used % npy_alignment) % npy_alignment, ' ').push_back('\n');
  std::string npy(npy_magic);
  npy.append(
      {'\1', '\0', static_cast<char>(header.size() & 0xFF), static_cast<char>(header.size() >> 8)});
  npy += header;
  if (!values.empty())
    npy.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  return npy;
}

// ---- the archive ------------------------------------------------------------------

struct CloseZip {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_file_t* member) const { zip_fclose(member); }
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};
template <typename T>
using Zip = std::unique_ptr<T, CloseZip>;

class ZipError {
 public:
  ZipError() { zip_error_init(&error_); }
  ~ZipError() { zip_error_fini(&error_); }
  ZipError(const ZipError&) = delete;
  ZipError& operator=(const ZipError&) = delete;
  zip_error_t* get() { return &error_; }
  std::string text() { return zip_error_strerror(&error_); }

 private:
  zip_error_t error_{};
};

Zip<zip_t> open_archive(std::string_view bytes) {
  ZipError failed;
  Zip<zip_source_t> source(zip_source_buffer_create(bytes.data(), bytes.size(), 0, failed.get()));
  if (!source) throw Error(Failure::data, failed.text());
  Zip<zip_t> archive(zip_open_from_source(source.get(), ZIP_RDONLY, failed.get()));
  if (!archive) throw error(Failure::data, "not an .npz file (a zip archive): {}", failed.text());
  (void)source.release();  // the archive's now
  return archive;
}

std::string read_member(zip_t* archive, zip_uint64_t index) {
  zip_stat_t status{};
  if (zip_stat_index(archive, index, 0, &status) != 0 || (status.valid & ZIP_STAT_SIZE) == 0)
    throw Error(Failure::data, zip_strerror(archive));
  if (status.size > largest_array)
    throw error(Failure::data, "{} bytes; the largest robot is {}x{}", status.size, largest_side,
                largest_side);
  const Zip<zip_file_t> member(zip_fopen_index(archive, index, 0));
  if (!member) throw Error(Failure::data, zip_strerror(archive));
  std::string bytes(static_cast<std::size_t>(status.size), '\0');
  const zip_int64_t got = zip_fread(member.get(), bytes.data(), bytes.size());
  char past_the_end = 0;  // reading there is what makes libzip compare the checksum
  if (std::cmp_not_equal(got, bytes.size()) || zip_fread(member.get(), &past_the_end, 1) != 0)
    throw error(Failure::data, "cut off or damaged: {}", zip_file_strerror(member.get()));
  return bytes;
}

std::string member_name(zip_t* archive, zip_int64_t index) {
  const char* name = zip_get_name(archive, static_cast<zip_uint64_t>(index), ZIP_FL_ENC_RAW);
  return name == nullptr ? fmt::format("member {}", index) : name;
}

// What `read` makes of a member; its errors begin with the member's name.
template <typename Read>
auto from_member(zip_t* archive, zip_int64_t index, const Read& read) {
  try {
    return read(read_member(archive, static_cast<zip_uint64_t>(index)));
  } catch (const Error& failure) {
    throw failure.at(printable(member_name(archive, index)));
  }
}

std::vector<std::string> member_names(zip_t* archive) {
  std::vector<std::string> names;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
    names.push_back(member_name(archive, i));
    if (std::count(names.begin(), names.end(), names.back()) > 1)
      throw error(Failure::data, "two arrays are called {}", printable(names.back()));
  }
  return names;
}

using Names = std::vector<std::string>;

// The member of one of these names; -1: there is none.
zip_int64_t named(const Names& names, const Names& wanted) {
  for (const std::string& name : wanted)
    if (const auto found = std::find(names.begin(), names.end(), name + ".npy");
        found != names.end())
      return found - names.begin();
  return -1;
}

// That, else the first that is not `other`.
zip_int64_t choose(const Names& names, const Names& wanted, zip_int64_t other) {
  if (const zip_int64_t found = named(names, wanted); found >= 0) return found;
  const zip_int64_t first = other == 0 ? 1 : 0;
  return std::cmp_less(first, names.size()) ? first : -1;
}

// ---- body and links -------------------------------------------------------------

void check_dimensions(const NumpyMatrix& matrix) {
  if (matrix.dimensions != 2)
    throw error(Failure::data, "{} numbers in a row, expected a matrix", matrix.cols);
}

Body body_of(const NumpyMatrix& matrix) {
  check_dimensions(matrix);
  if (matrix.rows < 1 || matrix.cols < 1 || matrix.rows > largest_side ||
      matrix.cols > largest_side)
    throw error(Failure::data, "a body of {}x{} cells; rows and columns go from 1 to {}",
                matrix.rows, matrix.cols, largest_side);
  std::vector<Voxel> cells;
  for (std::size_t i = 0; i < matrix.values.size(); ++i) {
    const double kind = matrix.values[i];
    if (!(kind >= 0.0 && kind <= static_cast<double>(Voxel::vertical)) || kind != std::floor(kind))
      throw error(Failure::data, "unknown kind {} at row {}, column {}; allowed 0 1 2 3 4", kind,
                  i / matrix.cols + 1, i % matrix.cols + 1);
    cells.push_back(static_cast<Voxel>(static_cast<int>(kind)));
  }
  return {static_cast<int>(matrix.rows), static_cast<int>(matrix.cols), std::move(cells)};
}

std::vector<Link> links_of(const NumpyMatrix& pairs, const Body& body) {
  if (pairs.values.empty()) return {};
  if (pairs.rows != 2)
    throw error(Failure::data, "{} x {} numbers, expected two rows", pairs.rows, pairs.cols);
  const auto cell = [&](std::size_t i) {
    const double index = pairs.values[i];
    if (!(index >= 0.0 && index < static_cast<double>(body.cells.size())) ||
        index != std::floor(index))
      throw error(Failure::data, "{} is not the number of a cell, 0 to {}", index,
                  body.cells.size() - 1);
    return static_cast<int>(index);
  };
  std::vector<Link> links;
  for (std::size_t k = 0; k < pairs.cols; ++k) {
    const int a = cell(k);
    const int b = cell(pairs.cols + k);
    links.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return links;
}

void add_member(zip_t* archive, const char* name, const std::string& content) {
  // The earliest time that a zip archive can hold, 1980-01-01 00:00.
  constexpr zip_uint16_t dos_time = 0;
  constexpr zip_uint16_t dos_date = 1 << 5 | 1;
  zip_source_t* source = zip_source_buffer(archive, content.data(), content.size(), 0);
  const zip_int64_t index = source == nullptr ? -1 : zip_file_add(archive, name, source, 0);
  if (index < 0) {
    zip_source_free(source);
    throw error(Failure::io, "{}: cannot be written: {}", name, zip_strerror(archive));
  }
  const auto member = static_cast<zip_uint64_t>(index);
  zip_set_file_compression(archive, member, ZIP_CM_STORE, 0);
  zip_file_set_dostime(archive, member, dos_time, dos_date, 0);
}

std::string bytes_of(zip_source_t* source) {
  zip_stat_t status{};
  std::string bytes;
  if (zip_source_stat(source, &status) == 0 && zip_source_open(source) == 0) {
    bytes.resize(static_cast<std::size_t>(status.size));
    const zip_int64_t got = zip_source_read(source, bytes.data(), bytes.size());
    zip_source_close(source);
    if (std::cmp_equal(got, bytes.size())) return bytes;
  }
  throw Error(Failure::io, "an archive cannot be made in memory");
}

Body body_from_npz(std::string_view bytes) {
  const Zip<zip_t> archive = open_archive(bytes);
  const std::vector<std::string> names = member_names(archive.get());
  const Names links{"arr_1", "connections"};
  const zip_int64_t first =
      choose(names, {"arr_0", "body", "structure"}, names.size() > 1 ? named(names, links) : -1);
  if (first < 0) throw error(Failure::data, "an archive without a body matrix");
  Body body = from_member(archive.get(), first,
                          [](const std::string& npy) { return body_of(parse_npy(npy)); });
  const zip_int64_t second = choose(names, links, first);
  if (second < 0) return body;
  from_member(archive.get(), second, [&](const std::string& npy) {
    if (is_none(npy)) return;
    body.links = links_of(parse_npy(npy), body);
    if (const auto wrong = link_defect(body)) throw Error(Failure::data, *wrong);
  });
  return body;
}

}  // namespace

bool begins_as_numpy(std::string_view bytes) {
  return bytes.starts_with("PK") || bytes.starts_with(npy_magic);
}

Body body_from_numpy(std::string_view bytes, const std::string& where) {
  try {
    return bytes.starts_with(npy_magic) ? body_of(parse_npy(bytes)) : body_from_npz(bytes);
  } catch (const Error& failure) {
    throw failure.at(where);
  }
}

NumpyMatrix matrix_from_numpy(std::string_view bytes, const std::string& name,
                              const std::string& where) {
  try {
    NumpyMatrix matrix;
    if (bytes.starts_with(npy_magic)) {
      matrix = parse_npy(bytes);
    } else {
      const Zip<zip_t> archive = open_archive(bytes);
      const Names names = member_names(archive.get());
      const zip_int64_t index = names.size() == 1 ? 0 : named(names, {name});
      if (index < 0)
        throw error(Failure::data, "{} arrays, none of which is called {}", names.size(), name);
      matrix = from_member(archive.get(), index, parse_npy);
    }
    check_dimensions(matrix);
    return matrix;
  } catch (const Error& failure) {
    throw failure.at(where);
  }
}

Body read_npz(const fs::path& path) {
  return body_from_numpy(read_file(path, largest_numpy), path.string());
}

std::string body_to_npz(const Body& body) {
  std::vector<double> kinds;
  for (const Voxel voxel : body.cells) kinds.push_back(static_cast<double>(voxel));
  std::vector<std::int64_t> ends;
  for (const Link& link : body.links) ends.push_back(link.a);
  for (const Link& link : body.links) ends.push_back(link.b);
  const std::string matrix =
      npy_of(kinds, static_cast<std::size_t>(body.rows), static_cast<std::size_t>(body.cols), "f8");
  const std::string links = npy_of(ends, 2, body.links.size(), ends.empty() ? "f8" : "i8");

  ZipError failed;
  const Zip<zip_source_t> target(zip_source_buffer_create(nullptr, 0, 0, failed.get()));
  zip_source_keep(target.get());  // one for the archive, one to read it from
  Zip<zip_t> archive(zip_open_from_source(target.get(), ZIP_TRUNCATE, failed.get()));
  if (!archive) throw Error(Failure::io, failed.text());
  add_member(archive.get(), body_member, matrix);
  add_member(archive.get(), links_member, links);
  if (zip_close(archive.get()) != 0) throw Error(Failure::io, zip_strerror(archive.get()));
  (void)archive.release();
  return bytes_of(target.get());
}

}  // namespace evo
