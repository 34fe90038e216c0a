// evo-env: environments that any program can step, over pipes.
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "cli/command.h"
#include "cli/env/serve.h"
#include "cli/robots.h"
#include "cli/task_options.h"
#include "formats/io/files.h"

namespace {

using namespace evo;

struct Settings {
  cli::TaskOptions task;
  int envs = 1;
  decltype(&cli::serve_lines) serve = cli::serve_lines;
};

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-env");
  Settings settings;
  std::vector<std::string> files;
  command.arguments(files, "ROBOT...",
                    {{"ROBOT...",
                      "files of robots; standard input carries the requests, which evo-formats(5) "
                      "describes"}});
  settings.task.add_to(command);
  command.option("--envs", settings.envs, "N", "environments of each robot, stepped together");
  command.choice("--mode", settings.serve, "MODE",
                 {{"json", cli::serve_lines}, {"binary", cli::serve_frames}},
                 "json (a request a line, an answer a line) or binary (frames, for speed)");
  command.seed_option();
  command.jobs_option();
  command.example("echo '{\"reset\":{\"seed\":1}}' | evo-env --task Walker-v0 walker.json",
                  "what the environment is, and its first observation");
  command.example("evo-env --task Carrier-v0 --envs 16 --mode binary -j 1 walker.json",
                  "as the Python package starts it for a batch of sixteen");

  return command.run(argc, argv, [&] {
    const TaskSpec task = settings.task.load();
    if (files.empty() || std::find(files.begin(), files.end(), standard_stream) != files.end())
      throw Error(Failure::usage, "name a file of robots: standard input carries the requests");
    std::vector<Robot> robots = cli::read_robots(files);
    if (robots.empty()) throw error(Failure::data, "{}: there are no robots", files.front());
    // A client that is gone ends the session, not the process.
    std::signal(SIGPIPE, SIG_IGN);
    Session session(task, std::move(robots), settings.envs, command.seed, command.jobs);
    settings.serve(session, STDIN_FILENO, STDOUT_FILENO);
    return 0;
  });
}
