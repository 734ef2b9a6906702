#include "model/law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/vocabulary/error.hpp"
#include "model/vocabulary/path.hpp"
#include "tests/support/law_parameters.hpp"

namespace grainlaw {
namespace {

using testing::kCouplings;

LawState<double> some_state() {
  LawState<double> y{0.021, {}, {}, {}, {}};
  y.sigma << 0.0021, -0.0007, 0.0004, 0.0011, -0.0003;
  y.F << 0.08, 0.02, -0.03, 0.01, 0.05;
  y.s_r << -0.05, 0.02, -0.08, 0.01, 0.03;
  y.E << 0.3, -0.1, 0.2, 0.4, -0.25;
  return y;
}

Eigen::Matrix3d some_gradient() {
  Eigen::Matrix3d L;
  L << 0.4, 0.9, -0.2, -0.3, 0.1, 0.15, -0.8, 0.45, -1.1;
  return L;
}

Deviator<double> turned(const Deviator<double>& q, const Eigen::Matrix3d& R) {
  return deviator<double>(Eigen::Matrix3d(R * tensor_of(q) * R.transpose()));
}

LawState<double> turned(const LawState<double>& y, const Eigen::Matrix3d& R) {
  return {y.P, turned(y.sigma, R), turned(y.F, R), turned(y.s_r, R), turned(y.E, R)};
}

/// Tolerances are relative, of what is below one absolute.
void expect_equal(const LawState<double>& a, const LawState<double>& b, double tolerance) {
  EXPECT_NEAR(a.P, b.P, tolerance * std::max(1.0, std::abs(a.P)));
  const auto expect_equal_deviators = [tolerance](const Deviator<double>& x, const Deviator<double>& y) {
    EXPECT_LE((x - y).norm(), tolerance * std::max(1.0, x.norm()));
  };
  expect_equal_deviators(a.sigma, b.sigma);
  expect_equal_deviators(a.F, b.F);
  expect_equal_deviators(a.s_r, b.s_r);
  expect_equal_deviators(a.E, b.E);
}

TEST(Law, NamesReadBack) {
  for (const Rung rung : kRungs) EXPECT_EQ(value_of<Rung>(to_string(rung), "rung"), rung);
  EXPECT_THROW(value_of<Rung>("Eq. 16", "rung"), InvalidInput);
}

TEST(Law, DirectionOfAVelocityGradient) {
  const Eigen::Matrix3d L = some_gradient();
  const LawDirection direction = law_direction(L), of_rate = law_direction(StrainRate{0.5 * (L + L.transpose())});
  EXPECT_EQ(direction.dx, of_rate.dx);
  EXPECT_EQ(direction.N, of_rate.N);
  const Eigen::Matrix3d W = 0.5 * (L - L.transpose());
  const Eigen::Vector3d a(0.3, -0.8, 0.5);
  EXPECT_LE((W * a - direction.spin.cross(a)).norm(), 1e-15);
}

// Table 1: theta of the strain rate is 30 degrees in D2, 60 in D3 and UNI, 0 in their reverse.
TEST(Law, LodeAngleOfTheShear) {
  const auto lode = [](Mode mode, bool reverse) { return law_direction(direction_of(mode, "xyz", reverse)).lode; };
  EXPECT_NEAR(lode(Mode::D2, false), 0, 1e-15);
  EXPECT_NEAR(lode(Mode::D2, true), 0, 1e-15);
  for (const Mode mode : {Mode::D3, Mode::UNI}) {
    EXPECT_NEAR(lode(mode, false), 1, 1e-14) << to_string(mode);
    EXPECT_NEAR(lode(mode, true), -1, 1e-14) << to_string(mode);
  }
  EXPECT_EQ(lode(Mode::ISO, false), 0);
  const Eigen::Matrix3d L = some_gradient(), D = 0.5 * (L + L.transpose());
  EXPECT_NEAR(law_direction(L).lode, -std::cos(3 * lode_angle(D) * std::numbers::pi / 180), 1e-12);
}

TEST(Law, LodeAngleChangesTheLimitsAndNothingElse) {
  LawParameters<double> p = testing::coupled_parameters(), changed = p;
  p.memory = changed.memory = {0.8, 0.7, 2.5, 10, 45, 9, 1.0, 0.7, 0.6, 1.18};
  changed.lode = {0.03, 0.9};
  const double nu = 0.76, y = nu / p.shear_nu_c - 1;
  for (const Rung rung : kRungs) {
    for (const double sense : {1.0, -1.0}) {
      const LawDirection direction = law_direction(direction_of(Mode::D3, "xyz", sense < 0));
      LawParameters<double> same = p;
      for (double* Q : {&same.stress_ratio_max.Q_limit, &same.stress_ratio_max.Q_c}) *Q *= 1 + sense * 0.03;
      for (double* Q : {&same.fabric_max.Q_limit, &same.fabric_max.Q_c}) *Q *= 1 - sense * 0.9 * y;
      for (const Coupling coupling : kCouplings)
        expect_equal(law_rate(changed, rung, coupling, some_state(), nu, direction),
                     law_rate(same, rung, coupling, some_state(), nu, direction), 1e-13);
    }
    const LawDirection D2 = law_direction(direction_of(Mode::D2, "xyz", false));
    expect_equal(law_rate(changed, rung, Coupling::energy, some_state(), nu, D2),
                 law_rate(p, rung, Coupling::energy, some_state(), nu, D2), 1e-13);
  }
}

TEST(Law, CorotationIsWaMinusAw) {
  const Eigen::Matrix3d L = some_gradient(), W = 0.5 * (L - L.transpose());
  const Deviator<double> q = some_state().F;
  const Eigen::Matrix3d a = tensor_of(q);
  EXPECT_LE((tensor_of(corotation(law_direction(L).spin, q)) - (W * a - a * W)).norm(), 1e-15);
}

TEST(Law, SpinAloneTurnsTheState) {
  // dL = W: after e the state is R y R^T with R = exp(W e); its rate at the start is W y - y W, whatever the rung.
  const Eigen::Vector3d w(0.3, -0.5, 0.8);
  LawDirection direction;
  direction.spin = w;
  const double h = 1e-6;
  const Eigen::Matrix3d forth = Eigen::AngleAxisd(h * w.norm(), w.normalized()).toRotationMatrix();
  const LawState<double> y = some_state(), after = turned(y, forth), before = turned(y, forth.transpose());
  for (const Rung rung : kRungs) {
    const LawState<double> rate = law_rate(testing::coupled_parameters(), rung, Coupling::energy, y, 0.72, direction);
    EXPECT_EQ(rate.P, 0);
    EXPECT_LE((rate.sigma - (after.sigma - before.sigma) / (2 * h)).norm(), 1e-11);
    EXPECT_LE((rate.F - (after.F - before.F) / (2 * h)).norm(), 1e-10);
    EXPECT_LE((rate.s_r - (after.s_r - before.s_r) / (2 * h)).norm(), 1e-10);
    EXPECT_LE((rate.E - (after.E - before.E) / (2 * h)).norm(), 1e-9);
  }
}

TEST(Law, RateOfATurnedExperimentIsTheTurnedRate) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(2.1, Eigen::Vector3d(-0.4, 1, 0.7).normalized()).toRotationMatrix();
  const Eigen::Matrix3d L = some_gradient();
  for (const Rung rung : kRungs) {
    for (const Coupling coupling : kCouplings) {
      const LawState<double> y = some_state();
      const LawState<double> a = law_rate(testing::coupled_parameters(), rung, coupling, y, 0.7, law_direction(L));
      const LawState<double> b = law_rate(testing::coupled_parameters(), rung, coupling, turned(y, R), 0.7,
                                          law_direction(Eigen::Matrix3d(R * L * R.transpose())));
      expect_equal(b, turned(a, R), 1e-12);
    }
  }
}

TEST(Law, RateDoesNotSeeAnObserverWhoTurns) {
  // In a frame that turns with Q(t), dQ/dt = Omega Q, at Q = 1: L becomes L + Omega, and every rate gains Omega a - a Omega.
  const Eigen::Matrix3d L = some_gradient();
  const Eigen::Vector3d omega(-0.7, 0.2, 1.3);
  Eigen::Matrix3d Omega;
  Omega << 0, -omega(2), omega(1), omega(2), 0, -omega(0), -omega(1), omega(0), 0;
  const LawState<double> y = some_state();
  for (const Rung rung : kRungs) {
    LawState<double> still = law_rate(testing::coupled_parameters(), rung, Coupling::energy, y, 0.7, law_direction(L));
    still.sigma += corotation(omega, y.sigma);
    still.F += corotation(omega, y.F);
    still.s_r += corotation(omega, y.s_r);
    still.E += corotation(omega, y.E);
    expect_equal(law_rate(testing::coupled_parameters(), rung, Coupling::energy, y, 0.7,
                          law_direction(Eigen::Matrix3d(L + Omega))),
                 still, 1e-13);
  }
}

TEST(Law, ReducedIsEvolutionWithoutCouplingAtConstantVolume) {
  LawParameters<double> p = testing::coupled_parameters();
  p.anisotropy.a0 = 0;
  const LawDirection shear = law_direction(direction_of(Mode::D2));
  const LawState<double> y = some_state();
  expect_equal(law_rate(p, Rung::reduced, Coupling::single, y, 0.7, shear),
               law_rate(p, Rung::evolution, Coupling::single, y, 0.7, shear), 1e-15);
}

TEST(Law, ReducedKeepsTheStressRatioInIsotropicStrain) {
  // equations.md 5.5: its rates assume nothing of P, d(sigma'/P) = 0 without shear.
  const LawState<double> y = some_state(), r = law_rate(testing::coupled_parameters(), Rung::reduced, Coupling::energy,
                                                        y, 0.7, law_direction(direction_of(Mode::ISO)));
  EXPECT_LE((r.sigma / y.P - y.sigma * (r.P / (y.P * y.P))).norm(), 1e-15);
  EXPECT_EQ(r.P, 3 * testing::coupled_parameters().isotropic.B_star(0.7));
}

TEST(Law, OnlyMemoryTurnsCorners) {
  const LawDirection back = law_direction(direction_of(Mode::D2, "xyz", true));
  for (const Rung rung : kRungs) {
    LawState<double> y{0.02, -0.002 * back.N, {}, Deviator<double>::Zero()};
    y.F.setZero();
    ASSERT_LT(reversal_value(y, back), 0);
    turn_corner(rung, y, back);
    EXPECT_LE((y.s_r - (rung == Rung::memory ? 1.0 : 0.0) * y.sigma / y.P).norm(), 1e-16);
  }
}

}  // namespace
}  // namespace grainlaw
