// The two ways to talk to evo-env over descriptors, until the client has closed
// its end (docs/evo-env.md). A request that cannot be fulfilled is answered and
// changes nothing. Both return when the client is done or gone and throw
// Error(data) when the input ended within a request or can no longer be told
// apart into requests, after answering that, too.
#pragma once

#include "bindings/c/session.h"

namespace evo::cli {

void serve_lines(Session& session, int input, int output);   // JSON, one object a line
void serve_frames(Session& session, int input, int output);  // binary

}  // namespace evo::cli
