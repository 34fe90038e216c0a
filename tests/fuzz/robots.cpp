// Robots in every form of text. What is accepted is written and read again as it was.
#include "formats/robot/robot.h"
#include "target.h"

using namespace evo;

FUZZ_TARGET(text) {
  for (const Robot& robot : parse_robots(text, "input", BodyCheck::any)) {
    const std::string line = robot_to_line(robot);
    expect(robot_to_line(parse_robots(line, "line", BodyCheck::any).at(0)) == line);
    expect(parse_robots(robot_to_json(robot), "JSON", BodyCheck::any).at(0).id == robot.id);
    expect(parse_robots(robot_to_yaml(robot), "YAML", BodyCheck::any).at(0).id == robot.id);
  }
}
