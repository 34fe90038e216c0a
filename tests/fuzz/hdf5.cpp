// Rollouts, policies and checkpoints; actions in CSV as well, which are read from the
// same files.
#include "formats/io/hdf5.h"

#include <sys/mman.h>
#include <unistd.h>

#include "formats/rollout/rollout.h"
#include "formats/training/policy.h"
#include "target.h"

using namespace evo;

FUZZ_TARGET(bytes) {
  static const int file = ::memfd_create("input", 0);
  expect(file >= 0 && ::ftruncate(file, 0) == 0);
  expect(::pwrite(file, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  const auto attempt = [&](const auto& reader) {
    try {
      reader();
    } catch (const Error&) {
      // Not this one.
    }
  };
  attempt([&] { (void)read_rollout(path); });
  attempt([&] { (void)read_policy(path); });
  attempt([&] { (void)read_checkpoint(path, {}); });
  attempt([&] { (void)read_draws(path); });
  (void)read_actions(path);
}
