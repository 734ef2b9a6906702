// The first half of a step on vectors of any width.
// Compiled once for each kind of vector instructions: Highway's guard instead of #pragma once.
#if defined(GRAINLAW_LANE_DRIFT) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINLAW_LANE_DRIFT
#undef GRAINLAW_LANE_DRIFT
#else
#define GRAINLAW_LANE_DRIFT
#endif

#include <hwy/highway.h>

#include "dem/engine/lanes/lane_pass.hpp"
#include "dem/engine/lanes/lane_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainlaw::dem {
namespace HWY_NAMESPACE {
namespace {

template <class V>
struct Axes {
  V x, y, z;
};

template <class D, class Number>
HWY_INLINE void store(D d, const Axes<hn::Vec<D>>& v, Number* x, Number* y, Number* z) {
  hn::Store(v.x, d, x);
  hn::Store(v.y, d, y);
  hn::Store(v.z, d, z);
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

/// The first half of a step, a vector of spheres after the other: half kick, drift, rows. Those of a large scene go past the caches.
template <bool portable, bool large, class Real>
class Drift {
  using D = Tag<Real>;
  using V = hn::Vec<D>;
  using VI = hn::Vec<hn::RebindToSigned<D>>;
  static constexpr D d{};
  static constexpr hn::RebindToSigned<D> di{};

 public:
  explicit Drift(const LaneStep& step)
      : h_(set(step.half_dt)), x_(set(step.drift[0])), y_(set(step.drift[1])), z_(set(step.drift[2])),
        moved2_(step), allowed2_(square(step.allowed)), near_stretch_(set(step.near_stretch)), near_loss_(set(step.near_loss)),
        list_in_danger_(step.list_in_danger) {}

  /// Spheres from lane o of group g on, where they are, with their radii, accelerations and velocities; their rows go to `row`. Returns
  /// where they are then.
  HWY_INLINE Axes<VI> operator()(Lanes<Real>& lanes, Rows<Real>& row, std::size_t g, std::size_t o, const Axes<VI>& at, V radius,
                                 const Axes<V>& a, const Axes<V>& whole) {
    const MultiplyAdd<portable> multiply_add;
    SphereGroup<Real>& own = lanes.group[g];
    const Axes<V> v{multiply_add(h_, a.x, whole.x), multiply_add(h_, a.y, whole.y), multiply_add(h_, a.z, whole.z)};
    store(d, v, own.vx + o, own.vy + o, own.vz + o);
    const V dx = hn::Mul(v.x, x_), dy = hn::Mul(v.y, y_), dz = hn::Mul(v.z, z_);
    sane_ = hn::And(sane_, hn::Lt(hn::Add(hn::Add(hn::Abs(dx), hn::Abs(dy)), hn::Abs(dz)), limit_));
    const auto x = hn::Add(at.x, to_fixed(d, dx)), y = hn::Add(at.y, to_fixed(d, dy)), z = hn::Add(at.z, to_fixed(d, dz));
    const ListedGroup<Real>& listed = lanes.listed[g];
    if (list_in_danger_) listed_ = hn::And(listed_, hn::Lt(moved2_(x, y, z, listed.x + o, listed.y + o, listed.z + o), allowed2_));
    const V near_skin = hn::Load(d, own.near_skin + o), near_allowed = hn::Max(hn::Sub(hn::Mul(near_stretch_, near_skin), near_loss_), hn::Zero(d));
    near_ = hn::And(near_, hn::Lt(moved2_(x, y, z, own.near_x + o, own.near_y + o, own.near_z + o), hn::Mul(near_allowed, near_allowed)));
    auto* to = reinterpret_cast<Real*>(row.data() + g * kLanes + o);
    store_rows<large>(d, {hn::BitCast(d, x), hn::BitCast(d, y), hn::BitCast(d, z), hn::Add(radius, near_skin)},
                      {multiply_add(h_, a.x, v.x), multiply_add(h_, a.y, v.y), multiply_add(h_, a.z, v.z), radius}, to);
    return {x, y, z};
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainlaw::dem
HWY_AFTER_NAMESPACE();

#endif
