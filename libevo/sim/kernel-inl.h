// What a kernel is: the arithmetic of a substep over the arrays of a group. There are
// two, SideBySide and Alone (see kernels.cpp); ControlStep (control_step-inl.h) drives
// either. Included once per instruction set (see Highway's "-inl.h" files).

#if defined(LIBEVO_SIM_KERNEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_KERNEL_INL_H_
#undef LIBEVO_SIM_KERNEL_INL_H_
#else
#define LIBEVO_SIM_KERNEL_INL_H_
#endif

#include <hwy/highway.h>

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "libevo/sim/plan.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

// The shape of a kernel: how it lays out its arrays, how many springs and points one
// call of its loops' bodies does, and whether points take turns with springs in a stage
// or come after all of them.
template <class K>
concept KernelShape = requires {
  { K::width } -> std::convertible_to<std::size_t>;  // lanes of the rows
  { K::record_points } -> std::convertible_to<std::size_t>;
  { K::force_record } -> std::convertible_to<std::size_t>;
  { K::force_offset } -> std::convertible_to<std::size_t>;
  { K::dealt_springs } -> std::convertible_to<std::size_t>;
  { K::points_follow } -> std::convertible_to<bool>;
  { K::springs_at_once } -> std::convertible_to<std::size_t>;
  { K::points_at_once } -> std::convertible_to<std::size_t>;
};

template <KernelShape K>
Layout LayoutOf() {
  return {K::width, K::record_points, K::force_record, K::force_offset, K::dealt_springs};
}

// `at` and `next` are positions, or one value per lane; `s` is a spring, `i` a point, `n`
// springs.
template <class K>
concept StepKernel = KernelShape<K> &&
    std::constructible_from<K, const Plan&, const Physics&, const Arrays&> &&
    requires(const K& kernel, const double* at, double* next, std::size_t s, std::size_t i,
             std::size_t n, const PlanBlock& sites, const std::uint32_t* ends) {
  // Forces of springs_at_once springs from s on; of all from s to n.
  kernel.template springs<true>(at, s);
  kernel.template springs<false>(at, s);
  kernel.template last_springs<true>(at, s, n);
  // Gathers the forces of one point, or of points_at_once regular ones from i on, and
  // takes it through stage 1, .. 4.
  kernel.template point<1>(i, ends, Plan::regular_ends, Plan::regular_ends, at, next);
  kernel.template point<4>(i, ends, Plan::regular_ends, Plan::regular_ends, at, next);
  kernel.template points<1>(i, ends, at, next);
  kernel.template points<4>(i, ends, at, next);
  // After the stages.
  kernel.limit_strain(next);
  kernel.limit_rigid_strain(next);
  // How far points have moved: since the last substep, and since lists were found
  // (squares, one value per lane).
  kernel.add_travel();
  kernel.square_moved(next);
  kernel.square_sheared(sites, next);
};

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
