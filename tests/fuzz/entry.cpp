#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  evo::fuzz::run({reinterpret_cast<const char*>(data), size});  // NOLINT: bytes
  return 0;
}
