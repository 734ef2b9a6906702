#include "dem/engine/lanes/lane_pass.hpp"

// The code between foreach_target.h and HWY_ONCE is compiled once for each kind of vector instructions.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)  // nothing of theirs is used
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dem/engine/lanes/lane_pass.cpp"
#include <hwy/foreach_target.h>
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "dem/engine/lanes/lane_dispatch.hpp"
#include "dem/engine/lanes/lane_drift-inl.hpp"
#include "dem/engine/lanes/lane_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainlaw::dem {
namespace HWY_NAMESPACE {
namespace {

// --- Sums --------------------------------------------------------------------------------------------------------

/// Sums by lane in double precision.
struct alignas(64) LaneTotals {
  double box[kLanes] = {}, contact[kLanes] = {}, v2[kLanes] = {};
};

template <class D>
HWY_INLINE void add_to(double* sum, D d, hn::Vec<D> v) {
  if constexpr (sizeof(hn::TFromD<D>) == 8) {
    hn::Store(hn::Add(hn::Load(d, sum), v), d, sum);
  } else {
#if HWY_TARGET == HWY_SCALAR
    *sum += static_cast<double>(hn::GetLane(v));
#else
    const hn::Repartition<double, D> dd;
    const hn::Half<D> half;
    const std::size_t n = hn::Lanes(dd);
    hn::Store(hn::Add(hn::Load(dd, sum), hn::PromoteTo(dd, hn::LowerHalf(half, v))), dd, sum);
    hn::Store(hn::Add(hn::Load(dd, sum + n), hn::PromoteTo(dd, hn::UpperHalf(half, v))), dd, sum + n);
#endif
  }
}

double sum_of(const double* lane) {
  double sum = 0;
  for (std::size_t l = 0; l < kLanes; ++l) sum += lane[l];
  return sum;
}

// --- Passes ------------------------------------------------------------------------------------------------------

template <bool portable, class Real>
void write_rows_on(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const hn::RebindToSigned<Tag<Real>> di;
  const MultiplyAdd<portable> multiply_add;
  const auto h = hn::Set(d, static_cast<Real>(step.half_dt));
  for (std::size_t g = begin; g < end; ++g) {
    const SphereGroup<Real>& own = lanes.group[g];
    const PlacedGroup<Real>& placed = lanes.placed[g];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const auto place = [&](const FixedPoint<Real>* x) { return hn::BitCast(d, hn::Load(di, x + o)); };
      const auto predicted = [&](const Real* v, const Real* a) {
        const auto of_group = hn::Load(d, a + o);
        return lanes.predicted ? of_group : multiply_add(h, of_group, hn::Load(d, v + o));
      };
      auto* to = reinterpret_cast<Real*>(lanes.row.data() + g * kLanes + o);
      const auto radius = hn::Load(d, placed.radius + o);
      store_rows<false>(d, {place(placed.x), place(placed.y), place(placed.z), hn::Add(radius, hn::Load(d, own.near_skin + o))},
                        {predicted(own.vx, placed.ax), predicted(own.vy, placed.ay), predicted(own.vz, placed.az), radius}, to);
    }
  }
}

template <bool portable, class Real>
double farthest_moved2_on(const Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const hn::RebindToSigned<Tag<Real>> di;
  const Moved2<Real, portable> moved2(step);
  auto farthest2 = hn::Zero(d);
  for (std::size_t g = begin; g < end; ++g) {
    const PlacedGroup<Real>& now = lanes.placed[g];
    const ListedGroup<Real>& listed = lanes.listed[g];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      farthest2 = hn::Max(farthest2, moved2(hn::Load(di, now.x + o), hn::Load(di, now.y + o), hn::Load(di, now.z + o), listed.x + o,
                                            listed.y + o, listed.z + o));
    }
  }
  return static_cast<double>(hn::GetLane(hn::MaxOfLanes(d, farthest2)));
}

template <bool portable, class Real>
Drifted kick_and_drift_on(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const hn::RebindToSigned<Tag<Real>> di;
  Drift<portable, false, Real> drift(step);
  for (std::size_t g = begin; g < end; ++g) {
    const SphereGroup<Real>& own = lanes.group[g];
    PlacedGroup<Real>& placed = lanes.placed[g];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const auto at = [&](const Real* x) { return hn::Load(d, x + o); };
      const auto place = [&](const FixedPoint<Real>* x) { return hn::Load(di, x + o); };
      store(di, drift(lanes, lanes.row, g, o, {place(placed.x), place(placed.y), place(placed.z)}, at(placed.radius),
                      {at(placed.ax), at(placed.ay), at(placed.az)}, {at(own.vx), at(own.vy), at(own.vz)}),
            placed.x + o, placed.y + o, placed.z + o);
    }
  }
  return drift.how();
}

/// The overlap sum - sqrt(squared), given `rounded` with the root as it was rounded, and the inverse of that. In float the root's rounding
/// is the largest error of a shallow overlap; where products can be fused it is known exactly, and given back.
template <bool portable, class V>
HWY_INLINE V overlap_of(V rounded, V squared, V root, V inverse) {
  if constexpr (sizeof(hn::TFromV<V>) == 4 && (kHasFused || portable)) {
    const MultiplyAdd<portable> multiply_add;
    const V excess = kHasFused ? hn::MulSub(root, root, squared) : multiply_add(root, root, hn::Neg(squared));
    return multiply_add(hn::Mul(excess, inverse), hn::Set(hn::DFromV<V>(), 0.5F), rounded);
  } else {
    return rounded;
  }
}

/// Second half of a step but for storing anything: after(group, lane, place, radius, acceleration, velocity) gets each vector of spheres.
template <bool portable, bool large, class Real, class After>
LaneSums forces_on(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end, const After& after) {
  const Tag<Real> d;
  const MultiplyAdd<portable> multiply_add;
  const hn::RebindToSigned<Tag<Real>> di;
  using V = hn::Vec<Tag<Real>>;
  const auto set = [&](double x) { return hn::Set(d, static_cast<Real>(x)); };
  const V h = set(step.half_dt), k = set(step.stiffness), minus_gamma = set(-step.viscosity),
          gamma_b = set(step.drag), one = set(1), zero = hn::Zero(d);
  const V Lx = set(step.rate[0]), Ly = set(step.rate[1]), Lz = set(step.rate[2]);
  const Edge<Tag<Real>, portable> ex(d, step.edge[0]), ey(d, step.edge[1]), ez(d, step.edge[2]);
  const Real* rows = reinterpret_cast<const Real*>(lanes.row.data());
  LaneTotals totals;
  fetch_tiers_from(lanes, end);
  for (std::size_t g = begin; g < end; ++g) {
    const SphereGroup<Real>& own = lanes.group[g];
    const std::size_t first_tier = lanes.near_first[g], last_tier = first_tier + lanes.near_count[g];
    FetchAhead<large, Real> ahead(lanes, g);
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      Quartet<Tag<Real>> at, moving;
      load_rows(d, reinterpret_cast<const Real*>(lanes.row.data() + g * kLanes + o), at, moving);
      const Axes<hn::Vec<decltype(di)>> here{hn::BitCast(di, at.a), hn::BitCast(di, at.b), hn::BitCast(di, at.c)};
      const V r = moving.d;
      const V vx = hn::Load(d, own.vx + o), vy = hn::Load(d, own.vy + o), vz = hn::Load(d, own.vz + o);
      V fx = zero, fy = zero, fz = zero;        // force
      V gx = zero, gy = zero, gz = zero;        // its viscous part
      V box = zero, lost = zero;
      for (std::size_t tier = first_tier; tier < last_tier; ++tier) {
        ahead.some();
        const std::uint32_t* row = lanes.near_tier[tier].row + o;
        const Quartet<Tag<Real>> place = gather_rows(d, rows, row, 0), motion = gather_rows(d, rows, row, 4);
        const V dx = ex(d, hn::Sub(here.x, hn::BitCast(di, place.a))), dy = ey(d, hn::Sub(here.y, hn::BitCast(di, place.b))),
                dz = ez(d, hn::Sub(here.z, hn::BitCast(di, place.c)));
        const V squared = multiply_add(dz, dz, multiply_add(dy, dy, hn::Mul(dx, dx)));
        const V distance = hn::Sqrt(squared);
        const V rounded = hn::Sub(hn::Add(r, motion.d), distance);
        const auto touching = hn::Gt(rounded, zero);
        const V inverse = hn::Div(one, distance);
        const V delta = overlap_of<portable>(rounded, squared, distance, inverse);
        // u . x_ij, of the cell and with the spheres' own velocities
        const V cell = multiply_add(hn::Mul(Lz, dz), dz, multiply_add(hn::Mul(Ly, dy), dy, hn::Mul(hn::Mul(Lx, dx), dx)));
        const V u = multiply_add(hn::Sub(moving.c, motion.c), dz,
                                 multiply_add(hn::Sub(moving.b, motion.b), dy, multiply_add(hn::Sub(moving.a, motion.a), dx, cell)));
        const V viscous = hn::Mul(minus_gamma, hn::Mul(u, inverse));
        // force and viscous part over |x_ij|
        const V f = hn::IfThenElseZero(touching, hn::Mul(multiply_add(k, delta, viscous), inverse));
        const V v = hn::IfThenElseZero(touching, hn::Mul(viscous, inverse));
        fx = multiply_add(f, dx, fx);
        fy = multiply_add(f, dy, fy);
        fz = multiply_add(f, dz, fz);
        gx = multiply_add(v, dx, gx);
        gy = multiply_add(v, dy, gy);
        gz = multiply_add(v, dz, gz);
        box = multiply_add(f, cell, box);
        lost = multiply_add(v, cell, lost);
      }
      const V inverse_mass = hn::Load(d, own.inverse_mass + o);
      const V damped = hn::Div(one, multiply_add(hn::Mul(h, gamma_b), inverse_mass, one));
      const V hm = hn::Mul(h, inverse_mass);
      const V nx = hn::Mul(multiply_add(hm, fx, vx), damped), ny = hn::Mul(multiply_add(hm, fy, vy), damped),
              nz = hn::Mul(multiply_add(hm, fz, vz), damped);
      const V ax = hn::Mul(hn::Sub(fx, hn::Mul(gamma_b, nx)), inverse_mass), ay = hn::Mul(hn::Sub(fy, hn::Mul(gamma_b, ny)), inverse_mass),
              az = hn::Mul(hn::Sub(fz, hn::Mul(gamma_b, nz)), inverse_mass);
      after(g, o, here, r, Axes<V>{ax, ay, az}, Axes<V>{nx, ny, nz});
      // every contact is met twice: halves of what belongs to it, all of -sum F_v . v
      lost = multiply_add(set(0.5), lost, multiply_add(gz, nz, multiply_add(gy, ny, hn::Mul(gx, nx))));
      add_to(totals.box + o, d, box);
      add_to(totals.contact + o, d, lost);
      add_to(totals.v2 + o, d, multiply_add(nz, nz, multiply_add(ny, ny, hn::Mul(nx, nx))));
    }
    ahead.rest();
  }
  return {-0.5 * sum_of(totals.box), -sum_of(totals.contact), sum_of(totals.v2)};
}

template <bool portable, class Real>
LaneSums force_and_kick_on(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const hn::RebindToSigned<Tag<Real>> di;
  return forces_on<portable, false>(lanes, step, begin, end, [&](std::size_t g, std::size_t o, auto place, auto, auto a, auto v) {
    SphereGroup<Real>& own = lanes.group[g];
    PlacedGroup<Real>& placed = lanes.placed[g];
    store(di, place, placed.x + o, placed.y + o, placed.z + o);
    store(d, a, placed.ax + o, placed.ay + o, placed.az + o);
    store(d, v, own.vx + o, own.vy + o, own.vz + o);
  });
}

template <bool portable, bool large, class Real>
LaneSums force_kick_drift_of(Lanes<Real>& lanes, const LaneStep& step, const LaneStep& next, std::size_t begin, std::size_t end,
                          Drifted& how) {
  Drift<portable, large, Real> drift(next);
  const LaneSums sums = forces_on<portable, large>(
      lanes, step, begin, end,
      [&](std::size_t g, std::size_t o, auto place, auto r, auto a, auto v) { drift(lanes, lanes.next_row, g, o, place, r, a, v); });
  if constexpr (large) hwy::FlushStream();
  how = drift.how();
  return sums;
}

template <bool portable, class Real>
LaneSums force_kick_drift_on(Lanes<Real>& lanes, const LaneStep& step, const LaneStep& next, std::size_t begin, std::size_t end,
                          Drifted& how) {
  return lanes.beyond_caches ? force_kick_drift_of<portable, true>(lanes, step, next, begin, end, how)
                             : force_kick_drift_of<portable, false>(lanes, step, next, begin, end, how);
}

// One instance is enough where the machine can fuse.
#define GRAINLAW_CALL(pass_on, ...) \
  (step.portable_bits && !kHasFused ? pass_on<!kHasFused>(__VA_ARGS__) : pass_on<false>(__VA_ARGS__))
#define GRAINLAW_PASSES(PASS)                                                                                          \
  PASS(void, write_rows, , (const LaneStep& step, std::size_t begin, std::size_t end), (step, begin, end))             \
  PASS(double, farthest_moved2, const, (const LaneStep& step, std::size_t begin, std::size_t end), (step, begin, end)) \
  PASS(Drifted, kick_and_drift, , (const LaneStep& step, std::size_t begin, std::size_t end), (step, begin, end))      \
  PASS(LaneSums, force_and_kick, , (const LaneStep& step, std::size_t begin, std::size_t end), (step, begin, end))     \
  PASS(LaneSums, force_kick_drift, ,                                                                                   \
       (const LaneStep& step, const LaneStep& next, std::size_t begin, std::size_t end, Drifted& how),                 \
       (step, next, begin, end, how))
GRAINLAW_PASSES(GRAINLAW_PLAIN_PASS)

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainlaw::dem
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {

GRAINLAW_PASSES(GRAINLAW_DISPATCHED_PASS)

std::vector<std::string> vector_targets() {
  hwy::SetSupportedTargetsForTest(0);
  std::vector<std::string> names;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
  return names;
}

void use_vector_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  std::int64_t chosen = name.empty() ? hwy::SupportedTargets() : 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (name == hwy::TargetName(target)) chosen = target;
  }
  if (chosen == 0) throw InvalidInput("this machine has no vector instructions called " + name);
  hwy::SetSupportedTargetsForTest(name.empty() ? 0 : chosen);
  hwy::GetChosenTarget().Update(chosen);
}

}  // namespace grainlaw::dem
#endif
