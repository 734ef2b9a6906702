// Isotropic paths. Without shear Eq. (16) is dP = B dx, and B is the derivative of Eq. (14), so that P - P(nu) of Eq. (14)
// is constant: loops close (hard case O3), and a path that unloads unjams where P vanishes (O8), which for a start with
// P_0 = P(nu_0) - d is where P(nu) = d, and nu = nu_c for d <= 0.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "predict/predict.hpp"
#include "predict/solvers/cvode.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_parameters.hpp"
#include "tests/support/law_path.hpp"

namespace grainlaw {
namespace {

using predict::Method;

using predict::Prediction;
using testing::expect_figure;
using testing::leg;
using testing::leg_to;
using testing::path_from;

constexpr double kLow = 0.67, kHigh = 0.82;  // P(0.82) is 54 times P(0.67)

/// Largest deviation of P from Eq. (14) over the loop 0.67 -> 0.82 -> 0.67, relative to the P of Eq. (14) right there.
double isotropic_loop(Coupling coupling, const predict::Tolerances& tolerances) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(kLow, {leg_to(Mode::ISO, kHigh), leg_to(Mode::ISO, kLow, true)});
  const auto points = predict::uniform_points(path, 100);
  const Prediction loop = predict::predict(Rung::evolution, p, coupling, path, predict::state_from_law(p, kLow), points,
                                           tolerances, {}, {});
  EXPECT_EQ(loop.rows.size(), points.size());
  EXPECT_NEAR(loop.rows.back().nu, kLow, 1e-15);
  double error = 0;
  for (const auto& row : loop.rows) {
    error = std::max(error, std::abs(row.state.P / p.isotropic.P_star(row.nu) - 1));
    EXPECT_TRUE(row.state.sigma.isZero() && row.state.F.isZero());
    EXPECT_TRUE(std::isnan(row.s_par) && std::isnan(row.F_par)) << "undefined on a path without shear";
  }
  return error;
}

/// The same loop after shear at 0.67, where Eq. (16) couples fabric and volume. With F' at rest
///   P - P_0 = P(nu) - P(0.67),  sigma' - sigma'_0 = a2 F' (P - P_0) (energy) or (a0/3) F' ln(nu/0.67) (single);
/// largest deviation of P and of sigma' over the P right there.
double sheared_loop(Coupling coupling, const predict::Tolerances& tolerances) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(kLow, {leg(Mode::D2, 0.1), leg_to(Mode::ISO, kHigh), leg_to(Mode::ISO, kLow, true)});
  const auto points = predict::uniform_points(path, 100);
  const Prediction loop = predict::predict(Rung::evolution, p, coupling, path, predict::state_from_law(p, kLow), points,
                                           tolerances, {}, {});
  EXPECT_EQ(loop.rows.size(), points.size());
  const LawState<double>& corner = loop.rows.at(100).state;
  EXPECT_GT(corner.F.norm(), 0.1) << "there is fabric to couple";
  double error = 0;
  for (std::size_t i = 101; i < loop.rows.size(); ++i) {
    const auto& row = loop.rows[i];
    const double P = corner.P + p.isotropic.P_star(row.nu) - p.isotropic.P_star(kLow);
    const double g =
        coupling == Coupling::energy ? p.anisotropy.a2 * (P - corner.P) : p.anisotropy.a0 / 3 * std::log(row.nu / kLow);
    error =
        std::max({error, std::abs(row.state.P / P - 1), (row.state.sigma - corner.sigma - g * corner.F).norm() / P});
  }
  return error;
}

TEST(Isotropic, O3LoopFollowsEquation14AndCloses) {
  for (const Coupling coupling : {Coupling::energy, Coupling::single}) {
    double plain = 0, sheared = 0;
    for (const Method method : {Method::adams, Method::bdf}) {
      plain = std::max(plain, isotropic_loop(coupling, {1e-10, 1e-14, method}));
      sheared = std::max(sheared, sheared_loop(coupling, {1e-10, 1e-14, method}));
    }
    expect_figure("O3.error_over_local_P_" + to_string(coupling), plain, 1e-8);
    expect_figure("O3.error_over_local_P_after_shear_" + to_string(coupling), sheared, 1e-8);
  }
}

TEST(Isotropic, O3BulkModulusIntegratesToEquation14) {
  // The product need not integrate B dx, because it knows P(nu); here B alone makes the loop. An error made at 0.82 is
  // carried down as it is, hence over the largest P.
  const LawParameters<double> p = testing::coupled_parameters();
  const double length = std::log(kHigh / kLow);
  double off = 0;
  for (const Method method : {Method::adams, Method::bdf}) {
    double from = 0, sense = 0;  // of the half of the loop
    predict::Cvode solver(1, {1e-10, 1e-14, method}, [&](double x, const double*, double* rate) {
      const LawState<double> state{1, Deviator<double>::Zero(), Deviator<double>::Zero()};
      const LawDirection direction{sense, 0, Deviator<double>::Zero()};
      rate[0] = testing::evolution_rate(p, Coupling::energy, state, from * std::exp(sense * x), direction).P;
    });
    std::array<double, 1> P{p.isotropic.P_star(kLow)};
    for (const bool unloading : {false, true}) {
      from = unloading ? kHigh : kLow;
      sense = unloading ? -1 : 1;
      solver.start(0, P, length);
      for (int i = 1; i <= 50; ++i) {
        const double x = length * i / 50;
        ASSERT_EQ(solver.advance(x, P).kind, predict::Arrival::Kind::reached);
        off =
            std::max(off, std::abs(P[0] - p.isotropic.P_star(from * std::exp(sense * x))) / p.isotropic.P_star(kHigh));
      }
    }
  }
  expect_figure("O3.integral_of_B_over_largest_P", off, 1e-8);
}

TEST(Isotropic, FabricAndStressKeepTheirDirectionUnderCompression) {
  // dsigma' = a2 B F' dx with F' constant: sigma' - sigma'_0 = a2 F' (P - P_0), exactly.
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.70, {leg_to(Mode::ISO, 0.80)});
  LawState<double> start = predict::state_from_law(p, 0.70);
  start.F << 0.09, -0.03, 0.02, 0.01, -0.04;
  start.sigma << 0.001, 0.0005, -0.0002, 0, 0.0001;
  const auto rows = predict::predict(Rung::evolution, p, Coupling::energy, path, start,
                                     predict::uniform_points(path, 10), {1e-10, 1e-14}, {}, {})
                        .rows;
  ASSERT_EQ(rows.size(), 11U);
  for (const auto& row : rows) {
    EXPECT_EQ((row.state.F - start.F).norm(), 0);
    const Deviator<double> expected = start.sigma + p.anisotropy.a2 * (row.state.P - start.P) * start.F;
    EXPECT_LE((row.state.sigma - expected).norm(), 1e-9 * expected.norm());
  }
}

/// Volumetric strain between nu = 0.70 and the end of an isotropic unloading that begins with P = P(0.70) + excess.
double expected_unjamming(const LawParameters<double>& p, double excess) {
  if (excess >= 0) return std::log(0.70 / p.isotropic.pressure.nu_c);
  const auto f = [&](double nu) { return p.isotropic.P_star(nu) + excess; };
  boost::math::tools::eps_tolerance<double> tight(52);
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(f, p.isotropic.pressure.nu_c, 0.70, tight, iterations);
  return std::log(0.70 / (0.5 * (bracket.first + bracket.second)));
}

TEST(Isotropic, O8UnjammingIsFoundWhereThePressureVanishes) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.70, {leg(Mode::ISO, 0.10, true)});
  const auto points = predict::uniform_points(path, 1000);
  double off = 0;
  for (const Method method : {Method::adams, Method::bdf}) {
    for (const double part : {0.1, 0.5, 0.9, 0.999, 1.0, 1.001, 1.5}) {
      LawState<double> start = predict::state_from_law(p, 0.70);
      const double P = start.P;
      start.P *= part;
      const Prediction unloading =
          predict::predict(Rung::evolution, p, Coupling::energy, path, start, points, {1e-10, 1e-14, method}, {}, {});
      EXPECT_TRUE(unloading.unjammed);
      EXPECT_EQ(unloading.rows.size(), points.size());
      const double at = 3 * unloading.unjammed_at.e;  // tr D = 3
      off = std::max(off, std::abs(at - expected_unjamming(p, (part - 1) * P)));
      for (const auto& row : unloading.rows) {
        EXPECT_EQ(row.state.P > 0, row.eps_vol < at);
        EXPECT_EQ(row.state.P == 0, std::isnan(row.s_dev));
      }
    }
  }
  expect_figure("O8.unjamming_strain", off, 1e-9);
}

TEST(Isotropic, O8StateJamsAgainWhereItUnjammed) {
  // There and back through unjamming: P = P(nu) - P(nu_J) on the way up, nu_J where P vanished on the way down.
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path =
      path_from(0.70, {leg_to(Mode::ISO, 0.63, true), leg_to(Mode::ISO, 0.62, true), leg_to(Mode::ISO, 0.72)});
  const auto points = predict::uniform_points(path, 200);
  double off_density = 0, off_pressure = 0;
  for (const Rung rung : {Rung::evolution, Rung::memory}) {
    for (const Method method : {Method::adams, Method::bdf}) {
      for (const double part : {0.3, 0.9, 1.0, 1.2}) {
        if (rung == Rung::memory && part != 1.0) continue;  // its B is that at its own jamming density
        LawState<double> start = predict::state_from_law(p, 0.70);
        start.P *= part;
        const Prediction loop =
            predict::predict(rung, p, Coupling::energy, path, start, points, {1e-10, 1e-14, method}, {}, {});
        ASSERT_EQ(loop.events.size(), 2U);
        EXPECT_EQ(loop.events[0].kind, predict::EventKind::unjammed);
        EXPECT_EQ(loop.events[1].kind, predict::EventKind::jammed);
        EXPECT_EQ(loop.events[1].at.segment, 2);
        const double nu_J = 0.70 * std::exp(-expected_unjamming(p, (part - 1) * start.P / part));
        off_density = std::max({off_density, std::abs(loop.events[0].nu - nu_J), std::abs(loop.events[1].nu - nu_J)});
        for (const auto& row : loop.rows) {
          if (row.segment < 2) continue;
          const double P = std::max(p.isotropic.P_star(row.nu) - p.isotropic.P_star(nu_J), 0.0);
          off_pressure = std::max(off_pressure, std::abs(row.state.P - P));
        }
        EXPECT_EQ(loop.warnings.size(), 1U);
        EXPECT_NE(loop.warnings.front().find("unjams"), std::string::npos);
      }
    }
  }
  expect_figure("O8.density_of_unjamming_and_jamming", off_density, 1e-9);
  expect_figure("O8.pressure_after_jamming_again", off_pressure, 1e-9);
}

TEST(Isotropic, UnjammedStatesAreZeroInTheirNextSegment) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.68, {leg(Mode::D2, 0.1), leg_to(Mode::ISO, 0.60, true), leg_to(Mode::ISO, 0.70)});
  for (const Rung model : {Rung::reduced, Rung::evolution}) {
    const Prediction prediction = predict::predict(model, p, Coupling::energy, path, predict::state_from_law(p, 0.68),
                                                   {{0, 0.0}, {2, 0.01}}, {}, {}, {});
    EXPECT_TRUE(prediction.unjammed);
    ASSERT_EQ(prediction.rows.size(), 2U);
    EXPECT_EQ(prediction.rows[1].state.P, 0);
    EXPECT_TRUE(prediction.rows[1].state.sigma.isZero(0) && prediction.rows[1].state.F.isZero(0));
    EXPECT_EQ(prediction.unjammed_at.segment, 1);
  }
}

TEST(Isotropic, O8ShearedUnloadingUnjamsWithEitherMethod) {
  // Stress that shear left outlives P: a principal stress vanishes first.
  for (const Coupling coupling : {Coupling::energy, Coupling::single}) {
    const LawParameters<double> p = testing::coupled_parameters();
    const auto path = path_from(0.75, {leg(Mode::D2, 0.1), leg(Mode::UNI, 0.2, true)});
    LawState<double> start = predict::state_from_law(p, 0.75);
    start.P *= 0.9;
    double at[2] = {};
    for (const Method method : {Method::adams, Method::bdf}) {
      const Prediction prediction =
          predict::predict(Rung::evolution, p, coupling, path, start, predict::uniform_points(path, 500),
                           {1e-10, 1e-14, method}, {}, {});
      EXPECT_TRUE(prediction.unjammed);
      EXPECT_EQ(prediction.unjammed_at.segment, 1);
      at[method == Method::bdf] = prediction.unjammed_at.e;
      EXPECT_EQ(prediction.events.front().kind, predict::EventKind::tension);
      EXPECT_EQ(prediction.warnings.size(), 1U);
    }
    expect_figure("O8.adams_against_bdf_" + to_string(coupling), std::abs(at[0] - at[1]), 1e-9);
  }
}

}  // namespace
}  // namespace grainlaw
