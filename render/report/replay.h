// Episodes small enough to lie in a page by the dozen, for replay.js to draw.
#pragma once

#include "formats/io/json.h"
#include "formats/rollout/rollout.h"

namespace evo::report {

// Control steps from frame to frame: so that nothing can be told from the episode itself, and
// the fewest that still look it, of robots that few will look at.
inline constexpr int fine_stride = 2;
inline constexpr int coarse_stride = 4;

// The first episode of a rollout: every so many steps, positions in 1/100 voxel.
//   {"points": of all that moves, the robot's first; "robot": how many are its own,
//    "frames", "stride": steps a frame, "steps", "scale": units a voxel,
//    "body": [[letter, tl, tr, bl, br]..], "objects": likewise,
//    "outline": [[a, b]..] surfaces, "moved": voxels to the right, "ending": why it was over,
//    "packed": base64 of raw deflate of the numbers below}
// Numbers: the return at each frame in 1/1000, then x and y of each point; of each
// series the first value, its first difference, then second differences, zigzag
// (0, -1, 1, -2, ..), 7 bits a byte, the lowest first, the high bit on all but the
// last. Throws Error(data) for a rollout that cannot be drawn.
Json replay_of(const Rollout& rollout, int stride = fine_stride);

// What does not move, in voxels: {"fixed": [[x, y, width, height]..]}.
Json world_of(const Rollout& rollout);

}  // namespace evo::report
