// Where the kernels are compiled for one instruction set, without Highway's library.
#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdlib>

#include "libevo/base/error.h"
#include "libevo/sim/isa.h"

namespace evo {

std::vector<std::string> available_isas() { return {best_isa()}; }
std::string best_isa() { return "wasm"; }

void select_isa(const std::string& isa) {
  if (isa != best_isa())
    throw error(Failure::usage, "instruction set '{}' is not available here; choose one of: {}",
                isa, best_isa());
}

bool has_quick_divider() { return true; }

}  // namespace evo

// What the header of Highway's allocator leaves to its library.
namespace hwy {

void* AllocateAlignedBytes(std::size_t size, AllocPtr allocate, void* opaque) {
  if (allocate != nullptr) return allocate(opaque, size);
  return std::aligned_alloc(HWY_ALIGNMENT,
                            (size + HWY_ALIGNMENT - 1) / HWY_ALIGNMENT * HWY_ALIGNMENT);
}

void FreeAlignedBytes(const void* aligned, FreePtr free_bytes, void* opaque) {
  void* bytes = const_cast<void*>(aligned);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  if (free_bytes != nullptr) {
    free_bytes(opaque, bytes);
  } else {
    std::free(bytes);
  }
}

}  // namespace hwy
