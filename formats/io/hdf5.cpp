#include "formats/io/hdf5.h"

#include <fmt/ranges.h>
#include <hdf5.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <new>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "libevo/base/digest.h"
#include "libevo/base/error.h"

namespace evo::hdf5 {
namespace {

// ---- handles and errors -----------------------------------------------------

// Short of memory the library crashes as it begins, makes or opens a file (1.10.8).
// Mostly found out before: another thread may take what is there now. Asked of the
// kernel, since so large a piece of the heap would change how it deals with others.
void need_memory() {
  constexpr std::size_t headroom = std::size_t{16} << 20;  // bytes
  void* const room =
      ::mmap(nullptr, headroom, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  ::munmap(room, headroom);
}

// The library's clean-up at exit is not needed, all files being closed by then, and would
// wait for ever for a lock that it has not given back when it ran out of memory.
bool begin_library() {
  need_memory();
  H5dont_atexit();
  return true;
}

// The library keeps one error stack a thread and prints it unless told not to.
void silence() {
  [[maybe_unused]] static const bool begun = begin_library();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

// ---- the seal -----------------------------------------------------------------

// After its last byte a file of ours says what all bytes before give: damage is found
// before the library sees it, which follows some sizes in a file without looking. Other
// readers see only what the file's own header counts, and a writer that changes a file
// cuts the seal off.
constexpr std::string_view seal_mark = "evo sha256 ";
constexpr std::size_t seal_size = seal_mark.size() + 64;

std::string seal(std::string_view bytes) { return std::string(seal_mark) + sha256_hex(bytes); }

// Little-endian, `width` bytes.
std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t i = width; i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// Whether a collection of texts (HDF5 file format specification, section III.E) has a piece
// without a size: the library would never get past it (1.10.8).
bool has_endless_heap(std::string_view bytes) {
  constexpr std::string_view mark{"GCOL\1\0\0\0", 8};
  constexpr std::size_t head = 16;  // of a collection, and of an object in it
  for (std::size_t at = bytes.find(mark); at != std::string_view::npos;
       at = bytes.find(mark, at + mark.size())) {
    if (bytes.size() - at < head) return false;
    const std::size_t size =
        std::min<std::uint64_t>(number_at(bytes, at + 8, 8), bytes.size() - at);
    for (std::size_t place = head; place + head <= size;) {
      const std::uint64_t index = number_at(bytes, at + place, 2);
      const std::uint64_t length = number_at(bytes, at + place + 8, 8);
      const std::uint64_t step = index == 0 ? length : head + (length + 7) / 8 * 8;
      if (step == 0) return true;
      if (step > size - place) break;
      place += step;
    }
  }
  return false;
}

// The file without its seal. Throws Error(data) where it has one and is something else, and
// where it has none and cannot be given to the library.
std::string_view unsealed(std::string_view bytes, const std::string& name) {
  const std::size_t end = bytes.size() < seal_size ? bytes.size() : bytes.size() - seal_size;
  const std::string_view found = bytes.substr(end);
  if (!found.starts_with(seal_mark)) {
    if (has_endless_heap(bytes)) throw error(Failure::data, "{}: damaged HDF5 file", name);
    return bytes;
  }
  if (found != seal(bytes.substr(0, end)))
    throw error(Failure::data, "{}: damaged HDF5 file: its checksum is that of other bytes", name);
  return bytes.substr(0, end);
}

// From the superblock (HDF5 file format specification, section II.A): versions 0 and 1 have
// the address of the end after those of the beginning and of free space, 2 and 3 after those
// of the beginning and of an extension.
std::optional<std::size_t> size_in(std::string_view superblock) {
  const auto number = [&](std::size_t at, std::size_t width) {
    return number_at(superblock, at, width);
  };
  constexpr std::size_t longest = 64;
  if (superblock.size() < longest) return std::nullopt;
  const std::uint64_t version = number(8, 1);
  const std::size_t addresses = version == 0 ? 24 : version == 1 ? 28 : 12;
  const std::uint64_t width = number(version < 2 ? 13 : 9, 1);
  if (version > 3 || (width != 4 && width != 8)) return std::nullopt;
  return number(addresses + 2 * width, width);
}

// The library takes two files in memory for one if their names are the same.
std::string in_memory(const std::string& name) {
  static std::atomic<std::uint64_t> count = 0;
  return fmt::format("{}#{}", name, count++);
}

// The innermost reason on the error stack, as " (inflate() failed)", or "".
std::string library_reason() {
  std::string reason;
  const auto keep_first = [](unsigned, const H5E_error2_t* entry, void* into) -> herr_t {
    auto& text = *static_cast<std::string*>(into);
    if (text.empty() && entry->desc != nullptr) text = entry->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &reason);
  return reason.empty() ? "" : " (" + reason + ")";
}

// An identifier of the library and the function that closes it.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { close(); }

  hid_t get() const { return id_; }
  bool ok() const { return id_ >= 0; }
  // Whether closing succeeded; closing a file is where its last bytes go out.
  bool close() {
    if (id_ < 0) return true;
    return close_(std::exchange(id_, H5I_INVALID_HID)) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

// "/a/b/c" -> "/a", "/a/b", "/a/b/c".
std::vector<std::string> prefixes(const std::string& path) {
  std::vector<std::string> found;
  for (std::size_t end = path.find_first_not_of('/'); end != std::string::npos;) {
    end = path.find('/', end);
    found.push_back(path.substr(0, end));
    if (end != std::string::npos) end = path.find_first_not_of('/', end);
  }
  return found;
}

std::string attribute_path(const std::string& object, const std::string& name) {
  return object + "@" + name;
}

// ---- types ------------------------------------------------------------------

// The library's types are variables, which it sets as it begins.
struct NumberType {
  hid_t memory;
  hid_t file;
};

template <Number T>
NumberType type_of() {
  if constexpr (std::is_same_v<T, double>) return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE};
  if constexpr (std::is_same_v<T, float>) return {H5T_NATIVE_FLOAT, H5T_IEEE_F32LE};
  if constexpr (std::is_same_v<T, std::uint8_t>) return {H5T_NATIVE_UINT8, H5T_STD_U8LE};
  if constexpr (std::is_same_v<T, std::int32_t>) return {H5T_NATIVE_INT32, H5T_STD_I32LE};
  if constexpr (std::is_same_v<T, std::int64_t>) return {H5T_NATIVE_INT64, H5T_STD_I64LE};
  if constexpr (std::is_same_v<T, std::uint64_t>) return {H5T_NATIVE_UINT64, H5T_STD_U64LE};
}

Handle string_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

Handle flag_type() {
  Handle type(H5Tenum_create(H5T_STD_I8LE), H5Tclose);
  for (const std::int8_t value : {std::int8_t{0}, std::int8_t{1}})
    H5Tenum_insert(type.get(), value == 0 ? "FALSE" : "TRUE", &value);
  return type;
}

Handle space_of(const Shape& shape) {
  const std::vector<hsize_t> sizes(shape.begin(), shape.end());
  return {sizes.empty() ? H5Screate(H5S_SCALAR)
                        : H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr),
          H5Sclose};
}

std::string shape_text(const Shape& shape) {
  std::vector<std::string> sizes;
  for (const std::size_t n : shape) sizes.push_back(n == any ? "any" : std::to_string(n));
  return fmt::format("[{}]", fmt::join(sizes, " x "));
}

}  // namespace

// ---- Writer -----------------------------------------------------------------

// The file grows in memory and goes out as bytes at the end: the library's own
// output does not survive a full disk, it crashes at exit.
//
// Groups and datasets keep the order in which their links and attributes were
// made. Besides being nicer to look at, this gives object headers of version 2,
// which have checksums, so that damage is found and not followed.
struct Writer::File {
  AtomicFile output;
  std::string name;
  Handle id;

  explicit File(const std::filesystem::path& path) : output(path), name(path.string()) {
    need_memory();
    silence();
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    constexpr std::size_t growth = std::size_t{1} << 20;
    constexpr hbool_t keep_in_memory = false;
    H5Pset_fapl_core(access.get(), growth, keep_in_memory);
    const Handle creation = group_properties(H5P_FILE_CREATE);
    id = Handle(H5Fcreate(in_memory(name).c_str(), H5F_ACC_TRUNC, creation.get(), access.get()),
                H5Fclose);
    if (!id.ok()) throw failed("/");
  }

  Error failed(const std::string& path) const {
    return error(Failure::io, "{}: {}: cannot be written{}", name, path, library_reason());
  }

  static Handle object_properties(hid_t kind) {
    Handle properties(H5Pcreate(kind), H5Pclose);
    H5Pset_attr_creation_order(properties.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    H5Pset_obj_track_times(properties.get(), false);
    return properties;
  }

  // For a group, or for the file and its root group.
  static Handle group_properties(hid_t kind) {
    Handle properties = object_properties(kind);
    H5Pset_link_creation_order(properties.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    return properties;
  }

  static Handle link_properties() {
    Handle properties(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_char_encoding(properties.get(), H5T_CSET_UTF8);
    return properties;
  }

  // `path` and the groups on the way, where they do not exist.
  void make_groups(const std::string& path) const {
    silence();
    for (const std::string& prefix : prefixes(path)) {
      if (H5Lexists(id.get(), prefix.c_str(), H5P_DEFAULT) > 0) continue;
      const Handle group(H5Gcreate2(id.get(), prefix.c_str(), link_properties().get(),
                                    group_properties(H5P_GROUP_CREATE).get(), H5P_DEFAULT),
                         H5Gclose);
      if (!group.ok()) throw failed(prefix);
    }
  }

  void dataset(const std::string& path, const NumberType& type, const Shape& shape,
               const void* values, const Handle& properties) const {
    make_groups(path.substr(0, path.rfind('/')));
    const Handle space = space_of(shape);
    const Handle dataset(H5Dcreate2(id.get(), path.c_str(), type.file, space.get(),
                                    link_properties().get(), properties.get(), H5P_DEFAULT),
                         H5Dclose);
    if (!dataset.ok() ||
        H5Dwrite(dataset.get(), type.memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
      throw failed(path);
  }

  // Whole rows, about a quarter of a MiB a chunk; nothing for an empty array,
  // which cannot be chunked.
  static Handle compressed(const Shape& shape, std::size_t element_size) {
    Handle properties = object_properties(H5P_DATASET_CREATE);
    if (shape.empty() || std::find(shape.begin(), shape.end(), 0U) != shape.end())
      return properties;
    constexpr std::size_t chunk_bytes = std::size_t{1} << 18;
    std::vector<hsize_t> chunk(shape.begin(), shape.end());
    std::size_t row_bytes = element_size;
    for (std::size_t i = 1; i < shape.size(); ++i) row_bytes *= shape[i];
    chunk[0] = std::clamp<std::size_t>(chunk_bytes / row_bytes, 1, shape[0]);
    H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_shuffle(properties.get());
    H5Pset_deflate(properties.get(), 1);
    return properties;
  }

  void attribute(const std::string& object, const std::string& attribute_name,
                 const NumberType& type, const Shape& shape, const void* value) const {
    silence();
    const Handle owner(H5Oopen(id.get(), object.c_str(), H5P_DEFAULT), H5Oclose);
    const Handle space = space_of(shape);
    const Handle attribute(H5Acreate2(owner.get(), attribute_name.c_str(), type.file, space.get(),
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    if (!attribute.ok() || H5Awrite(attribute.get(), type.memory, value) < 0)
      throw failed(attribute_path(object, attribute_name));
  }
};

Writer::Writer(const std::filesystem::path& path) : file_(std::make_unique<File>(path)) {}
Writer::~Writer() = default;

void Writer::group(const std::string& path) { file_->make_groups(path); }

template <Number T>
void Writer::array(const std::string& path, const Shape& shape, const std::vector<T>& values) {
  std::size_t elements = 1;
  for (const std::size_t n : shape) elements *= n;
  if (elements != values.size())
    throw error(Failure::io, "{}: {}: {} values do not fill the shape {}", file_->name, path,
                values.size(), shape_text(shape));
  file_->dataset(path, type_of<T>(), shape, values.data(), File::compressed(shape, sizeof(T)));
}

void Writer::flags(const std::string& path, const std::vector<std::uint8_t>& values) {
  const Handle type = flag_type();
  file_->dataset(path, {type.get(), type.get()}, {values.size()}, values.data(),
                 File::compressed({values.size()}, 1));
}

void Writer::strings(const std::string& path, const std::vector<std::string>& values) {
  std::size_t length = 1;
  for (const std::string& value : values) length = std::max(length, value.size());
  std::string characters;
  for (const std::string& value : values) {
    characters += value;
    characters.resize(characters.size() + length - value.size(), '\0');
  }
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), length);
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  file_->dataset(path, {type.get(), type.get()}, {values.size()}, characters.data(),
                 File::object_properties(H5P_DATASET_CREATE));
}

void Writer::attribute(const std::string& object, const std::string& name,
                       const std::string& value) {
  attribute(object, name, value.c_str());
}

void Writer::attribute(const std::string& object, const std::string& name, const char* value) {
  const Handle type = string_type();
  file_->attribute(object, name, {type.get(), type.get()}, {}, &value);
}

template <Number T>
void Writer::attribute(const std::string& object, const std::string& name, T value) {
  file_->attribute(object, name, type_of<T>(), {}, &value);
}

template <Number T>
void Writer::attribute(const std::string& object, const std::string& name,
                       const std::vector<T>& values) {
  file_->attribute(object, name, type_of<T>(), {values.size()}, values.data());
}

void Writer::commit(Existing existing) {
  silence();
  const hid_t id = file_->id.get();
  if (H5Fflush(id, H5F_SCOPE_GLOBAL) < 0) throw file_->failed("/");
  const ssize_t size = H5Fget_file_image(id, nullptr, 0);
  if (size <= 0) throw file_->failed("/");
  std::string image(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(id, image.data(), image.size()) != size) throw file_->failed("/");
  file_->id.close();
  file_->output.write(image);
  file_->output.write(seal(image));
  file_->output.commit(existing);
}

// ---- Reader -----------------------------------------------------------------

namespace {

// A file is data of anybody's making: its links to other files are not followed.
void stay_in_this_file() {
  if (H5Lis_registered(H5L_TYPE_EXTERNAL) > 0) H5Lunregister(H5L_TYPE_EXTERNAL);
}

// The texts behind an attribute or dataset, whatever the kind of string. `read`
// fills a buffer given in the memory type it is told.
template <typename Read>
std::vector<std::string> read_strings(hid_t stored_type, const Handle& space, std::size_t n,
                                      const Read& read) {
  std::vector<std::string> texts(n);
  if (H5Tis_variable_str(stored_type) > 0) {
    const Handle type = string_type();
    H5Tset_cset(type.get(), H5Tget_cset(stored_type));
    std::vector<char*> pointers(n, nullptr);
    const bool done = read(type.get(), pointers.data());
    for (std::size_t i = 0; done && i < n; ++i)
      if (pointers[i] != nullptr) texts[i] = pointers[i];
    H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, pointers.data());
    return done ? texts : std::vector<std::string>{};
  }
  const std::size_t size = H5Tget_size(stored_type);
  std::vector<char> characters(n * size, '\0');
  if (!read(stored_type, characters.data())) return {};
  const char padding = H5Tget_strpad(stored_type) == H5T_STR_SPACEPAD ? ' ' : '\0';
  for (std::size_t i = 0; i < n; ++i) {
    const char* text = characters.data() + i * size;
    std::size_t length = ::strnlen(text, size);
    while (length > 0 && text[length - 1] == padding) --length;
    texts[i].assign(text, length);
  }
  return texts;
}

}  // namespace

struct Reader::File {
  std::string name;
  std::uintmax_t size = 0;  // bytes
  Handle id;

  File(std::string_view sealed, std::string name_) : name(std::move(name_)), size(sealed.size()) {
    const std::string_view bytes = unsealed(sealed, name);
    const Handle access = begin();
    constexpr std::size_t growth = std::size_t{1} << 16;
    H5Pset_fapl_core(access.get(), growth, false);
    H5Pset_file_image(access.get(), const_cast<char*>(bytes.data()), bytes.size());  // copies
    open(in_memory(name), access, begins_as_hdf5(bytes));
  }

  explicit File(const std::filesystem::path& path) : name(path.string()) {
    // Opening a pipe may wait for ever.
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
      throw error(Failure::no_input, "{}: is not a file, an HDF5 file is needed", name);
    constexpr std::size_t any_size = std::numeric_limits<std::size_t>::max();
    size = unsealed(read_file(path, any_size), name).size();
    const Handle access = begin();
    // Files appear whole and never change: a lock would only fail, on file systems without.
    H5Pset_file_locking(access.get(), false, true);
    open(name, access, is_hdf5(path));
  }

  // Before a file is opened; how it is opened.
  static Handle begin() {
    need_memory();
    silence();
    stay_in_this_file();
    return {H5Pcreate(H5P_FILE_ACCESS), H5Pclose};
  }

  void open(const std::string& file, const Handle& access, bool looks_like_hdf5) {
    id = Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
    if (id.ok()) return;
    throw error(Failure::data, "{}: {}{}", name,
                looks_like_hdf5 ? "damaged or truncated HDF5 file" : "not an HDF5 file",
                library_reason());
  }

  Error failed(const std::string& path, const std::string& what) const {
    return error(Failure::data, "{}: {}: {}", name, path, what);
  }

  Error unreadable(const std::string& path) const {
    return failed(path, "cannot be read" + library_reason());
  }

  Handle open_dataset(const std::string& path) const {
    silence();
    if (!exists(path)) throw failed(path, "is missing");
    Handle dataset(H5Dopen2(id.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.ok()) throw failed(path, "is not a dataset" + library_reason());
    const Handle properties(H5Dget_create_plist(dataset.get()), H5Pclose);
    if (H5Pget_external_count(properties.get()) > 0 ||
        H5Pget_layout(properties.get()) == H5D_VIRTUAL)
      throw failed(path, "keeps its values in another file, which is not followed");
    return dataset;
  }

  Handle open_attribute(const std::string& object, const std::string& attribute) const {
    silence();
    if (!has_attribute(object, attribute))
      throw failed(attribute_path(object, attribute), "is missing");
    Handle opened(
        H5Aopen_by_name(id.get(), object.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    if (!opened.ok()) throw unreadable(attribute_path(object, attribute));
    return opened;
  }

  bool exists(const std::string& path) const {
    silence();
    for (const std::string& prefix : prefixes(path))
      if (H5Lexists(id.get(), prefix.c_str(), H5P_DEFAULT) <= 0) return false;
    return true;
  }

  bool has_attribute(const std::string& object, const std::string& attribute) const {
    return exists(object) &&
           H5Aexists_by_name(id.get(), object.c_str(), attribute.c_str(), H5P_DEFAULT) > 0;
  }

  Shape shape_of(const Handle& space, const std::string& path) const {
    if (!space.ok() || H5Sget_simple_extent_type(space.get()) == H5S_NULL)
      throw failed(path, "has no shape" + library_reason());
    const int rank = H5Sget_simple_extent_ndims(space.get());
    if (rank < 0) throw unreadable(path);
    std::vector<hsize_t> sizes(static_cast<std::size_t>(rank));
    if (rank > 0 && H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr) < 0)
      throw unreadable(path);
    return {sizes.begin(), sizes.end()};
  }

  std::size_t most_bytes() const {
    constexpr std::size_t best_compression = 1100;  // deflate reaches 1032
    return std::max<std::size_t>(size, 1) * best_compression;
  }

  // The number of elements, unless the file is far too small to hold them: a
  // damaged shape must not take all memory.
  std::size_t count(const Shape& shape, std::size_t element_size, const std::string& path) const {
    const std::size_t most = most_bytes() / element_size;
    std::size_t elements = 1;
    for (const std::size_t n : shape) {
      if (n != 0 && elements > most / n)
        throw failed(path, fmt::format("the shape {} does not fit into a file of {} bytes",
                                       shape_text(shape), size));
      elements *= n;
    }
    return elements;
  }

  template <Number T>
  std::vector<T> room_for(const Shape& shape, const std::string& path) const {
    try {
      return std::vector<T>(count(shape, sizeof(T), path));
    } catch (const std::bad_alloc&) {
      throw failed(path, fmt::format("the shape {} does not fit into memory", shape_text(shape)));
    }
  }

  void check_number(const Handle& type, const std::string& path) const {
    const H5T_class_t kind = H5Tget_class(type.get());
    if (kind != H5T_FLOAT && kind != H5T_INTEGER && kind != H5T_ENUM)
      throw failed(path, "does not hold numbers");
  }

  template <typename Read>
  std::vector<std::string> texts(const Handle& type, const Handle& space, const std::string& path,
                                 const Read& read) const {
    if (H5Tget_class(type.get()) != H5T_STRING) throw failed(path, "does not hold text");
    const std::size_t n =
        count(shape_of(space, path), std::max<std::size_t>(H5Tget_size(type.get()), 1), path);
    auto texts = read_strings(type.get(), space, n, read);
    if (texts.size() != n) throw unreadable(path);
    return texts;
  }

  template <Number T>
  Array<T> read_attribute(const std::string& object, const std::string& attribute) const {
    const std::string path = attribute_path(object, attribute);
    const Handle opened = open_attribute(object, attribute);
    const Handle type(H5Aget_type(opened.get()), H5Tclose);
    check_number(type, path);
    Array<T> result;
    result.shape = shape_of(Handle(H5Aget_space(opened.get()), H5Sclose), path);
    result.values = room_for<T>(result.shape, path);
    if (H5Aread(opened.get(), type_of<T>().memory, result.values.data()) < 0)
      throw unreadable(path);
    return result;
  }
};

Reader::Reader(const std::filesystem::path& path) : file_(std::make_unique<File>(path)) {}
Reader::Reader(std::string_view bytes, const std::string& name)
    : file_(std::make_unique<File>(bytes, name)) {}
Reader::~Reader() = default;

const std::string& Reader::name() const { return file_->name; }

bool Reader::exists(const std::string& path) const { return file_->exists(path); }

std::vector<std::string> Reader::children(const std::string& group) const {
  silence();
  if (!exists(group)) throw file_->failed(group, "is missing");
  std::vector<std::string> names;
  const auto keep = [](hid_t, const char* name, const H5L_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  if (H5Literate_by_name(file_->id.get(), group.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, keep,
                         &names, H5P_DEFAULT) < 0)
    throw file_->failed(group, "is not a group" + library_reason());
  return names;
}

Shape Reader::shape(const std::string& path) const {
  const Handle dataset = file_->open_dataset(path);
  return file_->shape_of(Handle(H5Dget_space(dataset.get()), H5Sclose), path);
}

bool Reader::is_single(const std::string& path) const {
  const Handle dataset = file_->open_dataset(path);
  const Handle type(H5Dget_type(dataset.get()), H5Tclose);
  return H5Tget_class(type.get()) == H5T_FLOAT && H5Tget_size(type.get()) == sizeof(float);
}

template <Number T>
Array<T> Reader::array(const std::string& path) const {
  const Handle dataset = file_->open_dataset(path);
  const Handle type(H5Dget_type(dataset.get()), H5Tclose);
  file_->check_number(type, path);
  Array<T> result;
  result.shape = file_->shape_of(Handle(H5Dget_space(dataset.get()), H5Sclose), path);
  result.values = file_->room_for<T>(result.shape, path);
  if (!result.values.empty() && H5Dread(dataset.get(), type_of<T>().memory, H5S_ALL, H5S_ALL,
                                        H5P_DEFAULT, result.values.data()) < 0)
    throw file_->unreadable(path);
  return result;
}

template <Number T>
Array<T> Reader::array(const std::string& path, const Shape& expected) const {
  const Shape found = shape(path);
  const auto fits = [](std::size_t n, std::size_t wanted) { return wanted == any || n == wanted; };
  if (!std::equal(found.begin(), found.end(), expected.begin(), expected.end(), fits))
    throw file_->failed(
        path, fmt::format("has shape {}, expected {}", shape_text(found), shape_text(expected)));
  return array<T>(path);
}

std::vector<std::string> Reader::strings(const std::string& path) const {
  const Handle dataset = file_->open_dataset(path);
  return file_->texts(
      Handle(H5Dget_type(dataset.get()), H5Tclose), Handle(H5Dget_space(dataset.get()), H5Sclose),
      path, [&](hid_t memory, void* into) {
        return H5Dread(dataset.get(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, into) >= 0;
      });
}

std::string Reader::format() const {
  return has_attribute("/", "format") ? text("/", "format") : "";
}

bool Reader::has_attribute(const std::string& object, const std::string& name) const {
  return file_->has_attribute(object, name);
}

std::string Reader::text(const std::string& object, const std::string& name) const {
  const std::string path = attribute_path(object, name);
  const Handle attribute = file_->open_attribute(object, name);
  const auto texts = file_->texts(
      Handle(H5Aget_type(attribute.get()), H5Tclose),
      Handle(H5Aget_space(attribute.get()), H5Sclose), path,
      [&](hid_t memory, void* into) { return H5Aread(attribute.get(), memory, into) >= 0; });
  if (texts.size() != 1)
    throw file_->failed(path, fmt::format("holds {} texts, expected one", texts.size()));
  return texts.front();
}

template <Number T>
T Reader::number(const std::string& object, const std::string& name) const {
  const auto values = file_->read_attribute<T>(object, name).values;
  if (values.size() != 1)
    throw file_->failed(attribute_path(object, name),
                        fmt::format("holds {} numbers, expected one", values.size()));
  return values.front();
}

template <Number T>
std::vector<T> Reader::numbers(const std::string& object, const std::string& name) const {
  return file_->read_attribute<T>(object, name).values;
}

bool begins_as_hdf5(std::string_view bytes) { return bytes.starts_with("\x89HDF\r\n\x1a\n"); }

std::size_t stated_size(std::string_view beginning, const std::string& where) {
  if (const auto size = size_in(beginning)) return *size + seal_size;
  throw error(Failure::data, "{}: damaged or truncated HDF5 file", where);
}

bool is_hdf5(const std::filesystem::path& path) {
  silence();
  // A pipe can be opened once, and that is for its reader to do.
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) && H5Fis_hdf5(path.c_str()) > 0;
}

// ---- the numbers that can be stored ------------------------------------------

#define EVO_HDF5_NUMBER(T)                                                                 \
  template void Writer::array<T>(const std::string&, const Shape&, const std::vector<T>&); \
  template void Writer::attribute<T>(const std::string&, const std::string&, T);           \
  template void Writer::attribute<T>(const std::string&, const std::string&,               \
                                     const std::vector<T>&);                               \
  template Array<T> Reader::array<T>(const std::string&) const;                            \
  template Array<T> Reader::array<T>(const std::string&, const Shape&) const;              \
  template T Reader::number<T>(const std::string&, const std::string&) const;              \
  template std::vector<T> Reader::numbers<T>(const std::string&, const std::string&) const;
EVO_HDF5_NUMBER(double)
EVO_HDF5_NUMBER(float)
EVO_HDF5_NUMBER(std::uint8_t)
EVO_HDF5_NUMBER(std::int32_t)
EVO_HDF5_NUMBER(std::int64_t)
EVO_HDF5_NUMBER(std::uint64_t)
#undef EVO_HDF5_NUMBER

}  // namespace evo::hdf5
