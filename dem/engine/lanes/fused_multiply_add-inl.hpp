// a b + c for vectors, rounded once. Fused where the machine has it (AVX2, AVX-512). Elsewhere the product is rounded, too,
// unless the same bits are asked for: then the fused operation is composed of others.
// Compiled once for each kind of vector instructions: Highway's guard instead of #pragma once.
#if defined(GRAINLAW_FUSED_MULTIPLY_ADD) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINLAW_FUSED_MULTIPLY_ADD
#undef GRAINLAW_FUSED_MULTIPLY_ADD
#else
#define GRAINLAW_FUSED_MULTIPLY_ADD
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace grainlaw::dem {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
constexpr bool kHasFused = true;
#else
constexpr bool kHasFused = false;
#endif

/// x + y and what rounding took from it.
template <class V>
struct Exact {
  V sum, rest;
};

template <class V>
HWY_INLINE Exact<V> add_exactly(V x, V y) {
  const V sum = hn::Add(x, y), part = hn::Sub(sum, x);
  return {sum, hn::Add(hn::Sub(x, hn::Sub(sum, part)), hn::Sub(y, part))};
}

/// x + y rounded to odd: an inexact sum gets an odd last bit, so that a second rounding does no harm.
template <class D, class V>
HWY_INLINE V add_to_odd(D d, V x, V y) {
  const hn::RebindToSigned<D> di;
  const Exact<V> e = add_exactly(x, y);
  const auto bits = hn::BitCast(di, e.sum);
  const auto one = hn::Set(di, 1);
  const auto even = hn::Eq(hn::And(bits, one), hn::Zero(di));
  const auto inexact = hn::RebindMask(di, hn::Ne(e.rest, hn::Zero(d)));
  // towards zero where the rest has not the sign of the sum
  const auto inward = hn::Lt(hn::Xor(bits, hn::BitCast(di, e.rest)), hn::Zero(di));
  const auto odd = hn::Add(bits, hn::IfThenElse(inward, hn::Set(di, -1), one));
  return hn::BitCast(d, hn::IfThenElse(hn::And(even, inexact), odd, bits));
}

/// The fused operation from double-precision ones (S. Boldo, G. Melquiond, IEEE Trans. Comput. 57 (2008) 462).
template <class V>
HWY_INLINE V fused_double(V a, V b, V c) {
  const hn::DFromV<V> d;
  const V splitter = hn::Set(d, 0x1p27 + 1);
  const auto head = [&](V x) {
    const V scaled = hn::Mul(splitter, x);
    return hn::Sub(scaled, hn::Sub(scaled, x));
  };
  const V ah = head(a), bh = head(b), al = hn::Sub(a, ah), bl = hn::Sub(b, bh), product = hn::Mul(a, b);
  const V rest = hn::Add(hn::Add(hn::Add(hn::Sub(hn::Mul(ah, bh), product), hn::Mul(ah, bl)), hn::Mul(al, bh)), hn::Mul(al, bl));
  const Exact<V> low = add_exactly(c, rest), high = add_exactly(product, low.sum);
  return hn::Add(high.sum, add_to_odd(d, low.rest, high.rest));
}

template <class V>
HWY_INLINE V fused_float(V a, V b, V c) {
  const hn::DFromV<V> d;
#if HWY_TARGET == HWY_SCALAR
  const hn::Rebind<double, hn::DFromV<V>> dd;
  return hn::DemoteTo(d, add_to_odd(dd, hn::Mul(hn::PromoteTo(dd, a), hn::PromoteTo(dd, b)), hn::PromoteTo(dd, c)));
#else
  const hn::Half<hn::DFromV<V>> half;
  const hn::Repartition<double, hn::DFromV<V>> dd;
  const auto part = [&](auto a2, auto b2, auto c2) {  // products of floats are exact
    return hn::DemoteTo(half, add_to_odd(dd, hn::Mul(hn::PromoteTo(dd, a2), hn::PromoteTo(dd, b2)), hn::PromoteTo(dd, c2)));
  };
  return hn::Combine(d, part(hn::UpperHalf(half, a), hn::UpperHalf(half, b), hn::UpperHalf(half, c)),
                     part(hn::LowerHalf(half, a), hn::LowerHalf(half, b), hn::LowerHalf(half, c)));
#endif
}

/// How a b + c is rounded.
template <bool portable>
struct MultiplyAdd {
  template <class V>
  HWY_INLINE V operator()(V a, V b, V c) const {
    if constexpr (kHasFused || !portable) {
      return hn::MulAdd(a, b, c);
    } else if constexpr (sizeof(hn::TFromV<V>) == 8) {
      return fused_double(a, b, c);
    } else {
      return fused_float(a, b, c);
    }
  }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainlaw::dem
HWY_AFTER_NAMESPACE();

#endif
