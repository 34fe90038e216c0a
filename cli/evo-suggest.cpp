// evo-suggest: the next batch of Bayesian optimisation.
#include <limits>

#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/robots.h"
#include "formats/io/values.h"
#include "formats/robot/children.h"
#include "formats/robot/writer.h"
#include "libevo/evolve/suggest.h"

namespace {

using namespace evo;

struct History {
  Shape shape;
  std::vector<Observation> observations;
  std::vector<Design> pending;
};

// The robots of the files, each once; all of one shape. One without a fitness is in training,
// as is one with it after the first `known`.
History read_history(const std::vector<std::string>& files, std::optional<int> known) {
  History history;
  std::set<std::string> ids;
  for (const Robot& robot : cli::read_robots(files)) {
    const Body& body = robot.body;
    if (ids.empty()) history.shape = {body.rows, body.cols};
    if (body.rows != history.shape.rows || body.cols != history.shape.cols)
      throw error(Failure::data, "robot {} is {}x{}, the first one {}x{}; one history, one shape",
                  robot.id, body.rows, body.cols, history.shape.rows, history.shape.cols);
    if (!ids.insert(robot.id).second) continue;
    if (robot.document.contains("fitness") && (!known || std::ssize(history.observations) < *known))
      history.observations.push_back(
          {body.cells, robot.fitness().value_or(std::numeric_limits<double>::quiet_NaN())});
    else
      history.pending.push_back(body.cells);
  }
  return history;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-suggest");
  int count = 25;
  std::string shape_text = "5x5";
  std::vector<std::string> files;
  std::optional<int> known;
  command.arguments(files, "FILE",
                    "robots so far, scored, or in training as if they had the fitness expected "
                    "[none]");
  command.option("-n,--count", count, "N", "bodies to propose; all valid and new").at_least(1);
  command
      .option("--known", known, "N", "of scored robots only the first so many count as such [all]")
      .at_least(1);
  command.option("--shape", shape_text, "ROWSxCOLS", "of the bodies, while there are no robots");
  command.seed_option();
  command.output_option("where the bodies go, one JSON document per line");
  command.jobs_option();
  command.example("evo-suggest -n 25 --seed 3 history.jsonl", "the next batch");
  command.example("evo-suggest -n 1 a.jsonl b.jsonl | evo-inspect robot -",
                  "the most promising body, drawn");

  return command.run(argc, argv, [&] {
    cli::keep_inputs(command.output, files);
    History history;
    if (!files.empty()) history = read_history(files, known);
    const Shape shape = history.shape.rows == 0 ? parse_shape(shape_text) : history.shape;
    cli::Workers workers(command, static_cast<std::size_t>(command.jobs));
    const SuggestedBatch batch =
        suggest(shape.rows, shape.cols, history.observations, history.pending, count,
                SuggestSettings{}, command.seed, &workers.pool);
    if (!batch.from_model) cli::log::warn("no scored robot to learn from; these bodies are random");
    RobotWriter out(command.output);
    int index = 0;
    for (const Suggestion& suggestion : batch.designs) {
      Robot robot = robot_of({suggestion.body, "evo-suggest"}, command.seed, index++);
      if (batch.from_model)
        cli::log::debug(fmt::format("{}: expected {:.4g} +- {:.2g}", robot.id, suggestion.mean,
                                    suggestion.stddev));
      out.write(std::move(robot));
    }
    out.finish();
    return 0;
  });
}
