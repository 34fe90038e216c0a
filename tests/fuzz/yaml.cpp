// What people write by hand, by its `format`: tasks, profiles, settings.
#include "formats/io/node.h"

#include "formats/run/neat.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/training.h"
#include "target.h"

using namespace evo;

FUZZ_TARGET(text) {
  const DataFolders nowhere{};
  const auto attempt = [&](const auto& reader) {
    try {
      reader(Node::yaml(text, "input"));
    } catch (const Error&) {
      // Not this one.
    }
  };
  attempt([&](const Node& node) {
    const TrainingSettings settings = training_from_yaml(node, "/nowhere", nowhere);
    (void)training_to_yaml(settings);
  });
  attempt([](const Node& node) { (void)neat_settings_from_yaml(node); });
  try {
    (void)parse_neat_settings(std::string(text), "input");
  } catch (const Error&) {
    // Nor this one.
  }
  attempt([&](const Node& node) { (void)physics_from_yaml(node, "/nowhere", nowhere); });
  const TaskSpec task = parse_task(text, "input", "/nowhere", nowhere);
  const std::string written = task_to_yaml(task);
  expect(task_to_yaml(parse_task(written, "written", "/nowhere", nowhere)) == written);
}
