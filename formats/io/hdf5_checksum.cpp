#include "formats/io/hdf5_checksum.h"

#include <fmt/ranges.h>
#include <nettle/sha2.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace evo::hdf5 {
namespace {

class Sha256 {
 public:
  explicit Sha256(std::size_t most) : most(most) { sha256_init(&context_); }
  const std::size_t most;  // bytes of one dataset or attribute
  void add(const void* bytes, std::size_t size) {
    sha256_update(&context_, size, static_cast<const std::uint8_t*>(bytes));
  }
  void add(std::string_view text) {
    add(text.data(), text.size());
    add("\n", 1);
  }
  std::string digits() {
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
    sha256_digest(&context_, digest.size(), digest.data());
    std::string text;
    for (const std::uint8_t byte : digest) text += fmt::format("{:02x}", byte);
    return text;
  }

 private:
  sha256_ctx context_{};
};

// Values of a dataset or attribute, read by `read` in the type they are stored in.
template <typename Read>
bool add_values(Sha256& sum, hid_t type, hid_t space, const Read& read) {
  const hssize_t points = H5Sget_simple_extent_npoints(space);
  if (points < 0) return false;
  const auto n = static_cast<std::size_t>(points);
  std::array<hsize_t, H5S_MAX_RANK> shape{};
  const int rank = H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  if (rank < 0) return false;
  sum.add(fmt::format("class {} size {} shape {}", static_cast<int>(H5Tget_class(type)),
                      H5Tget_size(type), fmt::join(shape.begin(), shape.begin() + rank, " ")));
  const std::size_t size = std::max<std::size_t>(H5Tget_size(type), 1);
  if (n == 0) return true;
  if (n > sum.most / size) return false;
  if (H5Tis_variable_str(type) > 0) {
    std::vector<char*> texts(n, nullptr);
    const bool done = read(texts.data());
    for (const char* text : texts)
      if (done && text != nullptr) sum.add(text);
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, texts.data());
    return done;
  }
  std::vector<char> bytes(n * size);
  if (!read(bytes.data())) return false;
  sum.add(bytes.data(), bytes.size());
  return true;
}

bool add_attribute(Sha256& sum, hid_t owner, const std::string& name) {
  const hid_t attribute = H5Aopen(owner, name.c_str(), H5P_DEFAULT);
  const hid_t type = H5Aget_type(attribute);
  const hid_t space = H5Aget_space(attribute);
  sum.add("@" + name);
  const bool done = attribute >= 0 && add_values(sum, type, space, [&](void* into) {
                      return H5Aread(attribute, type, into) >= 0;
                    });
  H5Sclose(space);
  H5Tclose(type);
  H5Aclose(attribute);
  return done;
}

bool add_attributes(Sha256& sum, hid_t owner, bool root) {
  std::vector<std::string> names;
  const auto keep = [](hid_t, const char* name, const H5A_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  if (H5Aiterate2(owner, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep, &names) < 0) return false;
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return (root && name == checksum_attribute) || add_attribute(sum, owner, name);
  });
}

bool add_dataset(Sha256& sum, hid_t dataset) {
  const hid_t type = H5Dget_type(dataset);
  const hid_t space = H5Dget_space(dataset);
  const bool done = add_values(sum, type, space, [&](void* into) {
    return H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, into) >= 0;
  });
  H5Sclose(space);
  H5Tclose(type);
  return done;
}

bool add_object(Sha256& sum, hid_t file, const std::string& path) {
  const hid_t object = H5Oopen(file, path.c_str(), H5P_DEFAULT);
  if (object < 0) return false;
  sum.add(path);
  const bool done = (H5Iget_type(object) != H5I_DATASET || add_dataset(sum, object)) &&
                    add_attributes(sum, object, path == "/");
  H5Oclose(object);
  return done;
}

}  // namespace

std::optional<std::string> content_checksum(hid_t file, std::size_t most) {
  std::vector<std::string> paths;
  const auto keep = [](hid_t, const char* name, const H5L_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  if (H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, keep, &paths) < 0) return std::nullopt;
  std::sort(paths.begin(), paths.end());
  Sha256 sum(most);
  if (!add_object(sum, file, "/")) return std::nullopt;
  for (const std::string& path : paths)
    if (!add_object(sum, file, path)) return std::nullopt;
  return sum.digits();
}

}  // namespace evo::hdf5
