// What a user can choose about pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/painters/image.h"

namespace evo::render {

// A window of the world, in voxels; y counts upwards.
struct ViewRect {
  double centre_x = 0;
  double centre_y = 0;
  double width = 0;
  double height = 0;
};

enum class CameraMode {
  follow,  // keep the named objects in view, smoothly
  world,   // everything, all the time
  fixed,   // `window`
};

struct Camera {
  CameraMode mode = CameraMode::follow;
  std::vector<std::string> objects;        // to follow; empty: what the task says
  double zoom = 1.0;                       // of follow; 2 leaves half the room around
  ViewRect window{12.0, 4.0, 40.0, 20.0};  // fixed; the benchmark viewer's own
};

// What the colours of voxels tell.
enum class Tint {
  none,       // their kinds alone
  actuation,  // kinds, and actuators lighter when expanded, darker when contracted
  strain,     // how much larger or smaller than at rest (quantity.h)
  stress,     // how strongly their springs pull or push
  commanded,  // the length an actuator is told to have
  stiffness,  // the factor that a robot gives the voxel's springs
};

// Curves below a picture, in step with it.
enum class Plot {
  none,
  reward_sum,  // the return so far
  actuation,   // the commanded length of every actuator
};

struct Overlays {
  bool labels = true;     // task, robot, step, time, return
  bool grid = true;       // lines a voxel apart, distances along the floor
  bool fine_grid = true;  // else only every tenth line
  Tint tint = Tint::actuation;
  bool trail = false;       // the path of the first object's centre of mass
  bool velocities = false;  // an arrow at every point of what moves
  bool contacts = false;    // where the robot touches something, and what pushes it there
  Plot plot = Plot::none;
  bool background = true;  // else white
  bool edges = true;       // outlines of objects, seams between their cells
  bool voxels = true;      // cells filled
};

struct RenderOptions {
  Size size{1280, 720};
  double fps = 50.0;
  double speed = 1.0;           // 0.5 is slow motion
  int from = 0;                 // first step shown
  std::optional<int> to;        // last step shown; the end of the episode
  std::string theme = "light";  // or "dark", "paper"
  Camera camera;
  Overlays overlays;
  int workers = 1;  // processes
};

// "85mm", "17cm", "3.4in" or "240pt" as pixels of 1/96 inch. Throws Error(usage).
double pixels_of(const std::string& length);

// Throws Error(usage) naming the option and what it may be.
void check_options(const RenderOptions& options);

}  // namespace evo::render
