// A source of its own, since it is compiled anew for every commit.
#include "bindings/c/created_by.h"

#include "version.h"

namespace evo {

const char* created_by() { return "libevo " EVO_VERSION " (" EVO_COMMIT ")"; }

}  // namespace evo
