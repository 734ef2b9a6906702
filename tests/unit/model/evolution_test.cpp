#include "model/evolution.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "model/vocabulary/path.hpp"
#include "tests/support/law_parameters.hpp"

namespace grainlaw {
namespace {

using testing::kCouplings;

LawState<double> memoryless_state() {
  LawState<double> y{0.021, {}, {}};
  y.sigma << 0.0021, -0.0007, 0.0004, 0.0011, -0.0003;
  y.F << 0.08, 0.02, -0.03, 0.01, 0.05;
  return y;
}

StrainRate some_rate() {
  StrainRate rate;
  rate.tensor << 0.4, 0.3, -0.2, 0.3, 0.1, 0.15, -0.2, 0.15, -1.1;
  return rate;
}

LawState<double> rate_along(const LawParameters<double>& p, Coupling coupling, const LawState<double>& y, double nu,
                            const StrainRate& rate) {
  return testing::evolution_rate(p, coupling, y, nu, law_direction(rate));
}

/// Everything along one direction: y = (P, sigma N, F N).
LawState<double> coaxial(double P, double sigma, double F, const Deviator<double>& N) { return {P, sigma * N, F * N}; }

TEST(Evolution, DirectionIsCompressionPositive) {
  const LawDirection uni = law_direction(direction_of(Mode::UNI));
  EXPECT_EQ(uni.dx, 1);
  EXPECT_NEAR(uni.de, 1, 1e-15);
  EXPECT_NEAR(uni.N.norm(), 1, 1e-15);
  EXPECT_GT(tensor_of(uni.N)(2, 2), 0);
  const LawDirection iso = law_direction(direction_of(Mode::ISO));
  EXPECT_EQ(iso.dx, 3);
  EXPECT_EQ(iso.de, 0);
  EXPECT_TRUE(iso.N.isZero());
  const LawDirection d2 = law_direction(direction_of(Mode::D2, "xyz", true));
  EXPECT_EQ(d2.dx, 0);
  EXPECT_LT(tensor_of(d2.N)(2, 2), 0) << "reversed";
}

TEST(Evolution, TensorFormIsTheInvariantFormOnCoaxialPaths) {
  // equations.md 5.2: dP = B dx + A1 S sg de; dsig = A2 dx + DG S sg de; dF = beta_F (sg F_max - F) de; S = 1 - sg s/s_max
  const LawParameters<double> p = testing::coupled_parameters();
  for (const Coupling coupling : kCouplings) {
    for (const double sg : {1.0, -1.0}) {
      for (const double dx : {-0.8, 0.0, 1.3}) {
        for (const double nu : {0.68, 0.74, 0.82}) {
          const double P = 1.1 * p.isotropic.P_star(nu), sigma = 0.07 * P, F = 0.05, de = 1.7;
          const Deviator<double> N0 = law_direction(direction_of(Mode::D3)).N;
          const LawDirection direction{dx, de, sg * N0};
          const LawState<double> r = testing::evolution_rate(p, coupling, coaxial(P, sigma, F, N0), nu, direction);

          const double nu_c = p.shear_nu_c, B = p.isotropic.B_star(nu);
          const double s_max = p.stress_ratio_max.value(nu, nu_c), DG = p.stress_rate.value(nu, nu_c) * s_max * P;
          const double A2 = coupling == Coupling::single ? 0.137 * F / 3 : 1.18 * B * F;
          const double A1 = coupling == Coupling::single ? 0.137 * F : 2.0 / 3 * (A2 - sigma);
          const double S = 1 - sg * sigma / P / s_max;
          EXPECT_NEAR(r.P, B * dx + A1 * S * sg * de, 1e-14);
          EXPECT_NEAR(r.sigma.dot(N0), A2 * dx + DG * S * sg * de, 1e-14);
          EXPECT_NEAR(r.F.dot(N0), p.fabric_rate.value(nu, nu_c) * (sg * p.fabric_max.value(nu, nu_c) - F) * de, 1e-13);
          EXPECT_LE((r.sigma - r.sigma.dot(N0) * N0).norm(), 1e-15) << "stays co-axial";
          EXPECT_LE((r.F - r.F.dot(N0) * N0).norm(), 1e-14);
        }
      }
    }
  }
}

TEST(Evolution, WithoutCouplingItIsEquations17And18) {
  // ds/de = beta_s (s_max - s), dF/de = beta_F (F_max - F), dP = 0 on monotone shear with A = 0
  LawParameters<double> p = testing::coupled_parameters();
  p.anisotropy.a0 = 0;
  const LawDirection shear = law_direction(direction_of(Mode::D2));
  const double nu = 0.70, P = 0.016, s = 0.1, F = 0.08;
  const LawState<double> r = testing::evolution_rate(p, Coupling::single, coaxial(P, s * P, F, shear.N), nu, shear);
  EXPECT_EQ(r.P, 0);
  const double beta_s = p.stress_rate.value(nu, p.shear_nu_c), s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  EXPECT_NEAR(r.sigma.dot(shear.N) / P, beta_s * (s_max - s) * shear.de, 1e-13);
  const double beta_F = p.fabric_rate.value(nu, p.shear_nu_c), F_max = p.fabric_max.value(nu, p.shear_nu_c);
  EXPECT_NEAR(r.F.dot(shear.N), beta_F * (F_max - F) * shear.de, 1e-13);
}

TEST(Evolution, IsotropicRateIsTheBulkModulus) {
  const LawParameters<double> p = testing::coupled_parameters();
  const LawState<double> y = memoryless_state();
  const LawState<double> r = rate_along(p, Coupling::energy, y, 0.72, direction_of(Mode::ISO));
  EXPECT_EQ(r.P, 3 * p.isotropic.B_star(0.72));
  EXPECT_TRUE(r.F.isZero());
  EXPECT_LE((r.sigma - 3 * 1.18 * p.isotropic.B_star(0.72) * y.F).norm(), 1e-15);
}

TEST(Evolution, EnergyCouplingHasEqualMixedDerivatives) {
  // Work per initial volume: dW = (V/V0)(P dx + (2/3) sigma_dev de), V/V0 = exp(-x). At the start of shear (S = 1) it is
  // elastic, and dP/de = A1 must be exp(x) d/dx[exp(-x) (2/3) sigma_dev] = (2/3)(A2 - sigma_dev).
  const LawParameters<double> p = testing::coupled_parameters();
  for (const double nu : {0.68, 0.74, 0.82}) {
    for (const double sigma : {0.0, 5e-4, -1e-3}) {
      for (const double F : {0.02, 0.1, -0.05}) {
        const Deviator<double> N = law_direction(direction_of(Mode::D2)).N;
        const double P = p.isotropic.P_star(nu);
        const LawState<double> y = coaxial(P, sigma, F, N);
        const LawState<double> shear = testing::evolution_rate(p, Coupling::energy, y, nu, {0, 1, N});
        const LawState<double> iso =
            testing::evolution_rate(p, Coupling::energy, y, nu, {1, 0, Deviator<double>::Zero()});
        const double S = 1 - sigma / (P * p.stress_ratio_max.value(nu, p.shear_nu_c));
        const double A1 = shear.P / S, A2 = iso.sigma.dot(N);
        EXPECT_NEAR(A1, 2.0 / 3 * (A2 - sigma), 1e-15);
        EXPECT_NEAR(A2, 1.18 * iso.P * F, 1e-15);
      }
    }
  }
}

TEST(Evolution, SingleCouplingIsThePrintedOne) {
  // dP = A de and dsigma = A deps_v with deps_v = dx/3: A1 = A, A2 = A/3
  const LawParameters<double> p = testing::coupled_parameters();
  const Deviator<double> N = law_direction(direction_of(Mode::D2)).N;
  const LawState<double> y = coaxial(0.02, 0, 0.09, N);
  EXPECT_NEAR(testing::evolution_rate(p, Coupling::single, y, 0.7, {0, 1, N}).P, 0.137 * 0.09, 1e-16);
  EXPECT_NEAR(testing::evolution_rate(p, Coupling::single, y, 0.7, {3, 0, Deviator<double>::Zero()}).sigma.dot(N),
              0.137 * 0.09, 1e-16);
}

TEST(Evolution, RateTurnsWithTheExperiment) {
  const LawParameters<double> p = testing::coupled_parameters();
  const Eigen::Matrix3d R = Eigen::AngleAxisd(2.1, Eigen::Vector3d(-0.4, 1, 0.7).normalized()).toRotationMatrix();
  const auto turn = [&](const Deviator<double>& q) {
    return deviator<double>(Eigen::Matrix3d(R * tensor_of(q) * R.transpose()));
  };
  const LawState<double> y = memoryless_state(), turned{y.P, turn(y.sigma), turn(y.F)};
  StrainRate rate = some_rate(), turned_rate;
  turned_rate.tensor = R * rate.tensor * R.transpose();
  for (const Coupling coupling : kCouplings) {
    const LawState<double> a = rate_along(p, coupling, y, 0.7, rate),
                           b = rate_along(p, coupling, turned, 0.7, turned_rate);
    EXPECT_NEAR(b.P, a.P, 1e-14);
    EXPECT_LE((b.sigma - turn(a.sigma)).norm(), 1e-14);
    EXPECT_LE((b.F - turn(a.F)).norm(), 1e-13);
  }
}

TEST(Evolution, ReversingShearReversesTheOddParts) {
  // (sigma, F, N) -> -(sigma, F, N) leaves dP and turns dsigma', dF'.
  const LawParameters<double> p = testing::coupled_parameters();
  const LawState<double> y = memoryless_state(), mirrored{y.P, -y.sigma, -y.F};
  const LawDirection d = law_direction(some_rate()), back{d.dx, d.de, -d.N};
  for (const Coupling coupling : kCouplings) {
    const LawState<double> a = testing::evolution_rate(p, coupling, y, 0.7, d),
                           b = testing::evolution_rate(p, coupling, mirrored, 0.7, back);
    EXPECT_NEAR(a.P, b.P, 1e-16);
    EXPECT_LE((a.sigma + b.sigma).norm(), 1e-16);
    EXPECT_LE((a.F + b.F).norm(), 1e-15);
  }
}

TEST(Evolution, RateScalesWithTheSpeedOfTheParameter) {
  const LawParameters<double> p = testing::coupled_parameters();
  const LawState<double> y = memoryless_state();
  StrainRate fast = some_rate();
  fast.tensor *= 7;
  for (const Coupling coupling : kCouplings) {
    const LawState<double> a = rate_along(p, coupling, y, 0.7, some_rate()), b = rate_along(p, coupling, y, 0.7, fast);
    EXPECT_NEAR(b.P, 7 * a.P, 1e-13);
    EXPECT_LE((b.sigma - 7 * a.sigma).norm(), 1e-13);
    EXPECT_LE((b.F - 7 * a.F).norm(), 1e-12);
  }
}

TEST(Evolution, OtherScalarGivesTheSameRate) {
  const LawParameters<double> p = testing::coupled_parameters();
  const LawState<double> y = memoryless_state();
  const LawState<long double> wide{y.P, y.sigma.cast<long double>(), y.F.cast<long double>()};
  for (const Coupling coupling : kCouplings) {
    const auto a = rate_along(p, coupling, y, 0.7, some_rate());
    const auto b = testing::evolution_rate(cast<long double>(p), coupling, wide, 0.7, law_direction(some_rate()));
    EXPECT_NEAR(a.P, static_cast<double>(b.P), 1e-14 * std::abs(a.P));
    EXPECT_LE((a.sigma - b.sigma.cast<double>()).norm(), 1e-14 * a.sigma.norm());
    EXPECT_LE((a.F - b.F.cast<double>()).norm(), 1e-14 * a.F.norm());
  }
}

}  // namespace
}  // namespace grainlaw
