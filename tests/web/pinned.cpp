// tests/unit/task/pinned.h in WebAssembly: answers the hash after 100 steps, and after all
// those that were asked for.
#include "tests/unit/task/pinned.h"

#include <fmt/format.h>

#include "bindings/web/page.h"
#include "formats/task/task.h"

extern "C" EVO_EXPORTED int evo_pinned(const char* task, int steps);

int evo_pinned(const char* task, int steps) {
  return evo::web::guarded([&] {
    const evo::pinned::Hashes hashes =
        evo::pinned::run(evo::load_task(task, evo::web::folders()), 1, 1, steps);
    evo::web::answer() =
        fmt::format("[\"{:#x}\", \"{:#x}\"]", hashes.after_quick, hashes.after_whole);
  });
}
