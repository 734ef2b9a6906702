// The memory rung under CVODE against a fixed-step Runge-Kutta method of order 4 on the same right-hand side, corners by
// hand; and what it is for: no stiffness beyond the elastic one, a dip of P after a reversal, a rise at constant volume.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "predict/predict.hpp"
#include "tests/support/law_parameters.hpp"
#include "tests/support/law_path.hpp"

namespace grainlaw::predict {
namespace {

using testing::leg;
using testing::leg_to;
using testing::path_from;

std::vector<LawState<double>> corners_by_runge_kutta(const LawParameters<double>& p,
                                                     const std::vector<StraightSegment>& path, LawState<double> y,
                                                     int steps) {
  std::vector<LawState<double>> out;
  for (const StraightSegment& segment : path) {
    const LawDirection d = law_direction(Eigen::Matrix3d(segment.direction.tensor + segment.spin));
    turn_corner(Rung::memory, y, d);
    const double h = segment.length / steps;
    for (int i = 0; i < steps; ++i) {
      const auto f = [&](double e, const LawState<double>& at) {
        return law_rate(p, Rung::memory, Coupling::energy, at, segment.nu(e), d);
      };
      const double e = i * h;
      const auto k1 = f(e, y), k2 = f(e + h / 2, moved(y, h / 2, k1)), k3 = f(e + h / 2, moved(y, h / 2, k2)),
                 k4 = f(e + h, moved(y, h, k3));
      y = moved(moved(moved(moved(y, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
    }
    out.push_back(y);
  }
  return out;
}

std::vector<OutputPoint> ends(const std::vector<StraightSegment>& path) {
  std::vector<OutputPoint> points;
  for (std::size_t k = 0; k < path.size(); ++k) points.push_back({static_cast<int>(k), path[k].length});
  return points;
}

TEST(Memory, TwoIntegratorsAgree) {
  const LawParameters<double> p = testing::memory_parameters();
  const auto paths = {
      path_from(0.69, {leg(Mode::D2, 0.1), leg(Mode::D2, 0.2, true), leg(Mode::D2, 0.07)}),
      path_from(0.695, {leg_to(Mode::UNI, 0.80), leg_to(Mode::UNI, 0.72, true)}),
      path_from(0.71, {leg(Mode::D2, 0.15), leg(Mode::D3, 0.1), leg_to(Mode::ISO, 0.75), leg(Mode::D2, 0.05, true)})};
  for (const auto& path : paths) {
    const LawState<double> start = state_from_law(p, path.front().nu_start);
    const auto rows =
        predict(Rung::memory, p, Coupling::energy, path, start, ends(path), {1e-10, 1e-14, Method::adams}, {}, {}).rows;
    const auto reference = corners_by_runge_kutta(p, path, start, 4000);
    ASSERT_EQ(rows.size(), path.size());
    for (std::size_t k = 0; k < path.size(); ++k) {
      // Order 4 at a step of 5e-5 and a rate of 240 leaves (0.012)^4/100 of the fabric: 2e-10.
      EXPECT_NEAR(rows[k].state.P, reference[k].P, 1e-8 * reference[k].P) << k;
      EXPECT_LE((rows[k].state.sigma - reference[k].sigma).norm(), 1e-8 * reference[k].P) << k;
      EXPECT_LE((rows[k].state.F - reference[k].F).norm(), 1e-8) << k;
    }
  }
}

TEST(Memory, PressureRisesInShearAndDipsWhereItTurns) {
  const LawParameters<double> p = testing::memory_parameters();
  const auto path = path_from(0.69, {leg(Mode::D2, 0.5), leg(Mode::D2, 0.5, true)});
  const auto points = uniform_points(path, 300);
  const auto rows = predict(Rung::memory, p, Coupling::energy, path, state_from_law(p, 0.69), points, {}, {}, {}).rows;
  ASSERT_EQ(rows.size(), points.size());
  const double P_D2 = p.steady.P_star(0.69);  // reached like exp(-26 e): to 1e-5 at the end of each leg
  EXPECT_NEAR(rows[300].state.P, P_D2, 1e-3 * P_D2);
  EXPECT_NEAR(rows.back().state.P, P_D2, 1e-3 * P_D2);
  double least = P_D2;
  for (std::size_t i = 301; i < rows.size(); ++i) least = std::min(least, rows[i].state.P);
  EXPECT_LT(least, 0.97 * P_D2);
  // s first falls with the elastic slope: sign change no earlier than DG/P allows.
  const double DG =
      p.memory.G *
      std::pow(0.69 / p.isotropic.pressure.nu_c *
                       std::exp((rows[300].state.P - p.isotropic.P_star(0.69)) / p.isotropic.B_star(0.69)) -
                   1,
               p.memory.alpha);
  const auto crossing =
      std::find_if(rows.begin() + 301, rows.end(), [](const PredictedRow& row) { return row.s_par < 0; });
  EXPECT_GT(crossing->shear_path - 0.5, rows[300].s_par * least / DG);
}

TEST(Memory, SpinTurnsTheStateAndNothingElse) {
  const LawParameters<double> p = testing::memory_parameters();
  auto path = path_from(0.70, {leg(Mode::D2, 0.1), leg(Mode::D2, 0.1)});
  path[1].direction.tensor.setZero();
  path[1].length = std::acos(-1.0) / 2;
  path[1].spin << 0, -1, 0, 1, 0, 0, 0, 0, 0;  // a quarter turn about z: xx and yy change places
  const auto rows = predict(Rung::memory, p, Coupling::energy, path, state_from_law(p, 0.70), ends(path),
                            {1e-11, 1e-15, Method::adams}, {}, {})
                        .rows;
  ASSERT_EQ(rows.size(), 2U);
  const Eigen::Matrix3d before = tensor_of(rows[0].state.sigma), after = tensor_of(rows[1].state.sigma);
  const double scale = before.norm();
  EXPECT_NEAR(after(0, 0), before(1, 1), 1e-9 * scale);
  EXPECT_NEAR(after(1, 1), before(0, 0), 1e-9 * scale);
  EXPECT_NEAR(after(2, 2), before(2, 2), 1e-9 * scale);
  EXPECT_NEAR(after(0, 1), 0, 1e-9 * scale);
  EXPECT_EQ(rows[1].state.P, rows[0].state.P);
}

TEST(Memory, PassesTheJammingDensityOfTheReferenceWhileItCarries) {
  // After shear P is above the reference; on expansion it vanishes at the density nu_c nu/nu_P, below nu_c.
  const LawParameters<double> p = testing::memory_parameters();
  const auto path = path_from(0.675, {leg(Mode::D2, 0.2), leg(Mode::ISO, 0.03, true)});
  const auto prediction =
      predict(Rung::memory, p, Coupling::energy, path, state_from_law(p, 0.675), uniform_points(path, 200), {}, {}, {});
  EXPECT_TRUE(prediction.unjammed);
  ASSERT_EQ(prediction.events.size(), 1U);
  const double nu_J = prediction.events[0].nu;
  EXPECT_LT(nu_J, p.isotropic.pressure.nu_c);
  EXPECT_GT(nu_J, p.steady.pressure.nu_c - 0.003);
  for (const PredictedRow& row : prediction.rows) EXPECT_EQ(row.state.P > 0, row.nu > nu_J) << row.nu;
}

}  // namespace
}  // namespace grainlaw::predict
