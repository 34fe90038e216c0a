// EvoGym's robots in .npz files (docs/formats/foreign.md): a zip archive of two
// NumPy arrays, the body matrix of kinds 0 to 4 (row 0 on top) and the links as
// pairs of row-major indices, 2 x k.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "libevo/body/body.h"

namespace evo {

// The first two members, whatever their names; number types of any width; links
// may be absent (all adjacent pairs) and given twice. Cells and links make
// sense, connectivity is not asked for. Throws Error(no_input, io, data).
Body read_npz(const std::filesystem::path& path);
// Of an .npz archive, or one array (.npy): alone, it is a body matrix whose adjacent cells are all
// linked.
Body body_from_numpy(std::string_view bytes, const std::string& where);
// Whether bytes begin as one of them does.
bool begins_as_numpy(std::string_view bytes);

// An array of numbers, which has two dimensions.
struct NumpyMatrix {
  int dimensions = 0;
  std::size_t rows = 0;
  std::size_t cols = 0;
  std::vector<double> values;  // row-major
  bool is_single = false;      // of float32
};
// The array of an .npy; of an .npz its only array, or the one of this name. Throws Error(data).
NumpyMatrix matrix_from_numpy(std::string_view bytes, const std::string& name,
                              const std::string& where);

// Bytes of an array: the links of the largest robot, both directions, and a header.
inline constexpr std::size_t largest_array =
    std::size_t{8} * sizeof(std::int64_t) * largest_side * largest_side + 65536;
inline constexpr std::size_t largest_numpy = 2 * largest_array;  // and of a file

// As EvoGym's examples write it: float64 and int64, each link once, not
// compressed. The same body gives the same bytes.
std::string body_to_npz(const Body& body);

}  // namespace evo
