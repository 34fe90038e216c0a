// Evolution without generations. Robot k is proposed from exactly the scores of
// robots 0 .. k-W-1 (setting `window`, W), never from what happens to be there: the
// run is the same on one core and on a thousand, in whatever order its trainings
// end, and nobody waits for a generation. Until then W robots may be in training.
//
// The methods are those of libevo/evolve/methods.h.
//
// Robots are filed as generations of `pop` robots each, by number.
#pragma once

#include "evolution/breeding.h"
#include "formats/io/data_folders.h"
#include "formats/run/run.h"

namespace evo {

// Makes sure that the first `robots` robots of the run are in its populations. `breeding`
// is that of the setting mutate_options. Throws Error(no_input) when a score they need is
// missing, Error(usage) for a run with generations, more robots than the run has, or an
// unknown method. One process at a time.
void propose_robots(const RunFolder& run, const Breeding& breeding, const DataFolders& folders,
                    int robots);

}  // namespace evo
