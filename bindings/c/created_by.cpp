// A source of its own, with as little as it takes, since it is compiled anew for every commit.
#include "version.h"

namespace evo {

const char* created_by() { return "libevo " EVO_VERSION " (" EVO_COMMIT ")"; }

}  // namespace evo
