// AddressSanitizer asks for this function when it is linked in: the HDF5 library
// forgets a buffer when it fails to decompress a damaged chunk.
extern "C" const char* __lsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier)

extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libhdf5";
}
