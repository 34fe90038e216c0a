// Frames drawn by several processes and handed over in order. GL contexts in
// threads of one process take turns; processes do not. Each worker is forked
// with a pipe of its own, into which it writes every n-th frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "render/painters/painter.h"

namespace evo::render {

struct FrameJob {
  std::size_t frames = 0;
  std::size_t frame_bytes = 0;
  int workers = 1;  // processes
  // Called in a worker: fills the bytes.
  std::function<void(Painter& painter, std::size_t frame, std::span<std::uint8_t> bytes)> draw;
  // Called here, in order of frames.
  std::function<void(std::size_t frame, std::span<const std::uint8_t> bytes)> take;
};

// Throws what `draw` or `take` threw (an exception of a worker keeps its kind
// and message), or Error(work) when a worker died. All workers are gone when it
// returns. Call it from a thread that outlives the call, in a process that owns
// no Painter.
void run_workers(const FrameJob& job);

}  // namespace evo::render
