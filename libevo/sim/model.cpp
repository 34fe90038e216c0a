#include "libevo/sim/model.h"

#include "libevo/sim/compiled.h"

namespace evo {

Model::Model(const World& world, const Physics& physics)
    : compiled_(std::make_unique<const Compiled>(compile(world, physics))) {}
Model::~Model() = default;
Model::Model(Model&&) noexcept = default;

const Physics& Model::physics() const { return compiled_->physics; }
const std::vector<ModelObject>& Model::objects() const { return compiled_->objects; }
const std::vector<ModelCell>& Model::cells() const { return compiled_->cells; }
const std::vector<Vec2>& Model::initial_positions() const { return compiled_->initial_positions; }
int Model::points() const { return static_cast<int>(compiled_->initial_positions.size()); }
int Model::actuators() const { return compiled_->actuators; }

int Model::object_index(const std::string& name) const {
  for (std::size_t i = 0; i < compiled_->objects.size(); ++i)
    if (compiled_->objects[i].name == name) return static_cast<int>(i);
  return -1;
}

}  // namespace evo
