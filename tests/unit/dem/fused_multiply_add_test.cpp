#include "dem/engine/lanes/fused_multiply_add-inl.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace grainlaw::dem {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Of the instructions that this file is compiled for: on x86-64 without a fused operation.
template <class Real>
Real composed(Real a, Real b, Real c) {
  const hn::ScalableTag<Real> d;
  return hn::GetLane(HWY_NAMESPACE::MultiplyAdd<true>()(hn::Set(d, a), hn::Set(d, b), hn::Set(d, c)));
}

template <class Real>
class FusedMultiplyAdd : public ::testing::Test {};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(FusedMultiplyAdd, Reals);

// a b in the middle of two neighbours, which c decides however small it is.
TYPED_TEST(FusedMultiplyAdd, RoundsOnceNextToATie) {
  constexpr bool is_float = std::is_same_v<TypeParam, float>;
  const TypeParam a = 1 + std::ldexp(TypeParam(1), is_float ? -12 : -26),
                  b = 1 + std::ldexp(TypeParam(1), is_float ? -12 : -27);
  const TypeParam c = std::ldexp(TypeParam(1), is_float ? -70 : -120);
  for (const TypeParam sign : {TypeParam(1), TypeParam(-1)}) {
    for (const TypeParam add : {c, -c, TypeParam(0)}) {
      EXPECT_EQ(composed<TypeParam>(sign * a, b, add), std::fma(sign * a, b, add)) << sign << ' ' << add;
    }
  }
  EXPECT_NE(std::fma(a, b, c), std::fma(a, b, -c));
}

TYPED_TEST(FusedMultiplyAdd, IsTheFusedOperation) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<TypeParam> uniform(-1, 1);
  int differing = 0, rounded_twice = 0;
  for (int k = 0; k < 100000; ++k) {
    const TypeParam a = uniform(engine), b = uniform(engine);
    const TypeParam c = k % 2 == 0 ? uniform(engine) : -a * b * (1 + 1e-3f * uniform(engine));  // nearly cancels
    const TypeParam fused = std::fma(a, b, c);
    differing += composed(a, b, c) != fused ? 1 : 0;
    rounded_twice += a * b + c != fused ? 1 : 0;
  }
  EXPECT_EQ(differing, 0);
  EXPECT_GT(rounded_twice, 1000);
}

}  // namespace
}  // namespace grainlaw::dem
