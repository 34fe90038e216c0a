#include "render/scene/mesh.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace evo::render {
namespace {

// Joins surface edges of one look end to end.
class Tracer {
 public:
  explicit Tracer(std::vector<Mesh::Edge> edges) : edges_(std::move(edges)), used_(edges_.size()) {
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      at_[edges_[k].a].push_back(k);
      at_[edges_[k].b].push_back(k);
    }
  }

  // Open lines first, from their ends; what is left are closed ones.
  std::vector<Mesh::Outline> trace(bool fixed) {
    std::vector<Mesh::Outline> lines;
    for (const bool ends_only : {true, false})
      for (std::size_t k = 0; k < edges_.size(); ++k)
        for (const int start : {edges_[k].a, edges_[k].b})
          if (!used_[k] && (!ends_only || at_[start].size() % 2 == 1))
            lines.push_back(walk(start, k, fixed));
    return lines;
  }

 private:
  Mesh::Outline walk(int start, std::size_t edge, bool fixed) {
    Mesh::Outline line{{start}, false, fixed};
    for (std::optional<std::size_t> next = edge; next; next = follow(line.points.back(), *next)) {
      used_[*next] = true;
      const Mesh::Edge& e = edges_[*next];
      line.points.push_back(e.a == line.points.back() ? e.b : e.a);
    }
    line.closed = line.points.size() > 3 && line.points.back() == start;
    if (line.closed) line.points.pop_back();
    return line;
  }

  // Where two corners touch, the border of the same cell continues.
  std::optional<std::size_t> follow(int point, std::size_t from) const {
    std::optional<std::size_t> next;
    for (const std::size_t k : at_.at(point)) {
      if (used_[k]) continue;
      if (!next || edges_[k].cell == edges_[from].cell) next = k;
    }
    return next;
  }

  std::vector<Mesh::Edge> edges_;
  std::vector<bool> used_;
  std::map<int, std::vector<std::size_t>> at_;  // edges at a point
};

std::vector<Mesh::Outline> outlines(const Mesh& mesh, std::size_t object) {
  std::vector<Mesh::Outline> all;
  for (const bool fixed : {true, false}) {
    std::vector<Mesh::Edge> surfaces;
    for (std::size_t k = mesh.first_edge[object]; k < mesh.first_edge[object + 1]; ++k) {
      const Mesh::Edge& edge = mesh.edges[k];
      const bool terrain = mesh.cells[static_cast<std::size_t>(edge.cell)].type == Voxel::fixed;
      if (edge.other < 0 && terrain == fixed) surfaces.push_back(edge);
    }
    const auto lines = Tracer(std::move(surfaces)).trace(fixed);
    all.insert(all.end(), lines.begin(), lines.end());
  }
  return all;
}

}  // namespace

int Mesh::object_index(const std::string& name) const {
  for (std::size_t k = 0; k < objects.size(); ++k)
    if (objects[k].name == name) return static_cast<int>(k);
  return -1;
}

Mesh make_mesh(const RolloutWorld& world) {
  Mesh mesh;
  mesh.objects = world.objects;
  mesh.cells = world.cells;
  mesh.first_edge.push_back(0);
  for (std::size_t k = 0; k < mesh.objects.size(); ++k) {
    const ModelObject& object = mesh.objects[k];
    std::map<std::pair<int, int>, Mesh::Edge> edges;
    for (int c = object.first_cell; c < object.first_cell + object.cells; ++c) {
      const auto [tl, tr, bl, br] = mesh.cells[static_cast<std::size_t>(c)].points;
      for (const auto& [a, b] :
           {std::minmax(tl, tr), std::minmax(bl, br), std::minmax(tl, bl), std::minmax(tr, br)}) {
        const auto [entry, fresh] = edges.try_emplace({a, b}, Mesh::Edge{a, b, c, -1});
        if (!fresh) entry->second.other = c;
      }
    }
    for (const auto& [ends, edge] : edges) mesh.edges.push_back(edge);
    mesh.first_edge.push_back(mesh.edges.size());
    mesh.outlines.push_back(outlines(mesh, k));
  }
  return mesh;
}

Mesh make_mesh(const Body& body, std::vector<Vec2>& corners) {
  Mesh mesh;
  const int across = body.cols + 1;
  corners.clear();
  for (int row = 0; row <= body.rows; ++row)
    for (int col = 0; col <= body.cols; ++col)
      corners.push_back({static_cast<double>(col), static_cast<double>(body.rows - row)});
  const auto linked = [&](int a, int b) {
    return std::binary_search(body.links.begin(), body.links.end(),
                              Link{std::min(a, b), std::max(a, b)});
  };
  std::map<std::pair<int, int>, std::size_t> edge_at;  // by its ends, the latest
  for (int row = 0; row < body.rows; ++row)
    for (int col = 0; col < body.cols; ++col) {
      const Voxel type = body.at(row, col);
      if (type == Voxel::empty) continue;
      const int here = body.index(row, col);
      const auto cell = static_cast<int>(mesh.cells.size());
      const int tl = row * across + col;
      const int bl = tl + across;
      mesh.cells.push_back({0, type, {tl, tl + 1, bl, bl + 1}});
      const auto add = [&](int a, int b) {
        edge_at[{a, b}] = mesh.edges.size();
        mesh.edges.push_back({a, b, cell, -1});
      };
      // The cells above and to the left are there already.
      const auto join = [&](int a, int b, bool inside, int there) {
        if (inside && linked(there, here))
          mesh.edges[edge_at.at({a, b})].other = cell;
        else
          add(a, b);
      };
      join(tl, tl + 1, row > 0, here - body.cols);
      join(tl, bl, col > 0, here - 1);
      add(bl, bl + 1);
      add(tl + 1, bl + 1);
    }
  mesh.objects.push_back({"robot", 0, static_cast<int>(corners.size()), 0,
                          static_cast<int>(mesh.cells.size()), false});
  mesh.first_edge = {0, mesh.edges.size()};
  mesh.outlines.push_back(outlines(mesh, 0));
  return mesh;
}

}  // namespace evo::render
