#include <gtest/gtest.h>

#include <algorithm>

#include "dem/element_tests/preparation.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

PackingOptions options_of(std::int64_t particles, std::uint64_t seed = 1) {
  PackingOptions options;
  options.particles = particles;
  options.seed = seed;
  return options;
}

State gas(const PackingOptions& options, double nu = 0.3) { return random_gas(options, nu, {}, {}); }

// Uniform on r_min [1, w] with r_min = 2<r>/(w+1): mean <r>, variance (r_max - r_min)^2/12.
TEST(RandomGas, RadiiAreUniformOnTheirInterval) {
  const PackingOptions options = options_of(4000);
  const State state = gas(options);
  const double r_min = 0.5e-3, r_max = 1.5e-3, n = 4000, variance = 1e-6 / 12;
  const auto [low, high] = std::minmax_element(state.packing.radius.begin(), state.packing.radius.end());
  EXPECT_GE(*low, r_min);
  EXPECT_LE(*high, r_max);
  EXPECT_LT(*low, r_min + 1e-5);
  EXPECT_GT(*high, r_max - 1e-5);
  EXPECT_NEAR(mean_radius(state.packing), 1e-3, 5 * std::sqrt(variance / n));
}

TEST(RandomGas, HasTheVolumeFractionNoMomentumAndACubicCell) {
  const State state = gas(options_of(200));
  const Packing& p = state.packing;
  EXPECT_NEAR(volume_fraction(p) / 0.3, 1, 1e-14);
  EXPECT_EQ(p.H, Eigen::Matrix3d(p.H(0, 0) * Eigen::Matrix3d::Identity()));
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  double scale = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    momentum += p.mass[i] * scene::velocity(p, i);
    scale += p.mass[i] * scene::velocity(p, i).norm();
  }
  EXPECT_GT(scale, 0);
  EXPECT_LE(momentum.norm(), 1e-14 * scale);
  EXPECT_EQ(state.seed, 1u);
}

// Uniform on [-a, a] each: mean square a^2/3, its variance over n spheres (a^4/5 - a^4/9)/n.
TEST(RandomGas, VelocitiesAreAlikeAlongAllAxes) {
  const State state = gas(options_of(4000));
  const double n = 4000;
  Eigen::Array3d square = Eigen::Array3d::Zero();
  for (std::size_t i = 0; i < state.packing.size(); ++i) square += scene::velocity(state.packing, i).array().square();
  square /= square.mean();
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(square[k], 1, 5 * std::sqrt(4. / 5 / n)) << "xyz"[k];
}

TEST(RandomGas, SpheresDoNotOverlap) {
  const State state = gas(options_of(200));
  const ReferenceSums sums = reference_sums(state.packing, state.material, scene::at_rest(state));
  EXPECT_LE(sums.overlap, 1e-10 * mean_radius(state.packing));
}

// With the paper's drag alone a sphere of speed v stops after v m/gamma_b: several mean radii, so that it meets others.
TEST(RandomGas, SpheresRunSeveralRadiiBeforeTheyStop) {
  const State state = gas(options_of(500));
  const Packing& p = state.packing;
  double path = 0;
  for (std::size_t i = 0; i < p.size(); ++i) path += scene::velocity(p, i).norm() * p.mass[i] / 0.1;
  const double mean_path = path / 500 / mean_radius(p);
  EXPECT_GT(mean_path, 3);
  EXPECT_LT(mean_path, 15);
}

TEST(RandomGas, IsAFunctionOfItsOptions) {
  const State a = gas(options_of(50)), b = gas(options_of(50)), c = gas(options_of(50, 2));
  EXPECT_EQ(a.packing.sx, b.packing.sx);
  EXPECT_EQ(a.packing.vz, b.packing.vz);
  EXPECT_EQ(a.packing.radius, b.packing.radius);
  EXPECT_NE(a.packing.radius, c.packing.radius);
  EXPECT_NE(a.packing.sx, c.packing.sx);
}

TEST(RandomGas, OneSphereAndEqualSpheresWork) {
  EXPECT_EQ(gas(options_of(1)).packing.size(), 1u);
  PackingOptions equal = options_of(20);
  equal.size_width = 1;
  for (const double r : gas(equal).packing.radius) EXPECT_NEAR(r, 1e-3, 1e-3 * 0x1p-22);
}

TEST(RandomGas, RefusesByTheNameOfTheKey) {
  const auto refusal = [](const PackingOptions& options, double nu) -> std::string {
    try {
      gas(options, nu);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](auto change) {
    PackingOptions options = options_of(10);
    change(options);
    return options;
  };
  EXPECT_TRUE(refusal(options_of(0), 0.3).starts_with("particles"));
  EXPECT_TRUE(refusal(options_of(1'000'000'000'000'000'000), 0.3).starts_with("particles"));
  EXPECT_TRUE(refusal(with([](auto& o) { o.size_width = 0.5; }), 0.3).starts_with("size_width"));
  EXPECT_TRUE(refusal(with([&](auto& o) { o.size_width = nan; }), 0.3).starts_with("size_width"));
  EXPECT_TRUE(refusal(with([](auto& o) { o.mean_radius = -1e-3; }), 0.3).starts_with("mean_radius"));
  EXPECT_TRUE(refusal(with([](auto& o) { o.material.density = 0; }), 0.3).starts_with("density"));
  EXPECT_TRUE(refusal(with([](auto& o) { o.material.stiffness = -1; }), 0.3).starts_with("stiffness"));
  EXPECT_TRUE(refusal(with([](auto& o) { o.material.contact_viscosity = -1; }), 0.3).starts_with("contact_viscosity"));
  EXPECT_TRUE(refusal(with([&](auto& o) { o.material.background_viscosity = nan; }), 0.3).starts_with("background"));
  EXPECT_TRUE(refusal(options_of(10), 0).starts_with("nu_gas"));
  EXPECT_TRUE(refusal(options_of(10), 0.8).starts_with("nu_gas"));
}

}  // namespace
}  // namespace grainlaw::dem
