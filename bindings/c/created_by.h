// What the policies that the library trains say they were made by.
#pragma once

namespace evo {

// "libevo 0.1.0 (105ad79)", with the commit of the build.
const char* created_by();

}  // namespace evo
