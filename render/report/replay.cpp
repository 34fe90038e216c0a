#include "render/report/replay.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/io/base64.h"
#include "formats/rollout/ending.h"
#include "libevo/task/spec.h"
#include "render/scene/clip.h"

namespace evo::report {
namespace {

constexpr double scale = 100.0;  // units a voxel
constexpr double returns = 1000.0;

class Packer {
 public:
  // See replay.h.
  void series(const std::vector<long>& values) {
    long before = 0;
    long slope = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const long difference = values[k] - before;
      put(k < 2 ? difference : difference - slope);
      if (k > 0) slope = difference;
      before = values[k];
    }
  }

  std::string finish() const {
    z_stream stream{};
    constexpr int raw = -15;  // no header, the largest window
    constexpr int memory = 9;
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, raw, memory, Z_DEFAULT_STRATEGY) !=
        Z_OK)
      throw Error(Failure::work, "zlib cannot start");
    std::string packed(deflateBound(&stream, bytes_.size()), '\0');
    stream.next_in = const_cast<Bytef*>(bytes_.data());
    stream.avail_in = static_cast<uInt>(bytes_.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());  // NOLINT: bytes
    stream.avail_out = static_cast<uInt>(packed.size());
    const int code = deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    if (code != Z_STREAM_END) throw Error(Failure::work, "zlib cannot pack an episode");
    return packed;
  }

 private:
  void put(long value) {
    auto rest = value < 0 ? 2 * static_cast<unsigned long>(-value) - 1
                          : 2 * static_cast<unsigned long>(value);
    for (; rest >= 128; rest /= 128) bytes_.push_back(static_cast<Bytef>(128 | (rest % 128)));
    bytes_.push_back(static_cast<Bytef>(rest));
  }

  std::vector<Bytef> bytes_;
};

// New numbers of the points of everything that moves, the robot first.
std::vector<int> moving_points(const render::Mesh& mesh, std::size_t& robot_points) {
  std::vector<int> points;
  for (const bool robot : {true, false}) {
    for (const ModelObject& object : mesh.objects)
      if (!object.is_static && (object.name == robot_name) == robot)
        for (int k = 0; k < object.points; ++k) points.push_back(object.first_point + k);
    if (robot) robot_points = points.size();
  }
  return points;
}

}  // namespace

Json replay_of(const Rollout& rollout, int stride) {
  const render::Clip clip({&rollout, 0, ""}, {}, 1.5);
  const render::Mesh& mesh = clip.mesh();
  std::size_t robot_points = 0;
  const std::vector<int> points = moving_points(mesh, robot_points);
  std::map<int, int> number;
  for (std::size_t k = 0; k < points.size(); ++k) number[points[k]] = static_cast<int>(k);

  std::vector<int> frames;
  for (int step = 0; step < clip.steps(); step += stride) frames.push_back(step);
  frames.push_back(clip.steps());
  Packer packer;
  const auto pack = [&](const auto& value) {
    std::vector<long> series;
    for (const int step : frames) series.push_back(std::lround(value(step)));
    packer.series(series);
  };
  pack([&](int step) { return returns * clip.score(step); });
  for (const int point : points) {
    const auto k = static_cast<std::size_t>(point);
    pack([&](int step) { return scale * clip.points(step)[k].x; });
    pack([&](int step) { return scale * clip.points(step)[k].y; });
  }

  double moved = 0.0;
  for (std::size_t k = 0; k < robot_points; ++k) {
    const auto point = static_cast<std::size_t>(points[k]);
    moved += clip.points(clip.steps())[point].x - clip.points(0)[point].x;
  }
  moved = std::round(moved / static_cast<double>(std::max<std::size_t>(1, robot_points)));

  Json body = Json::array();
  Json objects = Json::array();
  Json outline = Json::array();
  for (std::size_t k = 0; k < mesh.objects.size(); ++k) {
    const ModelObject& object = mesh.objects[k];
    if (object.is_static) continue;
    for (int c = object.first_cell; c < object.first_cell + object.cells; ++c) {
      const ModelCell& cell = mesh.cells[static_cast<std::size_t>(c)];
      Json one = Json::array({std::string(1, cell.type == Voxel::fixed ? '#' : letter(cell.type))});
      for (const int point : cell.points) one.push_back(number.at(point));
      (object.name == robot_name ? body : objects).push_back(std::move(one));
    }
    for (std::size_t e = mesh.first_edge[k]; e < mesh.first_edge[k + 1]; ++e)
      if (mesh.edges[e].other < 0)
        outline.push_back({number.at(mesh.edges[e].a), number.at(mesh.edges[e].b)});
  }
  return {{"points", points.size()},
          {"robot", robot_points},
          {"frames", frames.size()},
          {"stride", stride},
          {"steps", clip.steps()},
          {"rate", clip.steps_per_second()},
          {"scale", scale},
          {"body", std::move(body)},
          {"objects", std::move(objects)},
          {"outline", std::move(outline)},
          {"moved", moved},
          {"ending", ending(rollout, rollout.episodes.front()).text},
          {"packed", base64(packer.finish())}};
}

Json world_of(const Rollout& rollout) {
  const render::Clip clip({&rollout, 0, ""}, {}, 1.5);
  const auto points = clip.points(0);
  Json fixed = Json::array();
  for (const ModelObject& object : clip.mesh().objects) {
    if (!object.is_static) continue;
    for (int c = object.first_cell; c < object.first_cell + object.cells; ++c) {
      const auto& cell = clip.mesh().cells[static_cast<std::size_t>(c)];
      const Vec2 low = points[static_cast<std::size_t>(cell.points[2])];
      const double x = std::round(low.x * scale) / scale;
      const double y = std::round(low.y * scale) / scale;
      // Cells of a row that follow each other are one box.
      if (!fixed.empty()) {
        Json& box = fixed.back();
        if (box[1] == y && box[0].get<double>() + box[2].get<double>() == x) {
          box[2] = box[2].get<double>() + 1;
          continue;
        }
      }
      fixed.push_back({x, y, 1.0, 1.0});
    }
  }
  // So are boxes of one width that lie on each other.
  for (std::size_t k = 1; k < fixed.size(); ++k)
    for (std::size_t above = 0; above < k; ++above) {
      const Json low = fixed[k];
      if (fixed[above][0] != low[0] || fixed[above][2] != low[2] ||
          fixed[above][1].get<double>() != low[1].get<double>() + low[3].get<double>())
        continue;
      fixed[above][1] = low[1];
      fixed[above][3] = fixed[above][3].get<double>() + low[3].get<double>();
      fixed.erase(k--);
      break;
    }
  return {{"fixed", std::move(fixed)}};
}

}  // namespace evo::report
