// evo-train: a controller for every robot read.
#include "cli/robots.h"
#include "cli/training.h"

int main(int argc, char** argv) {
  using namespace evo;
  cli::Command command("evo-train", "trains a controller for each robot read");
  cli::TrainingOptions options;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "robots [standard input]");
  options.add_to(command);
  command.example("evo-sample -n 4 | evo-train --task Walker-v0 --steps 102400 --out-dir policies",
                  "four random robots, trained in parallel");
  command.example("evo-train best.json --task Climber-v0 --train paper --out-dir climb --resume",
                  "with the settings of the paper, going on after an interruption");

  return command.run(argc, argv, [&] {
    const std::vector<Robot> robots = cli::read_robots(files);
    cli::OrderedWriter out(command.output);
    const int status =
        cli::train_robots(command, options, robots, [&](const cli::Trained& trained) {
          if (trained.robot) out.put(trained.index, *trained.robot);
        });
    if (status == 0)
      out.finish();
    else
      command.warn(cli::how_to_go_on);
    return status;
  });
}
