#include "dem/lane_pass.hpp"

// The code between foreach_target.h and HWY_ONCE is compiled once for each kind of vector instructions.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)  // nothing of theirs is used
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dem/lane_pass.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "dem/lane_vectors-inl.hpp"

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
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const auto place = [&](const FixedPoint<Real>* x) { return hn::BitCast(d, hn::Load(di, x + o)); };
      const auto predicted = [&](const Real* v, const Real* a) { return multiply_add(h, hn::Load(d, a + o), hn::Load(d, v + o)); };
      auto* to = reinterpret_cast<Real*>(lanes.row.data() + g * kLanes + o);
      const auto radius = hn::Load(d, own.radius + o);
      store_rows(d, {place(own.x), place(own.y), place(own.z), hn::Add(radius, hn::Load(d, own.near_skin + o))}, to, 0);
      store_rows(d, {predicted(own.vx, own.ax), predicted(own.vy, own.ay), predicted(own.vz, own.az), radius}, to, 4);
    }
  }
}

/// Squared distance from where spheres were, against the cell.
template <class Real, bool portable>
struct Moved2 {
  using D = Tag<Real>;
  using VI = hn::Vec<hn::RebindToSigned<D>>;
  Edge<D, portable> ex, ey, ez;
  explicit Moved2(const LaneStep& step) : ex(D(), step.edge[0]), ey(D(), step.edge[1]), ez(D(), step.edge[2]) {}
  HWY_INLINE hn::Vec<D> operator()(VI x, VI y, VI z, const FixedPoint<Real>* x_0, const FixedPoint<Real>* y_0,
                                   const FixedPoint<Real>* z_0) const {
    const D d;
    const hn::RebindToSigned<D> di;
    const MultiplyAdd<portable> multiply_add;
    const auto ux = ex(d, hn::Sub(x, hn::Load(di, x_0))), uy = ey(d, hn::Sub(y, hn::Load(di, y_0))), uz = ez(d, hn::Sub(z, hn::Load(di, z_0)));
    return multiply_add(ux, ux, multiply_add(uy, uy, hn::Mul(uz, uz)));
  }
};

template <bool portable, class Real>
double farthest_moved2_on(const Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  const hn::RebindToSigned<Tag<Real>> di;
  const Moved2<Real, portable> moved2(step);
  auto farthest2 = hn::Zero(d);
  for (std::size_t g = begin; g < end; ++g) {
    const SphereGroup<Real>& own = lanes.group[g];
    const ListedGroup<Real>& listed = lanes.listed[g];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      farthest2 = hn::Max(farthest2, moved2(hn::Load(di, own.x + o), hn::Load(di, own.y + o), hn::Load(di, own.z + o), listed.x + o,
                                            listed.y + o, listed.z + o));
    }
  }
  return static_cast<double>(hn::GetLane(hn::MaxOfLanes(d, farthest2)));
}

/// The first half of a step, a vector of spheres after the other: half kick, drift, rows.
template <bool portable, class Real>
class Drift {
  using D = Tag<Real>;
  using V = hn::Vec<D>;
  static constexpr D d{};
  static constexpr hn::RebindToSigned<D> di{};

 public:
  explicit Drift(const LaneStep& step)
      : h_(set(step.half_dt)), x_(set(step.drift[0])), y_(set(step.drift[1])), z_(set(step.drift[2])),
        moved2_(step), allowed2_(square(step.allowed)), near_stretch_(set(step.near_stretch)), near_loss_(set(step.near_loss)), list_in_danger_(step.list_in_danger) {}

  /// Spheres from lane o of group g on, with their accelerations and velocities; their rows go to `row`.
  HWY_INLINE void operator()(Lanes<Real>& lanes, std::vector<SphereRow<Real>>& row, std::size_t g, std::size_t o, V ax, V ay, V az, V vx,
                             V vy, V vz) {
    const MultiplyAdd<portable> multiply_add;
    SphereGroup<Real>& own = lanes.group[g];
    vx = multiply_add(h_, ax, vx);
    vy = multiply_add(h_, ay, vy);
    vz = multiply_add(h_, az, vz);
    hn::Store(vx, d, own.vx + o);
    hn::Store(vy, d, own.vy + o);
    hn::Store(vz, d, own.vz + o);
    const V dx = hn::Mul(vx, x_), dy = hn::Mul(vy, y_), dz = hn::Mul(vz, z_);
    sane_ = hn::And(sane_, hn::Lt(hn::Add(hn::Add(hn::Abs(dx), hn::Abs(dy)), hn::Abs(dz)), limit_));
    const auto x = hn::Add(hn::Load(di, own.x + o), to_fixed(d, dx)), y = hn::Add(hn::Load(di, own.y + o), to_fixed(d, dy)),
               z = hn::Add(hn::Load(di, own.z + o), to_fixed(d, dz));
    hn::Store(x, di, own.x + o);
    hn::Store(y, di, own.y + o);
    hn::Store(z, di, own.z + o);
    const ListedGroup<Real>& listed = lanes.listed[g];
    if (list_in_danger_) listed_ = hn::And(listed_, hn::Lt(moved2_(x, y, z, listed.x + o, listed.y + o, listed.z + o), allowed2_));
    const V near_skin = hn::Load(d, own.near_skin + o), near_allowed = hn::Max(hn::Sub(hn::Mul(near_stretch_, near_skin), near_loss_), hn::Zero(d));
    near_ = hn::And(near_, hn::Lt(moved2_(x, y, z, own.near_x + o, own.near_y + o, own.near_z + o), hn::Mul(near_allowed, near_allowed)));
    auto* to = reinterpret_cast<Real*>(row.data() + g * kLanes + o);
    const V radius = hn::Load(d, own.radius + o);
    store_rows(d, {hn::BitCast(d, x), hn::BitCast(d, y), hn::BitCast(d, z), hn::Add(radius, near_skin)}, to, 0);
    store_rows(d, {multiply_add(h_, ax, vx), multiply_add(h_, ay, vy), multiply_add(h_, az, vz), radius}, to, 4);
  }

  Drifted how() const {
    if (!hn::AllTrue(d, sane_)) return Drifted::lost;
    if (!hn::AllTrue(d, listed_)) return Drifted::beyond_list;
    return hn::AllTrue(d, near_) ? Drifted::well : Drifted::beyond_near;
  }

 private:
  static V set(double x) { return hn::Set(d, static_cast<Real>(x)); }
  static V square(double allowed) { return set(allowed > 0 ? allowed * allowed : -1); }

  V h_, x_, y_, z_;
  Moved2<Real, portable> moved2_;
  V allowed2_, near_stretch_, near_loss_;
  bool list_in_danger_;
  V limit_ = set(sizeof(Real) == 4 ? 0x1p29 : 0x1p49);
  hn::Mask<D> sane_ = hn::Eq(limit_, limit_), listed_ = sane_, near_ = sane_;
};

template <bool portable, class Real>
Drifted kick_and_drift_on(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  Drift<portable, Real> drift(step);
  for (std::size_t g = begin; g < end; ++g) {
    const SphereGroup<Real>& own = lanes.group[g];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const auto at = [&](const Real* x) { return hn::Load(d, x + o); };
      drift(lanes, lanes.row, g, o, at(own.ax), at(own.ay), at(own.az), at(own.vx), at(own.vy), at(own.vz));
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

/// Second half of a step but for storing velocities: after(group, lane, a_x, a_y, a_z, v_x, v_y, v_z) gets each vector of spheres.
template <bool portable, class Real, class After>
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
  fetch_rungs_from(lanes, end);
  for (std::size_t g = begin; g < end; ++g) {
    SphereGroup<Real>& own = lanes.group[g];
    const std::size_t first_rung = lanes.near_first[g], last_rung = first_rung + lanes.near_count[g];
    fetch_frontier(lanes, g);
    fetch_groups(lanes, g);
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const auto x = hn::Load(di, own.x + o), y = hn::Load(di, own.y + o), z = hn::Load(di, own.z + o);
      const V r = hn::Load(d, own.radius + o);
      const V vx = hn::Load(d, own.vx + o), vy = hn::Load(d, own.vy + o), vz = hn::Load(d, own.vz + o);
      const V wx = multiply_add(h, hn::Load(d, own.ax + o), vx), wy = multiply_add(h, hn::Load(d, own.ay + o), vy),
              wz = multiply_add(h, hn::Load(d, own.az + o), vz);
      V fx = zero, fy = zero, fz = zero;        // force
      V gx = zero, gy = zero, gz = zero;        // its viscous part
      V box = zero, lost = zero;
      for (std::size_t rung = first_rung; rung < last_rung; ++rung) {
        const std::uint32_t* row = lanes.near_rung[rung].row + o;
        const Quartet<Tag<Real>> place = gather_rows(d, rows, row, 0), motion = gather_rows(d, rows, row, 4);
        const V dx = ex(d, hn::Sub(x, hn::BitCast(di, place.a))), dy = ey(d, hn::Sub(y, hn::BitCast(di, place.b))),
                dz = ez(d, hn::Sub(z, hn::BitCast(di, place.c)));
        const V squared = multiply_add(dz, dz, multiply_add(dy, dy, hn::Mul(dx, dx)));
        const V distance = hn::Sqrt(squared);
        const V rounded = hn::Sub(hn::Add(r, motion.d), distance);
        const auto touching = hn::Gt(rounded, zero);
        const V inverse = hn::Div(one, distance);
        const V delta = overlap_of<portable>(rounded, squared, distance, inverse);
        // u . x_ij, of the cell and with the spheres' own velocities
        const V cell = multiply_add(hn::Mul(Lz, dz), dz, multiply_add(hn::Mul(Ly, dy), dy, hn::Mul(hn::Mul(Lx, dx), dx)));
        const V u = multiply_add(hn::Sub(wz, motion.c), dz,
                                 multiply_add(hn::Sub(wy, motion.b), dy, multiply_add(hn::Sub(wx, motion.a), dx, cell)));
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
      hn::Store(ax, d, own.ax + o);
      hn::Store(ay, d, own.ay + o);
      hn::Store(az, d, own.az + o);
      after(g, o, ax, ay, az, nx, ny, nz);
      // every contact is met twice: halves of what belongs to it, all of -sum F_v . v
      lost = multiply_add(set(0.5), lost, multiply_add(gz, nz, multiply_add(gy, ny, hn::Mul(gx, nx))));
      add_to(totals.box + o, d, box);
      add_to(totals.contact + o, d, lost);
      add_to(totals.v2 + o, d, multiply_add(nz, nz, multiply_add(ny, ny, hn::Mul(nx, nx))));
    }
  }
  return {-0.5 * sum_of(totals.box), -sum_of(totals.contact), sum_of(totals.v2)};
}

template <bool portable, class Real>
LaneSums force_and_kick_on(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  const Tag<Real> d;
  return forces_on<portable>(lanes, step, begin, end,
                                     [&](std::size_t g, std::size_t o, auto, auto, auto, auto vx, auto vy, auto vz) {
                                       SphereGroup<Real>& own = lanes.group[g];
                                       hn::Store(vx, d, own.vx + o);
                                       hn::Store(vy, d, own.vy + o);
                                       hn::Store(vz, d, own.vz + o);
                                     });
}

template <bool portable, class Real>
LaneSums force_kick_drift_on(Lanes<Real>& lanes, const LaneStep& step, const LaneStep& next, std::size_t begin, std::size_t end,
                          Drifted& how) {
  Drift<portable, Real> drift(next);
  const LaneSums sums = forces_on<portable>(
      lanes, step, begin, end,
      [&](std::size_t g, std::size_t o, auto ax, auto ay, auto az, auto vx, auto vy, auto vz) {
        drift(lanes, lanes.next_row, g, o, ax, ay, az, vx, vy, vz);
      });
  how = drift.how();
  return sums;
}

// What HWY_EXPORT needs: plain functions. One instance is enough where the machine can fuse.
#define GRAINLAW_BY_BITS(function, ...) \
  (step.portable_bits && !kHasFused ? function<!kHasFused>(__VA_ARGS__) : function<false>(__VA_ARGS__))
#define GRAINLAW_PASSES(Real, name)                                                                               \
  void write_rows_##name(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {          \
    GRAINLAW_BY_BITS(write_rows_on, lanes, step, begin, end);                                                     \
  }                                                                                                               \
  double farthest_moved2_##name(const Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) { \
    return GRAINLAW_BY_BITS(farthest_moved2_on, lanes, step, begin, end);                                         \
  }                                                                                                               \
  Drifted kick_and_drift_##name(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {    \
    return GRAINLAW_BY_BITS(kick_and_drift_on, lanes, step, begin, end);                                          \
  }                                                                                                               \
  LaneSums force_and_kick_##name(Lanes<Real>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {  \
    return GRAINLAW_BY_BITS(force_and_kick_on, lanes, step, begin, end);                                                \
  }                                                                                                               \
  LaneSums force_kick_drift_##name(Lanes<Real>& lanes, const LaneStep& step, const LaneStep& next, std::size_t begin, \
                                   std::size_t end, Drifted& how) {                                               \
    return GRAINLAW_BY_BITS(force_kick_drift_on, lanes, step, next, begin, end, how);                                \
  }
GRAINLAW_PASSES(float, mixed)
GRAINLAW_PASSES(double, full)
#undef GRAINLAW_PASSES
#undef GRAINLAW_BY_BITS

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainlaw::dem
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "model/error.hpp"

namespace grainlaw::dem {

HWY_EXPORT(write_rows_mixed);
HWY_EXPORT(write_rows_full);
HWY_EXPORT(farthest_moved2_mixed);
HWY_EXPORT(farthest_moved2_full);
HWY_EXPORT(kick_and_drift_mixed);
HWY_EXPORT(kick_and_drift_full);
HWY_EXPORT(force_and_kick_mixed);
HWY_EXPORT(force_and_kick_full);
HWY_EXPORT(force_kick_drift_mixed);
HWY_EXPORT(force_kick_drift_full);

void write_rows(Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(write_rows_mixed)(lanes, step, begin, end);
}
void write_rows(Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(write_rows_full)(lanes, step, begin, end);
}
double farthest_moved2(const Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(farthest_moved2_mixed)(lanes, step, begin, end);
}
double farthest_moved2(const Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(farthest_moved2_full)(lanes, step, begin, end);
}
Drifted kick_and_drift(Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(kick_and_drift_mixed)(lanes, step, begin, end);
}
Drifted kick_and_drift(Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(kick_and_drift_full)(lanes, step, begin, end);
}
LaneSums force_and_kick(Lanes<float>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(force_and_kick_mixed)(lanes, step, begin, end);
}
LaneSums force_and_kick(Lanes<double>& lanes, const LaneStep& step, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(force_and_kick_full)(lanes, step, begin, end);
}
LaneSums force_kick_drift(Lanes<float>& lanes, const LaneStep& step, const LaneStep& next, std::size_t begin, std::size_t end,
                          Drifted& how) {
  return HWY_DYNAMIC_DISPATCH(force_kick_drift_mixed)(lanes, step, next, begin, end, how);
}
LaneSums force_kick_drift(Lanes<double>& lanes, const LaneStep& step, const LaneStep& next, std::size_t begin, std::size_t end,
                          Drifted& how) {
  return HWY_DYNAMIC_DISPATCH(force_kick_drift_full)(lanes, step, next, begin, end, how);
}
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
