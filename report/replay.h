// Episodes small enough to lie in a page by the dozen, for replay.js to draw.
#pragma once

#include <string>

#include "formats/io/json.h"
#include "formats/rollout/rollout.h"

namespace evo::report {

// The first episode of a rollout: every second step, positions in 1/100 voxel.
//   {"points": of all that moves, the robot's first; "robot": how many are its own,
//    "frames", "stride": steps a frame, "steps", "scale": units a voxel,
//    "body": [[letter, tl, tr, bl, br]..], "objects": likewise,
//    "outline": [[a, b]..] surfaces, "ending": why it was over,
//    "packed": base64 of raw deflate of the numbers below}
// Numbers: the return at each frame in 1/1000, then x and y of each point; of each
// series the first value, its first difference, then second differences, zigzag
// (0, -1, 1, -2, ..), 7 bits a byte, the lowest first, the high bit on all but the
// last. Throws Error(data) for a rollout that cannot be drawn.
Json replay_of(const Rollout& rollout);

// What does not move, in voxels: {"fixed": [[x, y, width, height]..]}.
Json world_of(const Rollout& rollout);

}  // namespace evo::report
