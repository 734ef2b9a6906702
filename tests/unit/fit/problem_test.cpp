#include "fit/statistics/problem.hpp"

#include <gtest/gtest.h>

#include <array>
#include <new>

namespace grainlaw::fit {
namespace {

/// a + b d with d*d = 0: the smallest dual number that differentiated() accepts.
struct Dual {
  static constexpr int DIMENSION = 2;
  double a = 0;
  Eigen::Vector2d v = Eigen::Vector2d::Zero();
  Dual() = default;
  explicit Dual(double value) : a(value) {}
  Dual(double value, int k) : a(value) { v(k) = 1; }
};
Dual operator*(const Dual& x, const Dual& y) {
  Dual z;
  z.a = x.a * y.a;
  z.v = x.a * y.v + y.a * x.v;
  return z;
}

TEST(ResidualBlock, DifferentiatesRowByRow) {
  const auto evaluate = differentiated<Dual>(
      [](const auto* x, auto* misfit) {
        misfit[0] = x[0] * x[1];
        misfit[1] = x[0] * x[0];
        return true;
      },
      2, 2);
  const std::array<double, 2> x{3, 5};
  std::array<double, 2> r{};
  std::array<double, 4> J{};
  ASSERT_TRUE(evaluate(x.data(), r.data(), J.data()));
  EXPECT_EQ(r, (std::array<double, 2>{15, 9}));
  EXPECT_EQ(J, (std::array<double, 4>{5, 3, 6, 0}));  // d(xy) = (y, x), d(x^2) = (2x, 0), row-major
  r = {};
  ASSERT_TRUE(evaluate(x.data(), r.data(), nullptr));
  EXPECT_EQ(r, (std::array<double, 2>{15, 9}));
}

TEST(ResidualBlock, DifferentiatesMoreParametersInMorePasses) {
  const auto evaluate = differentiated<Dual>(
      [](const auto* x, auto* misfit) {
        misfit[0] = x[0] * x[1] * x[2];
        misfit[1] = x[3] * x[4];
        return true;
      },
      5, 2);
  const std::array<double, 5> x{2, 3, 5, 7, 11};
  std::array<double, 2> r{};
  std::array<double, 10> J{};
  ASSERT_TRUE(evaluate(x.data(), r.data(), J.data()));
  EXPECT_EQ(r, (std::array<double, 2>{30, 77}));
  EXPECT_EQ(J, (std::array<double, 10>{15, 10, 6, 0, 0, 0, 0, 0, 11, 7}));
}

// In whichever thread memory runs out.
TEST(ResidualBlock, PassesOnWhatIsThrownInAnyThread) {
  std::vector<ResidualBlock> blocks(64);
  for (ResidualBlock& block : blocks) {
    block.weight = Eigen::VectorXd::Ones(1);
    block.evaluate = [](const double*, double*, double*) -> bool { throw std::bad_alloc(); };
  }
  double misfit[64] = {};
  for (const int threads : {1, 4})
    EXPECT_THROW(evaluate(blocks, Eigen::VectorXd::Zero(1), threads, misfit, nullptr), std::bad_alloc) << threads;
}

TEST(ResidualBlock, PassesOnThatTheModelIsUndefined) {
  const auto evaluate = differentiated<Dual>([](const auto*, auto*) { return false; }, 2, 1);
  const std::array<double, 2> x{};
  std::array<double, 2> r{}, J{};
  EXPECT_FALSE(evaluate(x.data(), r.data(), nullptr));
  EXPECT_FALSE(evaluate(x.data(), r.data(), J.data()));
}

}  // namespace
}  // namespace grainlaw::fit
