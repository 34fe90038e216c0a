#include "render/scene/camera.h"

#include <algorithm>
#include <cmath>

namespace evo::render {
namespace {

// Room around what is followed, as in the benchmark's viewer, voxels a side.
constexpr double margin_x = 5.0;
constexpr double margin_y = 3.0;
constexpr double least_margin = 1.0;  // that fast motion may use up
constexpr double extra = 1.1;         // of the extents
constexpr double earth_share = 0.14;  // of the picture's height, below the floor

// Widths of the smoothing kernels, control steps.
constexpr double smooth_x = 18;
constexpr double smooth_y = 30;
constexpr double smooth_zoom = 40;
constexpr int zoom_window = 60;  // half width of the maximum the zoom is drawn from

using Series = std::vector<double>;

// A Gaussian mean; the ends are repeated outwards.
Series smoothed(const Series& values, double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  Series kernel;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) {
    kernel.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += kernel.back();
  }
  const int n = static_cast<int>(values.size());
  Series out(values.size());
  for (int i = 0; i < n; ++i) {
    double mean = 0;
    for (int k = -reach; k <= reach; ++k)
      mean += kernel[static_cast<std::size_t>(k) + static_cast<std::size_t>(reach)] *
              values[static_cast<std::size_t>(std::clamp(i + k, 0, n - 1))];
    out[static_cast<std::size_t>(i)] = mean / sum;
  }
  return out;
}

Series windowed_maximum(const Series& values, int reach) {
  const int n = static_cast<int>(values.size());
  Series out(values.size());
  for (int i = 0; i < n; ++i) {
    const auto first = values.begin() + std::max(0, i - reach);
    const auto end = values.begin() + std::min(n, i + reach + 1);
    out[static_cast<std::size_t>(i)] = *std::max_element(first, end);
  }
  return out;
}

// The centre nearest to `centre` whose window of `extent` holds [low, high] with
// a margin, as far as it fits.
double keep_inside(double centre, double extent, double low, double high, double margin) {
  const double half = extent / 2 - std::min(margin, std::max(0.0, (extent - (high - low)) / 2));
  return std::clamp(centre, std::min(high - half, low + half), std::max(high - half, low + half));
}

// The earth below the floor takes a small share of the picture at most: the
// window is moved up for that, as far as `box` stays inside.
double raise(double centre_y, double height, const Bounds& box) {
  const double lowest = height / 2 - earth_share * height;  // centre for that share
  const double highest = box.y0 - least_margin + height / 2;
  return std::max(centre_y, std::min(lowest, std::max(highest, centre_y)));
}

std::vector<ViewRect> follow_path(const std::vector<Bounds>& boxes, double aspect, double zoom) {
  Series x, y, width;
  for (const Bounds& box : boxes) {
    x.push_back((box.x0 + box.x1) / 2);
    y.push_back((box.y0 + box.y1) / 2);
    const double w = extra * (box.x1 - box.x0 + 2 * margin_x / zoom);
    const double h = extra * (box.y1 - box.y0 + 2 * margin_y / zoom);
    width.push_back(std::max(w, h * aspect));
  }
  x = smoothed(x, smooth_x);
  y = smoothed(y, smooth_y);
  width = smoothed(windowed_maximum(width, zoom_window), smooth_zoom);
  std::vector<ViewRect> path;
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    const Bounds& box = boxes[t];
    ViewRect view{x[t], y[t], width[t], width[t] / aspect};
    view.centre_y = raise(view.centre_y, view.height, box);
    view.centre_x = keep_inside(view.centre_x, view.width, box.x0, box.x1, least_margin);
    view.centre_y = keep_inside(view.centre_y, view.height, box.y0, box.y1, least_margin);
    path.push_back(view);
  }
  return path;
}

ViewRect world_view(const std::vector<Bounds>& boxes, double aspect) {
  constexpr double margin = 2.0;        // voxels
  constexpr double label_share = 0.10;  // of the height, above everything
  Bounds all;
  for (const Bounds& box : boxes) all.cover(box);
  all.y0 = std::min(all.y0, 0.0);
  all.y1 += label_share * (all.y1 - all.y0);
  ViewRect view = fit({(all.x0 + all.x1) / 2, (all.y0 + all.y1) / 2, all.x1 - all.x0 + 2 * margin,
                       all.y1 - all.y0 + 2 * margin},
                      aspect);
  view.centre_y = raise(view.centre_y, view.height, all);
  view.centre_y = keep_inside(view.centre_y, view.height, all.y0, all.y1, margin);
  return view;
}

}  // namespace

std::vector<ViewRect> camera_path(const std::vector<Bounds>& boxes, const Camera& camera,
                                  double aspect) {
  switch (camera.mode) {
    case CameraMode::follow:
      return follow_path(boxes, aspect, camera.zoom);
    case CameraMode::world:
      return std::vector<ViewRect>(boxes.size(), world_view(boxes, aspect));
    case CameraMode::fixed:
      break;
  }
  return std::vector<ViewRect>(boxes.size(), fit(camera.window, aspect));
}

}  // namespace evo::render
