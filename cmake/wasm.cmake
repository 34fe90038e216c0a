# libevo for browsers (`cmake --preset wasm`, bindings/web/README.md): Debian's emscripten, and of other
# packages only headers. What needs threads, processor detection, files or a compiled library
# has a second source in bindings/web/wasm.
set(CMAKE_EXECUTABLE_SUFFIX .wasm)
set(headers ${PROJECT_BINARY_DIR}/headers)  # of these packages, and not of the host's C library
file(MAKE_DIRECTORY ${headers})
foreach(header fmt/format.h hwy/highway.h nlohmann/json.hpp eigen3/Eigen/Dense)
  find_path(found ${header} PATHS /usr/include NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH REQUIRED NO_CACHE)
  get_filename_component(folder ${found}/${header} DIRECTORY)
  get_filename_component(package ${folder} NAME)
  file(CREATE_LINK ${folder} ${headers}/${package} SYMBOLIC)
  unset(found)
endforeach()
foreach(package fmt::fmt hwy::hwy nlohmann_json::nlohmann_json Eigen3::Eigen Threads::Threads)
  add_library(${package} INTERFACE IMPORTED)
  target_include_directories(${package} SYSTEM INTERFACE ${headers})
endforeach()
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)

target_compile_options(evo_options INTERFACE
  -fwasm-exceptions -include ${PROJECT_SOURCE_DIR}/bindings/web/wasm/libcxx.h)
