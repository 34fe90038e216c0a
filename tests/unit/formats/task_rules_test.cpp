// Reward and end of every benchmark task on synthetic states, against formulas
// written here once more from docs/tasks.md, "A step", "Orientation" and "Rewards and ends".
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "formats/task/task.h"
#include "libevo/base/random.h"
#include "libevo/task/env.h"

using namespace evo;

namespace {

const DataFolders data{"tasks"};
constexpr double pi = std::numbers::pi;
constexpr double v = 0.1;  // voxel

// ---- states ---------------------------------------------------------------------------

// The object's own of the points of the world.
auto points_of(const Model& model, auto& positions, const std::string& name) {
  const ModelObject& o = model.objects()[static_cast<std::size_t>(model.object_index(name))];
  return std::span(positions).subspan(static_cast<std::size_t>(o.first_point),
                                      static_cast<std::size_t>(o.points));
}

// A snapshot with the questions that the specification's formulas ask.
struct Look {
  const Model& model;
  const Snapshot& now;

  using Axis = double Vec2::*;

  std::span<const Vec2> points(const std::string& name) const {
    return points_of(model, now.positions, name);
  }
  double mean(const std::string& name, Axis axis) const {
    double sum = 0.0;
    for (const Vec2& p : points(name)) sum += p.*axis / v * v;
    return sum / static_cast<double>(points(name).size());
  }
  double X(const std::string& name = "robot") const { return mean(name, &Vec2::x); }
  double Y(const std::string& name = "robot") const { return mean(name, &Vec2::y); }

  double extent(Axis axis) const {
    const auto [low, high] = std::ranges::minmax(points("robot"), {}, axis);
    return high.*axis - low.*axis;
  }
  double width() const { return extent(&Vec2::x); }
  double height() const { return extent(&Vec2::y); }

  // Sum of the cells' triangles would not be the hull; wrap the hull instead.
  double area() const {
    const auto p = points("robot");
    std::size_t first = 0;
    for (std::size_t i = 1; i < p.size(); ++i)
      if (p[i].x < p[first].x) first = i;
    double twice = 0.0;
    std::size_t at = first;
    for (std::size_t turns = 0; turns <= p.size(); ++turns) {
      std::size_t next = at == 0 ? 1 : 0;
      for (std::size_t i = 0; i < p.size(); ++i)
        if ((p[next].x - p[at].x) * (p[i].y - p[at].y) < (p[next].y - p[at].y) * (p[i].x - p[at].x))
          next = i;
      twice += p[at].x * p[next].y - p[next].x * p[at].y;
      at = next;
      if (at == first) break;
    }
    return 0.5 * std::abs(twice);
  }

  double ORT() const {
    const auto p = points("robot");
    const auto q = points_of(model, model.initial_positions(), "robot");
    Vec2 c, c0;
    const double n = static_cast<double>(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
      c = {c.x + p[i].x / n, c.y + p[i].y / n};
      c0 = {c0.x + q[i].x / n, c0.y + q[i].y / n};
    }
    double top = 0.0, bottom = 0.0, sign = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec2 u{p[i].x - c.x, p[i].y - c.y};
      const Vec2 w{q[i].x - c0.x, q[i].y - c0.y};
      const double a = std::hypot(u.x, u.y);
      const double b = std::hypot(w.x, w.y);
      double d = (u.x * w.x + u.y * w.y) / (a * b);
      if (a * b < 1e-7 || d > 1.0) d = 0.99999;
      if (d < -1.0) d = -0.99999;
      top += b * std::acos(d);
      bottom += b;
      sign += (u.x * w.y - u.y * w.x) / (a * b);
    }
    return sign > 0.0 ? 2.0 * 3.1415926 - top / bottom : top / bottom;
  }
};

// ---- the specification ------------------------------------------------------------------

struct Verdict {
  double reward = 0.0;
  bool terminated = false;

  void rule(bool holds, double bonus) {
    if (!holds) return;
    reward += bonus;
    terminated = true;
  }
};

using Formula = std::function<double(const Look& pre, const Look& post)>;
using Rules = std::function<void(const Look& post, Verdict& verdict)>;

double dX(const Look& pre, const Look& post, const std::string& o = "robot") {
  return post.X(o) - pre.X(o);
}
double dY(const Look& pre, const Look& post, const std::string& o = "robot") {
  return post.Y(o) - pre.Y(o);
}
double nearer(const Look& pre, const Look& post, const std::string& o) {
  return std::abs(pre.X("robot") - pre.X(o)) - std::abs(post.X("robot") - post.X(o));
}
double drop(const Look& pre, const Look& post, double threshold) {
  return post.Y("package") < threshold ? 10.0 * dY(pre, post, "package") : 0.0;
}
double balance(const Look& pre, const Look& post, double gx, double gy) {
  return (std::abs(gx - pre.X()) - std::abs(gx - post.X())) +
         (std::abs(gy - pre.Y()) - std::abs(gy - post.Y()));
}
double flip(const Look& pre, const Look& post) {
  const double o1 = pre.ORT();
  const double o2 = post.ORT();
  int k = 0;
  if (o1 < pi / 3 && o2 > 5 * pi / 3) k -= 1;
  if (o1 > 5 * pi / 3 && o2 < pi / 3) k += 1;
  return (2 * pi * k + o2) - o1;
}
bool tilted(const Look& post, double low, double high) {
  return post.ORT() > low && post.ORT() < high;
}

void no_rules(const Look&, Verdict&) {}
Rules beyond_x(double x, double bonus) {
  return [=](const Look& post, Verdict& verdict) { verdict.rule(post.X() > x, bonus); };
}
Rules beyond_x_or_tilted(double x, double bonus, double low, double high) {
  return [=](const Look& post, Verdict& verdict) {
    verdict.rule(post.X() > x, bonus);
    verdict.rule(tilted(post, low, high), -3.0);
  };
}
Rules beyond_y(double y, double bonus) {
  return [=](const Look& post, Verdict& verdict) { verdict.rule(post.Y() > y, bonus); };
}
void beam_left(const Look& post, Verdict& verdict) { verdict.rule(post.X("beam") < 2 * v, 1.0); }

const Formula walk = [](const Look& a, const Look& b) { return dX(a, b); };
const Formula climb = [](const Look& a, const Look& b) { return dY(a, b); };
const Formula push = [](const Look& a, const Look& b) {
  return 0.75 * dX(a, b, "package") + 0.5 * dX(a, b) + nearer(a, b, "package") + drop(a, b, 0.0);
};

// A place where a rule or a threshold of the reward decides, to be tried on both
// sides: an object's centre along an axis, raw units.
struct Edge {
  const char* object;
  char axis;
  double value;
};

struct Spec {
  const char* task;
  Formula reward;
  std::vector<Edge> edges = {};
  Rules rules = no_rules;
  std::vector<double> tilts = {};  // radians
};

const std::vector<Spec> specs{
    {"Walker-v0", walk, {{"robot", 'x', 99 * v}}, beyond_x(99 * v, 1)},
    {"BridgeWalker-v0", walk, {{"robot", 'x', 60 * v}}, beyond_x(60 * v, 1)},
    {"Carrier-v0",
     [](const Look& a, const Look& b) {
       return 0.5 * dX(a, b) + 0.5 * dX(a, b, "package") + drop(a, b, 3.0 * v);
     },
     {{"robot", 'x', 99 * v}, {"package", 'y', 3.0 * v}},
     beyond_x(99 * v, 1)},
    {"Carrier-v1",
     [](const Look& a, const Look& b) {
       const double height = b.X("package") > 20 * v ? 4.0 * v : 6.0 * v;
       return std::abs(40 * v - a.X()) - std::abs(40 * v - b.X()) + drop(a, b, height);
     },
     {{"robot", 'x', 40 * v},
      {"package", 'x', 20 * v},
      {"package", 'y', 4 * v},
      {"package", 'y', 6 * v}}},
    {"Pusher-v0", push, {{"robot", 'x', 99 * v}, {"package", 'y', 0}}, beyond_x(99 * v, 1)},
    {"Pusher-v1", push, {{"robot", 'x', 69 * v}, {"package", 'y', 0}}, beyond_x(69 * v, 1)},
    {"Thrower-v0",
     [](const Look& a, const Look& b) {
       const double movement = -0.25 * dX(a, b);
       return dX(a, b, "package") + (b.X() < 0 ? -movement : movement);
     },
     {{"robot", 'x', 0}}},
    {"Catcher-v0",
     [](const Look& a, const Look& b) { return nearer(a, b, "package") + drop(a, b, 5.0 * v); },
     {{"package", 'y', 5.0 * v}}},
    {"BeamToppler-v0",
     [](const Look& a, const Look& b) {
       return nearer(a, b, "beam") + std::abs(dX(a, b, "beam")) + 3 * std::abs(dY(a, b, "beam")) -
              10 * dY(a, b, "beam");
     },
     {{"beam", 'x', 2 * v}},
     beam_left},
    {"BeamSlider-v0",
     [](const Look& a, const Look& b) { return nearer(a, b, "beam") + dX(a, b, "beam"); },
     {{"beam", 'x', 2 * v}},
     beam_left},
    {"Lifter-v0",
     [](const Look& a, const Look& b) {
       return 10 * dY(a, b, "package") +
              10 * (std::abs(5.5 * v - a.X("package")) - std::abs(5.5 * v - b.X("package"))) +
              (b.Y() < 3 * v ? 20 * dY(a, b) : 0.0);
     },
     {{"robot", 'y', 3 * v}, {"package", 'x', 5.5 * v}}},
    {"Climber-v0", climb, {{"robot", 'y', 86 * v}}, beyond_y(86 * v, 1)},
    {"Climber-v1", climb, {{"robot", 'y', 65 * v}}, beyond_y(65 * v, 1)},
    {"Climber-v2", [](const Look& a, const Look& b) { return dY(a, b) + 0.2 * dX(a, b); }},
    {"UpStepper-v0",
     walk,
     {{"robot", 'x', 69 * v}},
     beyond_x_or_tilted(69 * v, 2, pi / 2 - pi / 12, 3 * pi / 2 + pi / 12),
     {pi / 2 - pi / 12, 3 * pi / 2 + pi / 12}},
    {"DownStepper-v0",
     walk,
     {{"robot", 'x', 74 * v}},
     beyond_x_or_tilted(74 * v, 2, pi / 2, 3 * pi / 2),
     {pi / 2, 3 * pi / 2}},
    {"ObstacleTraverser-v0",
     walk,
     {{"robot", 'x', 79 * v}},
     beyond_x_or_tilted(79 * v, 2, pi / 2, 3 * pi / 2),
     {pi / 2, 3 * pi / 2}},
    {"ObstacleTraverser-v1", walk, {{"robot", 'x', 59 * v}}, beyond_x(59 * v, 2), {pi / 2}},
    {"Hurdler-v0", walk, {}, beyond_x_or_tilted(1e9, 0, pi / 2, 3 * pi / 2), {pi / 2, 3 * pi / 2}},
    {"PlatformJumper-v0",
     walk,
     {{"robot", 'y', 0.4}},
     [](const Look& post, Verdict& verdict) {
       verdict.rule(post.Y() < 0.4, -3.0);
       verdict.rule(tilted(post, pi / 2, 3 * pi / 2), -3.0);
     },
     {pi / 2, 3 * pi / 2}},
    {"GapJumper-v0",
     walk,
     {{"robot", 'y', 4 * v}},
     [](const Look& post, Verdict& verdict) { verdict.rule(post.Y() < 4 * v, -3.0); },
     {pi / 2}},
    {"Traverser-v0", walk, {{"robot", 'x', 59 * v}}, beyond_x(59 * v, 2), {pi / 2}},
    {"CaveCrawler-v0", walk, {{"robot", 'x', 69 * v}}, beyond_x(69 * v, 1)},
    {"AreaMaximizer-v0", [](const Look& a, const Look& b) { return 10 * (b.area() - a.area()); }},
    {"AreaMinimizer-v0", [](const Look& a, const Look& b) { return 10 * (a.area() - b.area()); }},
    {"WingspanMazimizer-v0", [](const Look& a, const Look& b) { return b.width() - a.width(); }},
    {"HeightMaximizer-v0", [](const Look& a, const Look& b) { return b.height() - a.height(); }},
    {"Flipper-v0",
     flip,
     {{"robot", 'x', 1 * v}},
     [](const Look& post, Verdict& verdict) { verdict.rule(post.X() < 1 * v, 0.0); },
     {0.0, pi / 3, 5 * pi / 3}},
    {"Jumper-v0",
     [](const Look& a, const Look& b) { return 10 * dY(a, b) - 5 * std::abs(dX(a, b)); }},
    {"Balancer-v0",
     [](const Look& a, const Look& b) { return balance(a, b, 17 * v, 5.0 * v); },
     {{"robot", 'x', 17 * v}, {"robot", 'y', 5 * v}}},
    {"Balancer-v1",
     [](const Look& a, const Look& b) { return balance(a, b, 17.5 * v, 6 * v); },
     {{"robot", 'x', 17.5 * v}, {"robot", 'y', 6 * v}}},
};

// ---- moving objects about -----------------------------------------------------------------

void shift(std::span<Vec2> points, double dx, double dy) {
  for (Vec2& p : points) p = {p.x + dx, p.y + dy};
}

void turn(std::span<Vec2> points, double angle) {
  Vec2 c;
  const double n = static_cast<double>(points.size());
  for (const Vec2& p : points) c = {c.x + p.x / n, c.y + p.y / n};
  for (Vec2& p : points) {
    const Vec2 d{p.x - c.x, p.y - c.y};
    p = {c.x + std::cos(angle) * d.x - std::sin(angle) * d.y,
         c.y + std::sin(angle) * d.x + std::cos(angle) * d.y};
  }
}

// To within 1e-7 of the edge, on either side.
void bring_to(const Model& model, Snapshot& snapshot, const Edge& edge, bool beyond) {
  const Look look{model, snapshot};
  const double now = edge.axis == 'x' ? look.X(edge.object) : look.Y(edge.object);
  const double distance = edge.value + (beyond ? 1e-7 : -1e-7) - now;
  shift(points_of(model, snapshot.positions, edge.object), edge.axis == 'x' ? distance : 0.0,
        edge.axis == 'y' ? distance : 0.0);
}

// Every movable object somewhere near its start, a little bent; some times
// right at the edges.
Snapshot make_state(const Spec& spec, const Model& model, int round, Stream& stream) {
  Snapshot snapshot;
  snapshot.positions = model.initial_positions();
  snapshot.velocities.resize(snapshot.positions.size());
  for (const ModelObject& object : model.objects()) {
    if (object.is_static) continue;
    const auto points = points_of(model, snapshot.positions, object.name);
    if (object.name == "robot" && !spec.tilts.empty() && round % 2 == 0) {
      const double tilt = spec.tilts[stream.below(static_cast<std::uint32_t>(spec.tilts.size()))];
      turn(points, tilt + (stream.below(2) == 0 ? -1e-4 : 1e-4));
    } else {
      turn(points, 6.0 * stream.uniform());
      for (Vec2& p : points) p = {p.x + 0.03 * stream.uniform(), p.y + 0.03 * stream.uniform()};
    }
    shift(points, 0.4 * (stream.uniform() - 0.5), 0.4 * (stream.uniform() - 0.5));
  }
  for (const Edge& edge : spec.edges)
    if (stream.below(2) == 0) bring_to(model, snapshot, edge, stream.below(2) == 0);
  return snapshot;
}

}  // namespace

TEST_CASE("rewards and ends are those of the specification, around every threshold") {
  CHECK(specs.size() == 31);  // BidirectionalWalker-v0 has a test of its own
  const Body body = Body::from_rows({"HSHHH", "V.RVV", "S...H"});
  for (const Spec& spec : specs) {
    INFO(spec.task);
    const Arena arena(load_task(spec.task, data), body);
    const Model& model = arena.model();
    Stream stream(8, "test/states", spec.task);
    int ended = 0;
    int rounds = 0;
    Snapshot pre = make_state(spec, model, 0, stream);
    for (; rounds < 200; ++rounds) {
      const bool folded = rounds % 5 == 4;
      const Snapshot post = folded ? pre : make_state(spec, model, rounds, stream);
      const Look before{model, pre};
      const Look after{model, post};
      Verdict expected;
      expected.reward = spec.reward(before, after);
      if (folded) expected.rule(true, -3.0);
      spec.rules(after, expected);

      Episode episode;
      const StepOutcome outcome = judge(arena, model, episode, pre, post, {}, folded);
      CHECK(outcome.reward == Approx(expected.reward).epsilon(0).margin(1e-11));
      CHECK(outcome.terminated == expected.terminated);
      CHECK_FALSE(outcome.truncated);
      ended += expected.terminated && !folded ? 1 : 0;
      pre = post;
    }
    // The states do lie on both sides of the task's rules.
    const bool has_rules = !arena.task().rules.empty();
    CHECK((ended > 0) == has_rules);
    CHECK(ended < rounds / 2 + rounds / 4);
  }
}

TEST_CASE("BidirectionalWalker-v0 goes from goal to goal as released") {
  const Body body = Body::from_rows({"HH", "VV"});
  const Arena arena(load_task("BidirectionalWalker-v0", data), body);
  const Model& model = arena.model();
  Stream stream(8, "test/states", "goals");
  int several = 0;  // goals reached in one step
  const auto state = [&](double x) {
    Snapshot snapshot;
    snapshot.positions = model.initial_positions();
    snapshot.velocities.resize(snapshot.positions.size());
    shift(points_of(model, snapshot.positions, "robot"), x - Look{model, snapshot}.X(), 0.0);
    return snapshot;
  };
  for (int round = 0; round < 100; ++round) {
    Episode episode{arena.draw(2, static_cast<std::uint64_t>(round)), 0, 0, {}};
    const std::vector<int> goals = episode.draws.goals;
    std::size_t c = 0;
    Snapshot pre = state(3.5);
    bool terminated = false;
    for (int step = 0; step < 300 && !terminated; ++step) {
      // Near the goal, at the edge of its radius, or anywhere.
      const double edge = goals[c] * v + (stream.below(2) == 0 ? -1 : 1) * 2 * v;
      const double offset = stream.below(3) == 0 ? 0.1 : stream.below(2) == 0 ? 1e-7 : -1e-7;
      const Snapshot post = state(edge + offset);
      const double x0 = Look{model, pre}.X();
      const double x1 = Look{model, post}.X();

      std::vector<double> seen(static_cast<std::size_t>(arena.observation_length()));
      observe(arena, model, episode, post, seen);
      CHECK(seen[seen.size() - 3] == static_cast<double>(c));
      CHECK(seen[seen.size() - 2] == goals[c] * v);
      CHECK(seen[seen.size() - 1] == Approx(goals[c] * v - x1).margin(1e-12));

      double reward = 0.0;
      const std::size_t before = c;
      while (true) {
        const double d0 = std::abs(goals[c] * v - x0);
        const double d1 = std::abs(goals[c] * v - x1);
        reward = d0 - d1;
        if (!(d1 < 2 * v)) break;
        c += 1;
        if (c == goals.size()) break;
      }
      several += c > before + 1 ? 1 : 0;
      terminated = c == goals.size();
      if (terminated) reward += 1.0;

      const StepOutcome outcome = judge(arena, model, episode, pre, post, {}, false);
      CHECK(outcome.reward == Approx(reward).epsilon(0).margin(1e-12));
      CHECK(outcome.terminated == terminated);
      pre = post;
    }
    CHECK(terminated);
    // One more step after the end does no harm: the last goal stays.
    judge(arena, model, episode, pre, state(1.0), {}, false);
    std::vector<double> seen(static_cast<std::size_t>(arena.observation_length()));
    observe(arena, model, episode, pre, seen);
    CHECK(seen[seen.size() - 2] == goals.back() * v);
  }
  CHECK(several > 0);
}
