// What can be told of an HDF5 file from its bytes, before the library sees it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace evo::hdf5 {

// Whether bytes begin like an HDF5 file.
bool begins_as_hdf5(std::string_view bytes);

// How many bytes the file says that it has. Throws Error(data) with `where` for a
// beginning that does not say.
std::size_t stated_size(std::string_view beginning, const std::string& where);

// Whether the sizes in every "global heap collection", where variable texts are kept,
// stay inside it: the library follows them without looking, and such a heap has no
// checksum. Of bytes, or of the first `size` bytes of an open file, which is read
// piece by piece.
bool heaps_are_sound(std::string_view bytes);
bool heaps_are_sound(int descriptor, std::uint64_t size);

}  // namespace evo::hdf5
