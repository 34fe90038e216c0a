// Between a page and its module. Functions are plain C, so that nothing but numbers and
// addresses crosses the border. Texts are UTF-8 and end with 0; what a function gets, it
// copies. One that can fail returns how (evo::Failure, 0 for success); evo_answer() is then
// the error's line, otherwise what the function has to say.
#pragma once

#include <functional>
#include <string>

#include "formats/io/data_folders.h"

// Kept by the linker, and visible to the page.
#define EVO_EXPORTED __attribute__((used, visibility("default")))

extern "C" {
EVO_EXPORTED const char* evo_answer();
// A file that tasks and profiles may be found in: "tasks/Walker-v0.yaml".
EVO_EXPORTED void evo_give_file(const char* path, const char* text);
}

namespace evo::web {

std::string& answer();
// Does the work with an empty answer, which becomes the error's line where it throws.
int guarded(const std::function<void()>& work);
const DataFolders& folders();  // of the files given

}  // namespace evo::web
