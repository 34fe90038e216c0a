// MAP-Elites: children of the fittest robot of every kind (docs/methods.md, "Quality and
// diversity"; libevo/evolve/archive.h).
#pragma once

#include <map>

#include "libevo/evolve/method.h"

namespace evo {

class MapElites {
 public:
  static constexpr const char* name = "map";
  static constexpr bool told_again = false;
  static constexpr bool any_founders = true;
  // Throws what GridArchive throws.
  explicit MapElites(const EvolutionSettings& settings);

  Proposal propose(int number, std::span<const Body> pending, std::set<std::string>& seen);
  // An elite stays until a robot is fitter.
  void tell(const ScoredRobot& robot);
  MethodState save() const;
  void load(MethodState state);

 private:
  void file(const ScoredRobot& robot);

  EvolutionSettings settings_;
  GridArchive archive_;
  std::map<GridArchive::Cell, ScoredRobot> elites_;
  int told_ = 0;
};

}  // namespace evo
