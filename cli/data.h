// Where the tools find tasks and profiles by name.
#pragma once

#include "formats/data_folders.h"

namespace evo::cli {

// Folders in $EVO_TASKS (separated by colons), the one installed beside the
// executable, the one of the checkout the executable was built from.
DataFolders data_folders();

}  // namespace evo::cli
