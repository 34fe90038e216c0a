#include "bindings/web/page.h"

#include <new>

#include "bindings/web/wasm/files.h"
#include "libevo/base/error.h"

namespace evo::web {

std::string& answer() {
  static std::string text;
  return text;
}

int guarded(const std::function<void()>& work) {
  answer().clear();
  try {
    work();
    return 0;
  } catch (const Error& failure) {
    answer() = failure.what();
    return static_cast<int>(failure.kind());
  } catch (const std::bad_alloc&) {
    answer() = "out of memory";
    return static_cast<int>(Failure::work);
  }
}

const DataFolders& folders() {
  static const DataFolders given{"tasks"};
  return given;
}

}  // namespace evo::web

const char* evo_answer() { return evo::web::answer().c_str(); }

void evo_give_file(const char* path, const char* text) { evo::given_files()[path] = text; }
