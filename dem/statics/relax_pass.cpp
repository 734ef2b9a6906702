#include "dem/statics/relax_pass.hpp"

// The code between foreach_target.h and HWY_ONCE is compiled once for each kind of vector instructions.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)  // nothing of theirs is used
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dem/statics/relax_pass.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "dem/engine/lanes/lane_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainlaw::dem {
namespace HWY_NAMESPACE {
namespace {

OverlapSums contact_forces_on(RelaxField& field, std::size_t begin, std::size_t end) {
  const Tag<double> d;
  using V = hn::Vec<Tag<double>>;
  const V zero = hn::Zero(d);
  const double *places = field.place.front().data(), *shifts = field.shift.front().data(),
               *motions = field.w.front().data();
  alignas(64) double overlap[kLanes] = {}, overlap2[kLanes] = {}, gx[kLanes], gy[kLanes], gz[kLanes], f2[kLanes];
  OverlapSums sums;
  for (std::size_t group = begin; group < end; ++group) {
    const std::uint32_t* sphere = field.sphere.data() + group * kLanes;
    std::uint32_t own[kLanes];
    for (std::size_t l = 0; l < kLanes; ++l) own[l] = sphere[l] * static_cast<std::uint32_t>(sizeof(Row));
    const NearTier* tier = field.tier.data() + field.first_tier[group];
    for (std::size_t o = 0; o < kLanes; o += hn::Lanes(d)) {
      const Quartet<Tag<double>> here = gather_rows(d, places, own + o, 0);
      V fx = zero, fy = zero, fz = zero, sum = hn::Load(d, overlap + o), sum2 = hn::Load(d, overlap2 + o);
      for (std::size_t k = 0; k < field.tiers[group]; ++k) {
        const Quartet<Tag<double>> there = gather_rows(d, places, tier[k].place + o, 0),
                                   shift = gather_rows(d, shifts, tier[k].shift + o, 0);
        const V dx = hn::Sub(hn::Sub(here.a, there.a), shift.a), dy = hn::Sub(hn::Sub(here.b, there.b), shift.b),
                dz = hn::Sub(hn::Sub(here.c, there.c), shift.c), reach = hn::Add(here.d, there.d);
        const V d2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
        const auto touching = hn::Lt(d2, hn::Mul(reach, reach));
        const V distance = hn::Sqrt(d2), delta = hn::Sub(reach, distance);
        const auto pushed = [&](V f, V along) {
          return hn::Add(f, hn::IfThenElseZero(touching, hn::Mul(delta, hn::Div(along, distance))));
        };
        fx = pushed(fx, dx);
        fy = pushed(fy, dy);
        fz = pushed(fz, dz);
        sum = hn::Add(sum, hn::IfThenElseZero(touching, delta));
        sum2 = hn::Add(sum2, hn::IfThenElseZero(touching, hn::Mul(delta, delta)));
        sums.meetings += hn::CountTrue(d, touching);
      }
      hn::Store(sum, d, overlap + o);
      hn::Store(sum2, d, overlap2 + o);
      const V inverse = gather_rows(d, motions, own + o, 0).d;
      hn::Store(hn::Mul(fx, inverse), d, gx + o);
      hn::Store(hn::Mul(fy, inverse), d, gy + o);
      hn::Store(hn::Mul(fz, inverse), d, gz + o);
      hn::Store(hn::Add(hn::Add(hn::Mul(fx, fx), hn::Mul(fy, fy)), hn::Mul(fz, fz)), d, f2 + o);
    }
    for (std::size_t l = 0; l < kLanes; ++l) field.g[sphere[l]] = {gx[l], gy[l], gz[l], f2[l]};
  }
  for (std::size_t l = 0; l < kLanes; ++l) {
    sums.overlap += overlap[l];
    sums.overlap2 += overlap2[l];
  }
  return sums;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainlaw::dem
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainlaw::dem {

HWY_EXPORT(contact_forces_on);

OverlapSums contact_forces(RelaxField& field, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(contact_forces_on)(field, begin, end);
}

}  // namespace grainlaw::dem
#endif
