// Tasks and robots of evo/evo.h.

#include "bindings/c/handles.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"

using namespace evo::c;  // NOLINT(google-build-using-namespace)
using evo::Failure;

namespace evo::c {

std::unique_ptr<evo_task> task_of(TaskSpec spec) {
  std::string yaml = task_to_yaml(spec);
  std::string physics = physics_profiles().to_yaml(spec.physics);
  return std::make_unique<evo_task>(evo_task{std::move(spec), std::move(yaml), std::move(physics)});
}

std::unique_ptr<evo_robots> list_of(std::vector<Robot> robots) {
  std::vector<std::string> json;
  for (const Robot& robot : robots) json.push_back(robot_to_line(robot));
  return std::make_unique<evo_robots>(evo_robots{std::move(robots), std::move(json)});
}

const Robot& robot_at(const evo_robots& robots, std::size_t index) {
  if (index >= robots.list.size())
    throw error(Failure::usage, "there is no robot {}: the list has {}", index, robots.list.size());
  return robots.list[index];
}

}  // namespace evo::c

int evo_task_open(const char* name_or_file, evo_task** task) {
  return open(task, [&] {
    return task_of(evo::load_task(text_of(name_or_file, "name_or_file"), data_folders()));
  });
}

void evo_task_free(evo_task* task) { close(task); }

int evo_task_set_physics(evo_task* task, const char* const* words, size_t count) {
  return guarded([&] {
    evo::TaskSpec changed = object_of(task).spec;
    evo::change_physics(changed, texts_of(words, count, "words"), data_folders());
    object_of(task) = *task_of(std::move(changed));
  });
}

int evo_task_describe(const evo_task* task, evo_task_facts* facts, size_t size) {
  return guarded([&] {
    const auto& [spec, yaml, physics] = object_of(task);
    hand_over({spec.name.c_str(), yaml.c_str(), spec.episode_steps, spec.hold,
               spec.physics.min_target, spec.physics.max_target, physics.c_str()},
              facts, size);
  });
}

int evo_robots_read(const char* file, evo_robots** robots) {
  return open(robots, [&] { return list_of(evo::read_robots(text_of(file, "file"))); });
}

int evo_robots_parse(const char* text, evo_robots** robots) {
  return open(robots, [&] { return list_of(evo::parse_robots(text_of(text, "text"), "robots")); });
}

int evo_robots_new(evo_robots** robots) {
  return open(robots, [] { return list_of({}); });
}

int evo_robots_append(evo_robots* robots, const evo_robots* others, size_t index) {
  return guarded([&] {
    evo_robots& list = object_of(robots);
    const evo::Robot robot = robot_at(object_of(others), index);
    list.json.push_back(evo::robot_to_line(robot));
    list.list.push_back(robot);
  });
}

void evo_robots_free(evo_robots* robots) { close(robots); }

int evo_robots_count(const evo_robots* robots, size_t* count) {
  return guarded([&] { target(count, "count") = object_of(robots).list.size(); });
}

int evo_robots_describe(const evo_robots* robots, size_t index, evo_robot_facts* facts,
                        size_t size) {
  return guarded([&] {
    const evo_robots& all = object_of(robots);
    const evo::Robot& robot = robot_at(all, index);
    static_assert(sizeof(evo::Voxel) == 1 && static_cast<int>(evo::Voxel::fixed) == EVO_FIXED);
    hand_over({robot.id.c_str(), all.json[index].c_str(), robot.body.rows, robot.body.cols,
               reinterpret_cast<const std::uint8_t*>(robot.body.cells.data())},
              facts, size);
  });
}
