// evo-render: pictures and videos of rollouts and robots, off-screen.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "cli/robots.h"
#include "formats/io/files.h"
#include "formats/io/hdf5.h"
#include "formats/io/values.h"
#include "formats/rollout/episodes.h"
#include "formats/rollout/rollout.h"
#include "formats/run/run.h"
#include "formats/run/run_policy.h"
#include "formats/training/policy.h"
#include "libevo/base/join.h"
#include "render/render.h"

namespace {

using namespace evo;
using render::RenderOptions;

struct Settings {
  std::optional<std::string> size;
  std::optional<std::string> width;
  std::optional<double> fps;
  std::vector<std::string> episodes;
  std::string camera;
  std::string steps;
  std::string hide;
  std::string show;
  std::optional<double> at;
  std::optional<int> strip;
  std::optional<int> panels;
  bool loop = false;
  render::Choice moments = render::Choice::event;
  bool grid = false;
  std::optional<std::string> evolution;
  std::optional<std::string> poster;
  bool race = false;
};

constexpr int most_episodes = 1'000'000'000;
constexpr int most_steps = 1'000'000'000;

render::Size parse_size(const std::string& text) {
  constexpr int most = 32'768;
  const auto [width, height] =
      parse_pair(text, "--size", most, "WIDTHxHEIGHT in pixels, such as 1280x720");
  return {width, height};
}

// One picture of an episode.
bool is_still(const Settings& settings) {
  return settings.at || settings.strip || settings.panels || settings.loop;
}

// What moves, by the ending of its file.
bool is_film(const std::string& output) {
  constexpr std::array endings{".mp4", ".webm", ".gif"};
  return std::any_of(endings.begin(), endings.end(),
                     [&](const char* ending) { return output.ends_with(ending); });
}

// One of an episode's many pictures.
void refuse_film_as_picture(const Settings& settings, const std::string& output) {
  if (output.ends_with(".png") && output.find('%') == std::string::npos && !is_still(settings))
    throw error(
        Failure::usage,
        "{}: one picture of an episode is made by --at STEP, --strip N or --panels N; a film "
        "ends in .mp4, .webm or .gif",
        output);
}

// A GIF knows no motion: every line that moves with the camera is there again in each
// frame. It is smaller and slower, unless asked, and has fewer lines.
void choose_format(const Settings& settings, bool gif, RenderOptions& options) {
  options.size = parse_size(settings.size.value_or(gif ? "640x360" : "1280x720"));
  if (settings.width) {
    const auto wide = static_cast<int>(std::lround(render::pixels_of(*settings.width)));
    options.size = {wide, (wide * 9 + 8) / 16};
  }
  options.fps = settings.fps.value_or(gif ? 25.0 : 50.0);
  options.overlays.fine_grid = !gif;
}

// "world", a window in voxels, or names of objects.
render::Camera parse_camera(const std::string& text) {
  render::Camera camera;
  if (text == "world") {
    camera.mode = render::CameraMode::world;
  } else if (text.find_first_of("0123456789") == 0 || text.starts_with('-')) {
    const std::vector<double> numbers = parse_numbers(text, "--camera");
    if (numbers.size() != 4)
      throw error(Failure::usage, "--camera: '{}' is not X,Y,WIDTH,HEIGHT in voxels", text);
    camera.window = {numbers[0], numbers[1], numbers[2], numbers[3]};
    camera.mode = render::CameraMode::fixed;
  } else {
    camera.objects = split_list(text);
  }
  return camera;
}

// "50-80", "50-" to the end.
void parse_steps(const std::string& text, RenderOptions& options) {
  if (text.empty()) return;
  const std::size_t dash = text.find('-');
  if (dash == std::string::npos)
    throw error(Failure::usage, "--steps: '{}' is not FIRST-LAST, such as 50-80, or 50-", text);
  const auto step = [](const std::string& number) {
    return static_cast<int>(parse_whole(number, "--steps", 0, most_steps));
  };
  options.from = step(text.substr(0, dash));
  if (dash + 1 < text.size()) options.to = step(text.substr(dash + 1));
}

using Switches = std::vector<std::pair<std::string, bool*>>;

std::vector<std::string> names_of(const Switches& switches) {
  std::vector<std::string> names;
  for (const auto& [name, target] : switches) names.push_back(name);
  return names;
}

// Gives `value` to those named.
void set_switches(const std::string& option, const std::string& text, const Switches& switches,
                  bool value) {
  for (const std::string& word : split_list(text)) {
    const auto found = std::ranges::find(switches, word, &Switches::value_type::first);
    if (found == switches.end())
      throw error(Failure::usage, "{}: '{}' is unknown; allowed: {}", option, word,
                  joined(names_of(switches), ", "));
    *found->second = value;
  }
}

// "0", "2", "all" of every rollout; the first episode when nothing is asked. `names`: what
// robots are called in the place of their ids, or nothing.
std::vector<render::Episode> choose_episodes(const std::vector<Rollout>& rollouts,
                                             const std::vector<std::string>& names,
                                             const std::vector<std::string>& asked) {
  std::vector<render::Episode> episodes;
  for (std::size_t k = 0; k < rollouts.size(); ++k) {
    const Rollout& rollout = rollouts[k];
    const auto add = [&](int index) {
      std::string label = rollout.robot ? rollout.robot->id : std::string();
      if (!names.empty()) label = names[k];
      if (asked.size() > 1 || (asked.size() == 1 && asked[0] == "all"))
        label += fmt::format(" episode {}", index);
      episodes.push_back({&rollout, index, std::move(label)});
    };
    if (asked.empty()) add(0);
    for (const std::string& word : asked) {
      if (word == "all") {
        for (int i = 0; i < static_cast<int>(rollout.episodes.size()); ++i) add(i);
      } else {
        add(static_cast<int>(parse_whole(word, "--episode", 0, most_episodes)));
      }
    }
  }
  return episodes;
}

// "-" is a PNG on standard output.
void write_picture(const std::string& output, const std::string& title,
                   const render::Drawing& drawing) {
  write_output(
      output, render::encode_picture(drawing, title, output == standard_stream ? "-.png" : output));
}

void render_robots(const Settings& settings, const RenderOptions& options,
                   const std::vector<std::string>& files, const std::string& output) {
  const std::vector<Robot> robots = cli::read_robots(files);
  if (robots.empty()) throw error(Failure::data, "nothing to draw: no robots were read");
  if (is_film(output))
    throw error(
        Failure::usage,
        "{}: a robot has no motion; record it (evo-eval --rollout walk.h5), then render the "
        "recording",
        output);
  const bool single = robots.size() == 1 && !settings.grid;
  write_picture(
      output, single ? "Robot " + robots.front().id : "Robots",
      single ? render::draw_robot(robots.front(), options) : render::draw_robots(robots, options));
}

render::Drawing draw_still(const Settings& settings, const RenderOptions& options,
                           const render::Episode& episode) {
  const auto layout = settings.strip ? render::Layout::strip : render::Layout::panels;
  const int count = settings.strip ? *settings.strip : *settings.panels;
  return render::draw_moments(episode, {count, layout, settings.moments}, options);
}

// Says how far a film is.
render::Progress frames_on(cli::LiveLine& line) {
  return [&line](std::size_t frames, std::size_t of) {
    if (!line.due()) return;
    const double share = static_cast<double>(frames) / static_cast<double>(of);
    line.draw(fmt::format("{:3.0f}%  {}/{} frames  {:.0f} frames/s  {}", 100.0 * share, frames, of,
                          static_cast<double>(frames) / line.seconds(),
                          cli::time_left(share, line.seconds())));
  };
}

void render_rollouts(const Settings& settings, const RenderOptions& options,
                     const std::vector<std::string>& files, const std::string& output,
                     cli::Progress progress) {
  std::vector<Rollout> rollouts;
  rollouts.reserve(files.size());
  for (const std::string& file : files) rollouts.push_back(read_rollout(file));
  std::vector<std::string> names;  // of racers, those of their files
  for (const std::string& file : files)
    if (settings.race) names.push_back(std::filesystem::path(file).stem().stem().string());
  const auto episodes = choose_episodes(rollouts, names, settings.episodes);
  if (is_still(settings)) {
    if (episodes.size() != 1 && !settings.at)
      throw error(Failure::usage,
                  "a still picture shows one episode, but {} were given; --at STEP shows several",
                  episodes.size());
    if (settings.loop) {
      if (!output.ends_with(".svg"))
        throw error(Failure::usage, "{}: --loop makes a picture that ends in .svg", output);
      write_file(output, render::draw_gait(episodes.front(), options));
      return;
    }
    const std::string of_whom = episodes.size() == 1 ? episodes.front().label
                                                     : fmt::format("by {} robots", episodes.size());
    write_picture(output, rollouts.front().task + " " + of_whom,
                  settings.at ? render::draw_moment(episodes, *settings.at, options)
                              : draw_still(settings, options, episodes.front()));
    return;
  }
  cli::LiveLine line(progress);
  if (settings.race)
    render::render_race(episodes, options, output, frames_on(line));
  else
    render::render_video(episodes, options, output, frames_on(line));
}

// The best robot of every generation that has one, with its policy; one that stays
// best counts once.
void render_evolution(const std::string& folder, const RenderOptions& options,
                      const std::string& output, cli::Progress progress) {
  const RunHistory history{RunFolder(folder)};
  std::vector<std::unique_ptr<Rollout>> rollouts;
  std::vector<render::Champion> champions;
  std::optional<std::size_t> shown;
  for (const RunHistory::Generation& generation : history.generations()) {
    std::optional<std::size_t> best;
    for (const auto& slot : generation.slots)
      if (slot && history.robots()[*slot].fitness &&
          (!best || *history.robots()[*slot].fitness > *history.robots()[*best].fitness))
        best = slot;
    if (!best) continue;
    const TrainedRobot& robot = history.robots()[*best];
    if (best == shown) {
      champions.back().last = generation.number;
      continue;
    }
    const auto found = policy_of(history.folder(), robot.robot);
    if (!found)
      throw error(Failure::no_input, "{}: is not there, so generation {} cannot be shown",
                  history.folder().policy(robot.robot.id).string(), generation.number);
    rollouts.push_back(
        std::make_unique<Rollout>(play(found->policy, found->file, cli::created_by("evo-render"))));
    champions.push_back(
        {{rollouts.back().get(), 0, ""}, generation.number, generation.number, *robot.fitness});
    shown = best;
  }
  if (champions.empty())
    throw error(Failure::data, "{}: no generation has a robot with a fitness yet", folder);
  cli::LiveLine line(progress);
  render::render_evolution(champions, options, output, frames_on(line));
}

void render_poster(const std::string& folder, const RenderOptions& options,
                   const std::string& output) {
  const RunHistory history{RunFolder(folder)};
  const auto best = history.champion_index();
  if (!best) throw error(Failure::data, "{}: no robot has a fitness yet", folder);
  const TrainedRobot& champion = history.robots()[*best];
  const auto found = policy_of(history.folder(), champion.robot);
  if (!found)
    throw error(Failure::no_input, "{}: is not there, so the best robot cannot be shown",
                history.folder().policy(champion.robot.id).string());
  const Rollout rollout = play(found->policy, found->file, cli::created_by("evo-render"));
  render::PosterContent content{rollout.task, "", {}, best_so_far(history.robots())};
  for (const std::size_t k : lineage(history.robots(), history.by_id(), *best))
    content.line.push_back({history.robots()[k].robot, history.robots()[k].generation});
  std::int64_t steps = 0;
  for (const TrainedRobot& robot : history.robots()) steps += robot.robot.steps().value_or(0);
  content.sentence =
      fmt::format("The best of {} robots, found by {} in {} generations and {:.2g} million steps",
                  history.robots().size(), history.folder().settings().text("method"),
                  history.generations().size(), static_cast<double>(steps) * 1e-6);
  write_picture(output, rollout.task + ", a run on one page",
                render::draw_poster(content, {&rollout, 0, ""}, options));
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-render");
  Settings settings;
  RenderOptions options;
  std::vector<std::string> files;
  command.output = "";
  command.arguments(files, "FILE",
                    "rollouts (HDF5) for videos and strips; robot documents for pictures of bodies "
                    "[standard input: robots]");
  command.section("Output");
  command.output_option(
      "film: walk.mp4, .webm, .gif or frames/%05d.png; still picture: .svg, .pdf, .png, or - for "
      "PNG; required");
  const cli::Option size =
      command.option("--size", settings.size, "WIDTHxHEIGHT",
                     "of the picture in pixels; strips and panels take the width, and the height "
                     "they need [1280x720; GIF 640x360]");
  command
      .option("--width", settings.width, "LENGTH",
              "of a still picture on paper, in its place: 85mm, 17cm, 3.4in or 240pt")
      .excludes({size});
  command.option("--fps", settings.fps, "N", "frames per second [50; GIF 25]");
  command.option("--speed", options.speed, "X", "playing speed; 0.5 is slow motion");
  command.option("--steps", settings.steps, "A-B",
                 "the first and the last control step shown; \"50-\" to the end [all]");
  command.section("What is shown");
  command.option("--episode", settings.episodes, "N|all",
                 "which episodes, side by side when several (repeatable) [0]");
  command.option("--camera", settings.camera, "VIEW",
                 "world: all of it; X,Y,W,H: a window, its centre and extent in voxels; else "
                 "objects to keep in view, such as robot,package [as the task says]");
  command.suggestions("--camera", [] { return std::vector<std::string>{"world"}; });
  command.choice("--theme", options.theme, "NAME",
                 {{"light", "light"}, {"dark", "dark"}, {"paper", "paper"}},
                 "light, dark, or paper: white, with signs on actuators and a legend, "
                 "for prints in grey, too");
  const Switches hidden{{"labels", &options.overlays.labels}, {"grid", &options.overlays.grid}};
  command.option("--hide", settings.hide, "WHAT",
                 "labels (task, robot, step and return), grid (lines a voxel apart), or both: "
                 "labels,grid");
  command.suggestions("--hide", [&] { return names_of(hidden); });
  using render::Tint;
  command.choice(
      "--tint", options.overlays.tint, "WHAT",
      {{"actuation", Tint::actuation},
       {"strain", Tint::strain},
       {"stress", Tint::stress},
       {"commanded", Tint::commanded},
       {"stiffness", Tint::stiffness},
       {"none", Tint::none}},
      "actuation: actuators lighter when expanded, darker when contracted; strain, "
      "stress, commanded (lengths of actuators) or stiffness, with a bar of colours; or none");
  const Switches shown{{"trail", &options.overlays.trail},
                       {"velocities", &options.overlays.velocities},
                       {"contacts", &options.overlays.contacts}};
  command.option("--show", settings.show, "WHAT",
                 "one or several of: trail (the path of the centre of mass), velocities (an arrow "
                 "at every moving point), contacts (where the robot touches something, and the "
                 "force that presses on it there)");
  command.suggestions("--show", [&] { return names_of(shown); });
  using render::Plot;
  const cli::Option plot = command.choice(
      "--plot", options.overlays.plot, "WHAT",
      {{"return", Plot::reward_sum}, {"actuation", Plot::actuation}, {"none", Plot::none}},
      "curves below the picture, in step with it: return, actuation (commanded "
      "lengths) or none");
  command.section("Films of several robots");
  const cli::Option race =
      command
          .flag("--race", settings.race,
                "all episodes in lanes with finish line, time and places; of climbers, in one "
                "world")
          .excludes({plot});
  const cli::Option evolution =
      command
          .option("--evolution", settings.evolution, "RUN_DIR",
                  "the best robot of one generation after another, changed voxels flashing")
          .excludes({race, plot});
  command.section("Still pictures");
  std::vector<cli::Option> one_of{race, evolution};  // of these, and of the stills below
  const auto alone = [&](cli::Option option) {
    option.excludes(one_of);
    one_of.push_back(option);
    return option;
  };
  alone(command.option(
      "--poster", settings.poster, "RUN_DIR",
      "a run on one page: what its best robot does, its body, the best fitness, and the "
      "bodies it goes back to"));
  alone(command.option("--at", settings.at, "STEP",
                       "one moment of an episode, or of several side by side"));
  alone(command.option(
      "--strip", settings.strip, "N",
      "N moments of an episode on one axis of the world, with the way between; side by side "
      "where they would lie on each other"));
  alone(command.option("--panels", settings.panels, "N", "N moments of an episode side by side"));
  alone(command.flag("--loop", settings.loop,
                     "a cycle of its gait that plays for ever, an .svg for pages and READMEs"));
  command.choice("--moments", settings.moments, "CHOICE",
                 {{"event", render::Choice::event},
                  {"gait", render::Choice::gait},
                  {"time", render::Choice::time}},
                 "event: more where more happens; gait: evenly spread over the episode; both in "
                 "other parts of a gait's cycle; time: evenly, whatever the gait");
  command.flag("--grid", settings.grid, "all robots read with ids and fitness");
  command.jobs_option();
  command.progress_option();
  command.example("evo-render walk.h5 -o walk.mp4", "an episode as a video");
  command.example("evo-render walk.h5 --strip 6 -o walk.svg", "its whole way on one picture");
  command.example("evo-render walk.h5 --loop --size 320x320 -o gait.svg", "its gait, for ever");
  command.example("evo-render walk.h5 --strip 4 --width 85mm --theme paper -o way.pdf",
                  "for a column of a paper");
  command.example("evo-render walk.h5 --show contacts --plot actuation -o walk.mp4",
                  "what pushes it, and what its actuators are told");
  command.example("evo-render --evolution runs/walker -o film.mp4", "an evolution");
  command.example("evo-render --poster runs/walker -o poster.pdf", "a run on one page");
  command.example("evo-sample -n 12 | evo-render --grid -o robots.png", "twelve robots");

  return command.run(argc, argv, [&] {
    if (command.output.empty())
      throw error(Failure::usage, "-o is required: what to write, such as -o walk.mp4");
    cli::keep_inputs(command.output, files);
    parse_steps(settings.steps, options);
    options.camera = parse_camera(settings.camera);
    options.workers = command.jobs;
    set_switches("--hide", settings.hide, hidden, false);
    set_switches("--show", settings.show, shown, true);
    if (settings.evolution) {
      if (!files.empty())
        throw error(Failure::usage, "--evolution shows the robots of a run, without files");
      refuse_film_as_picture(settings, command.output);
      choose_format(settings, command.output.ends_with(".gif"), options);
      if (!settings.fps) options.fps = std::min(options.fps, 30.0);
      render::check_options(options);
      render_evolution(*settings.evolution, options, command.output, command.progress_style());
      return 0;
    }
    if (settings.poster) {
      if (!files.empty())
        throw error(Failure::usage, "--poster shows the best robot of a run, without files");
      options.from = 0;
      options.to.reset();
      render_poster(*settings.poster, options, command.output);
      return 0;
    }
    for (const std::string& file : files)
      if (file != standard_stream && !std::filesystem::exists(file))
        throw error(Failure::no_input, "{}: cannot be opened: No such file or directory", file);
    const bool rollouts =
        !files.empty() && std::all_of(files.begin(), files.end(), [](const std::string& file) {
          return file != standard_stream && hdf5::is_hdf5(file) &&
                 hdf5::Reader(file).exists("/episode_0");
        });
    const bool film = rollouts && !settings.grid;
    const bool still = is_still(settings);
    command.only(film, {"--episode", "--steps", "--camera", "--show", "--plot"}, "rollouts");
    command.only(film && !still, {"--fps", "--speed"}, "films of rollouts");
    command.only(settings.panels || settings.strip, {"--moments"}, "--strip and --panels");
    command.only(!film || still, {"--width"}, "still pictures");
    command.only(!still || settings.loop, {"--steps"}, "films and --loop");
    choose_format(settings, film && command.output.ends_with(".gif"), options);
    render::check_options(options);
    if (film) {
      refuse_film_as_picture(settings, command.output);
      render_rollouts(settings, options, files, command.output, command.progress_style());
    } else {
      if (settings.race)
        throw error(Failure::usage, "--race needs rollouts, made with evo-eval --rollout");
      if (is_still(settings))
        throw error(
            Failure::usage,
            "--at, --strip, --panels and --loop need a rollout; for robots there is --grid");
      render_robots(settings, options, files, command.output);
    }
    return 0;
  });
}
