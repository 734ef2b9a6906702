// Uniaxial compression, where every term of Eq. (16) works at once: against an independent integrator on the invariant
// form of the law (compression positive, de = dx, s_max, beta etc. at the current nu),
//   dP = B dx + A1 S de,  dsigma = A2 dx + DG S de,  dF = beta_F (F_max - F) de,  S = 1 - sigma/(P s_max),
// and under rotation of the whole experiment.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>

#include "predict/predict.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_parameters.hpp"
#include "tests/support/law_path.hpp"

namespace grainlaw {
namespace {

using predict::Method;

using testing::expect_figure;
using testing::leg_to;
using testing::path_from;

using Invariants = std::array<double, 3>;  // P, sigma, F

/// Boost.odeint, Runge-Kutta-Fehlberg 7(8), at 1e-14 per step.
Invariants by_odeint(const LawParameters<double>& p, Coupling coupling, double nu_0, double eps_dev) {
  const auto rate = [&](const Invariants& y, Invariants& dy, double e) {
    const auto [P, sigma, F] = y;
    const double nu = nu_0 * std::exp(e), nu_c = p.shear_nu_c;
    const double s_max = p.stress_ratio_max.value(nu, nu_c), beta_s = p.stress_rate.value(nu, nu_c);
    const double B = p.isotropic.B_star(nu);
    const double A2 = coupling == Coupling::single ? p.anisotropy.a0 * F / 3 : p.anisotropy.a2 * B * F;
    const double A1 = coupling == Coupling::single ? p.anisotropy.a0 * F : (A2 - sigma) * 2 / 3;
    const double S = 1 - sigma / (P * s_max);
    dy = {B + A1 * S, A2 + beta_s * s_max * P * S, p.fabric_rate.value(nu, nu_c) * (p.fabric_max.value(nu, nu_c) - F)};
  };
  namespace odeint = boost::numeric::odeint;
  Invariants y{p.isotropic.P_star(nu_0), 0, 0};
  const auto stepper = odeint::make_controlled<odeint::runge_kutta_fehlberg78<Invariants>>(1e-16, 1e-14);
  odeint::integrate_adaptive(stepper, rate, y, 0.0, eps_dev, 1e-5);
  return y;
}

TEST(Uniaxial, AgreesWithAnIndependentIntegrator) {
  const LawParameters<double> p = testing::coupled_parameters();
  double off = 0;
  for (const Coupling coupling : {Coupling::energy, Coupling::single}) {
    for (const double nu_0 : {0.671, 0.695, 0.728}) {
      for (const double nu_1 : {0.74, 0.82}) {
        const auto path = path_from(nu_0, {leg_to(Mode::UNI, nu_1)});
        const Invariants expected = by_odeint(p, coupling, nu_0, path[0].length);
        for (const Method method : {Method::adams, Method::bdf}) {
          const auto rows = predict::predict(Rung::evolution, p, coupling, path, predict::state_from_law(p, nu_0),
                                             {{0, path[0].length}}, {1e-12, 1e-16, method}, {}, {})
                                .rows;
          ASSERT_EQ(rows.size(), 1U);
          off = std::max({off, std::abs(rows[0].state.P / expected[0] - 1),
                          std::abs(rows[0].s_par * expected[0] / expected[1] - 1),
                          std::abs(rows[0].F_par / expected[2] - 1)});
        }
      }
    }
  }
  expect_figure("law.uniaxial_against_odeint", off, 5e-11);  // 50 rtol of BDF
}

TEST(Uniaxial, RotatedExperimentGivesTheRotatedResult) {
  const LawParameters<double> p = testing::coupled_parameters();
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  const auto rotated = [&](const Eigen::Matrix3d& a) { return Eigen::Matrix3d(R * a * R.transpose()); };

  auto path = path_from(0.695, {leg_to(Mode::UNI, 0.76), leg_to(Mode::UNI, 0.74, true), testing::leg(Mode::D2, 0.1)});
  auto turned = path;
  for (auto& segment : turned) {
    segment.direction.tensor = rotated(segment.direction.tensor);
    segment.strain_start.tensor = rotated(segment.strain_start.tensor);
  }
  LawState<double> start = predict::state_from_law(p, 0.695), turned_start = start;
  start.sigma << 1e-3, 2e-4, -3e-4, 1e-4, 5e-4;
  start.F << 0.02, -0.01, 0.005, 0.003, -0.002;
  turned_start.sigma = deviator<double>(rotated(tensor_of(start.sigma)));
  turned_start.F = deviator<double>(rotated(tensor_of(start.F)));

  for (const Rung model : {Rung::reduced, Rung::evolution}) {
    const auto points = predict::uniform_points(path, 20);
    const predict::Tolerances tight{1e-11, 1e-15};
    const auto a = predict::predict(model, p, Coupling::energy, path, start, points, tight, {}, {}).rows;
    const auto b = predict::predict(model, p, Coupling::energy, turned, turned_start, points, tight, {}, {}).rows;
    ASSERT_EQ(a.size(), points.size());
    ASSERT_EQ(b.size(), points.size());
    double off = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      off = std::max({off, std::abs(b[i].state.P / a[i].state.P - 1),
                      (tensor_of(b[i].state.sigma) - rotated(tensor_of(a[i].state.sigma))).norm() / a[i].state.P,
                      (tensor_of(b[i].state.F) - rotated(tensor_of(a[i].state.F))).norm(),
                      std::abs(a[i].s_par - b[i].s_par), std::abs(a[i].F_par - b[i].F_par)});
    }
    expect_figure("law.objectivity_" + to_string(model), off, model == Rung::reduced ? 1e-14 : 1e-9);
  }
}

TEST(Uniaxial, ReducedModelGivesThePublishedCurves) {
  // Figs. 12 and 14: Eqs. (17), (18) at the current nu with Table 3 and zero start, evaluated by hand to four digits.
  struct Curve {
    double nu_0;
    std::array<double, 5> eps_dev, s;
    std::array<double, 4> eps_dev_F, F;
  };
  constexpr Curve curves[] = {{0.671,
                               {.02, .05, .075, .10, .15},
                               {.1365, .1575, .1537, .1476, .1364},
                               {.05, .075, .10, .15},
                               {.1128, .1063, .0960, .0749}},
                              {0.695,
                               {.02, .05, .075, .10, .15},
                               {.1058, .1364, .1387, .1364, .1296},
                               {.05, .075, .10, .15},
                               {.0886, .0849, .0770, .0599}},
                              {0.728,
                               {.02, .05, .075, .10, .119},
                               {.0810, .1173, .1248, .1261, .1254},
                               {.05, .075, .10, .119},
                               {.0619, .0605, .0553, .0505}}};
  const LawParameters<double> p = testing::coupled_parameters();
  for (const Curve& curve : curves) {
    const auto path = path_from(curve.nu_0, {leg_to(Mode::UNI, 0.8215)});
    const auto at = [&](double eps_dev) {
      return predict::predict(Rung::reduced, p, Coupling::energy, path, predict::state_from_law(p, curve.nu_0),
                              {{0, eps_dev}}, {}, {}, {})
          .rows.at(0);
    };
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(at(curve.eps_dev[i]).s_par, curve.s[i], 0.6e-4) << curve.nu_0;
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(at(curve.eps_dev_F[i]).F_par, curve.F[i], 0.6e-4) << curve.nu_0;
  }
}

}  // namespace
}  // namespace grainlaw
