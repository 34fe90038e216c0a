// Which contact candidates are corners inside cells, a register of them at a time.
// Included once per instruction set (see Highway's "-inl.h" files).

#if defined(LIBEVO_SIM_CONTACT_LOOK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_CONTACT_LOOK_INL_H_
#undef LIBEVO_SIM_CONTACT_LOOK_INL_H_
#else
#define LIBEVO_SIM_CONTACT_LOOK_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libevo/sim/contact_geometry.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Looks at the candidates of one lane after the other that are due, and lists those that
// are inside, in the order in which they push. Rows have `width` lanes.
template <std::size_t width>
class ContactLook {
 public:
  explicit ContactLook(std::vector<const ContactCandidate*>& inside) : inside_(inside) {
    inside_.clear();
  }

  void add(const Model::Compiled& world, ContactLists& lists, const PointView& view,
           std::size_t lane) {
    for (std::size_t i = 0; i < world.objects.size(); ++i) {
      if (world.block[i] >= 0) {
        ContactLists::Self& self = lists.self[static_cast<std::size_t>(world.block[i])];
        add(world, view, self.group, self.candidates, lane);
      }
      for (std::uint32_t g = lists.first_group[i]; g < lists.first_group[i + 1]; ++g)
        add(world, view, lists.groups[g], lists.pairs, lane);
    }
  }

  // How many of each lane are inside.
  const std::array<std::size_t, width>& finish() {
    look();
    return inside_of_;
  }

 private:
  static constexpr hn::ScalableTag<double> d_{};
  using V = hn::Vec<decltype(d_)>;
  using M = hn::Mask<decltype(d_)>;
  static constexpr std::size_t lanes = hn::MaxLanes(d_);
  static_assert(lanes <= ContactCandidates::padding + 1);
  static constexpr std::size_t capacity = 64;
  static constexpr std::size_t own = 4;  // the corner, behind those of the cell

  struct Vectors {
    V x, y;
  };
  static HWY_INLINE V Cross(Vectors a, Vectors b) {
    return hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x));
  }
  static HWY_INLINE V Size(Vectors a) { return hn::Add(hn::Abs(a.x), hn::Abs(a.y)); }

  // How far the points may move relative to each other before the sign of the cross
  // product of u and v can change, but for roundings: x = |u x v| changes by at most
  // r (|u| + |v| + r) when both change by r, and r <= x / (|u| + |v|). `size` is that
  // sum, or more.
  static HWY_INLINE V Reach(V product, V size) {
    const V x = hn::Abs(product);
    return hn::Div(hn::Mul(x, size), hn::Add(hn::Mul(size, size), x));
  }

  void add(const Model::Compiled& world, const PointView& view, ContactGroup& group,
           ContactCandidates& candidates, std::size_t lane) {
    const double travel =
        view.travel[group.blocks[0] * width] + view.travel[group.blocks[1] * width];
    if (travel < group.due) return;
    const V now = hn::Set(d_, travel);
    const V never = hn::Set(d_, HUGE_VAL);
    V next = never;
    bool any = false;
    for (std::uint32_t first = group.first; first < group.last; first += lanes) {
      const M in_group = hn::FirstN(d_, group.last - first);
      const V due = hn::IfThenElse(in_group, hn::LoadU(d_, &candidates.due[first]), never);
      const M is_due = hn::And(in_group, hn::Not(hn::Lt(now, due)));
      next = hn::Min(next, due);
      unsigned bits = bits_of(is_due);
      any |= bits != 0;
      for (; bits != 0; bits &= bits - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(bits));
        put_corner(world, view, candidates.all[i].corner);
        put_cell(world, view, world.surface[candidates.all[i].cell]);
        candidate_[count_] = &candidates.all[i];
        lane_[count_] = lane;
        now_[count_] = travel;
        due_[count_] = &candidates.due[i];
        if (++count_ == capacity) look();
      }
    }
    group.due = any ? travel : hn::GetLane(hn::MinOfLanes(d_, next));
  }

  void put_corner(const Model::Compiled& world, const PointView& view, std::uint32_t corner) {
    const SurfaceCell& owner = world.surface[corner / 4];
    if (world.is_static(owner))
      put_static(own, world, owner.corners[corner % 4]);
    else
      put_moving(own, view, owner.corners[corner % 4]);
  }
  void put_cell(const Model::Compiled& world, const PointView& view, const SurfaceCell& cell) {
    constexpr Corner corners[] = {top_left, top_right, bottom_left, bottom_right};
    if (world.is_static(cell))
      for (const Corner c : corners) put_static(c, world, cell.corners[c]);
    else
      for (const Corner c : corners) put_moving(c, view, cell.corners[c]);
  }
  HWY_INLINE void put_static(std::size_t of, const Model::Compiled& world, std::int32_t site) {
    const Vec2 p = world.static_points[static_cast<std::size_t>(site - world.plan.sites)];
    x_[of][count_] = p.x;
    y_[of][count_] = p.y;
  }
  HWY_INLINE void put_moving(std::size_t of, const PointView& view, std::int32_t site) {
    const double* p = view.position + pair_offset(site, width);
    x_[of][count_] = p[0];
    y_[of][count_] = p[width];
  }

  // Looks at all that have been put.
  void look() {
    for (std::size_t k = count_; k < capacity && k % lanes != 0; ++k)  // rest of a register
      for (std::size_t of = 0; of <= own; ++of) x_[of][k] = y_[of][k] = 0.0;
    for (std::size_t first = 0; first < count_; first += lanes)
      for (unsigned bits = look(first); bits != 0; bits &= bits - 1) {
        const std::size_t k = first + static_cast<std::size_t>(std::countr_zero(bits));
        if (k >= count_) break;
        inside_.push_back(candidate_[k]);
        ++inside_of_[lane_[k]];
      }
    for (std::size_t k = 0; k < count_; ++k) *due_[k] = due_again_[k];
    count_ = 0;
  }

  // A bit for each of the corners from k on: is it inside, in one of the two triangles of its
  // cell, borders included (the benchmark's test, which only looks at signs)? Then it is due
  // again at once; if not, when the points may have moved, relative to each other and by any
  // path, so far that it is.
  unsigned look(std::size_t k) {
    const auto load = [&](std::size_t of) {
      return Vectors{hn::Load(d_, x_[of] + k), hn::Load(d_, y_[of] + k)};
    };
    const Vectors p = load(own);
    const auto from_p = [&](std::size_t of) {
      const Vectors q = load(of);
      return Vectors{hn::Sub(q.x, p.x), hn::Sub(q.y, p.y)};
    };
    const Vectors tl = from_p(top_left);
    const Vectors br = from_p(bottom_right);
    const V zero = hn::Zero(d_);
    const V c = Cross(br, tl);
    const V tl_size = Size(tl);
    const V br_size = Size(br);

    // The triangle that has this corner beside top left and bottom right: whether p is in it,
    // and how far from it as long as c keeps its sign.
    struct Triangle {
      M inside;
      V distance;
    };
    const auto triangle = [&](std::size_t corner) {
      const Vectors side = from_p(corner);
      const V side_size = Size(side);
      const V first = Cross(tl, side);
      const V second = Cross(side, br);
      const M first_alike = hn::Ge(hn::Mul(c, first), zero);
      const M second_alike = hn::Ge(hn::Mul(c, second), zero);
      return Triangle{
          hn::And(first_alike, second_alike),
          hn::Max(hn::IfThenZeroElse(first_alike, Reach(first, hn::Add(tl_size, side_size))),
                  hn::IfThenZeroElse(second_alike, Reach(second, hn::Add(br_size, side_size))))};
    };
    const Triangle upper = triangle(top_right);
    const Triangle lower = triangle(bottom_left);
    const M is_inside = hn::Or(upper.inside, lower.inside);
    const V distance = hn::Sub(
        hn::Min(hn::Min(upper.distance, lower.distance), Reach(c, hn::Add(tl_size, br_size))),
        hn::Set(d_, contact::reach_slack));
    const V now = hn::Load(d_, now_ + k);
    hn::Store(hn::IfThenElse(is_inside, now, hn::Add(now, distance)), d_, due_again_ + k);
    return bits_of(is_inside);
  }

  static HWY_INLINE unsigned bits_of(M mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d_, mask, bits);
    return bits[0];
  }

  std::vector<const ContactCandidate*>& inside_;
  std::array<std::size_t, width> inside_of_{};  // lanes
  std::size_t count_ = 0;
  HWY_ALIGN double x_[own + 1][capacity];  // of corners and their cells
  HWY_ALIGN double y_[own + 1][capacity];
  HWY_ALIGN double now_[capacity];        // travel
  HWY_ALIGN double due_again_[capacity];  // at which it is due again
  double* due_[capacity];
  const ContactCandidate* candidate_[capacity];
  std::size_t lane_[capacity];
};

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
