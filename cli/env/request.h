// Requests as JSON objects with one verb each (docs/evo-env.md), the same in
// lines and in frames.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bindings/c/session.h"
#include "bindings/c/voxels.h"
#include "formats/io/json.h"
#include "render/still.h"

namespace evo::cli {

struct Answer {
  enum class Kind { state, document, picture, saved };
  Kind kind = Kind::state;
  std::vector<int> environments;  // whose state was asked for, of Kind::state and saved
  Json document;
  render::Image picture;
  std::vector<std::vector<std::uint8_t>> saved;
};

// The first thing a client hears: format, task, robots, lengths, bounds.
Json describe(const Session& session);

class Requests {
 public:
  explicit Requests(Session& session) : session_(session) {}

  // Throws Error(data) for what is not a request, Error(usage) for one that
  // cannot be fulfilled; the session is then as it was.
  Answer answer(const Json& request, const std::string& where);

  // What voxels see, built when it is first asked for.
  const SessionVoxels& voxels() { return voxels_ ? *voxels_ : voxels_.emplace(session_); }

 private:
  Answer step(const Json& request);
  Answer draw(const Json& wanted);
  Answer save(const Json& wanted);
  Answer restore(const Json& wanted);

  Session& session_;
  std::optional<SessionVoxels> voxels_;
  std::vector<double> actions_;       // of all environments
  std::vector<std::uint8_t> active_;  // of all environments
};

// The state of some environments as an object of rows.
Json state_document(const Session& session, const std::vector<int>& environments);

}  // namespace evo::cli
