// A checksum over everything that an open HDF5 file says: names, shapes, types and
// values of datasets and attributes. It does not depend on how they are stored.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <optional>
#include <string>

namespace evo::hdf5 {

// The attribute of the root group that keeps it, and is left out of it.
inline constexpr const char* checksum_attribute = "checksum";

// SHA-256 in hexadecimal digits; nothing when something cannot be read, or is said to
// be larger than `most` bytes.
std::optional<std::string> content_checksum(hid_t file, std::size_t most);

}  // namespace evo::hdf5
