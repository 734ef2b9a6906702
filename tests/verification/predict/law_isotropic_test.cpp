// Isotropic paths. Without shear Eq. (16) is dP = B dx, and B is the derivative of Eq. (14), so that P - P(nu) of Eq. (14)
// is constant: loops close (hard case O3), and a path that unloads unjams where P vanishes (O8), which for a start with
// P_0 = P(nu_0) - d is where P(nu) = d, and nu = nu_c for d <= 0.

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "predict/predict.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_path.hpp"

namespace grainlaw {
namespace {

using predict::Method;
using predict::Model;
using predict::Prediction;
using testing::figure;
using testing::leg;
using testing::leg_to;
using testing::path_from;

LawParameters<double> parameters() {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a2 = 1.18;
  return p;
}

/// Largest deviation of P from Eq. (14) over the loop 0.67 -> 0.82 -> 0.67, over the largest P and over the P there.
struct LoopError {
  double of_largest = 0, of_local = 0;
};

LoopError isotropic_loop(Coupling coupling, const predict::Tolerances& tolerances) {
  const LawParameters<double> p = parameters();
  const auto path = path_from(0.67, {leg_to(Mode::ISO, 0.82), leg_to(Mode::ISO, 0.67, true)});
  const auto points = predict::uniform_points(path, 100);
  const Prediction loop = predict::predict(Model::evolution, p, coupling, path, predict::state_from_law(p, 0.67),
                                           points, tolerances, {}, {});
  EXPECT_EQ(loop.rows.size(), points.size());
  EXPECT_NEAR(loop.rows.back().nu, 0.67, 1e-15);
  LoopError error;
  for (const auto& row : loop.rows) {
    const double P = p.isotropic.P_star(row.nu);
    error.of_largest = std::max(error.of_largest, std::abs(row.state.P - P) / p.isotropic.P_star(0.82));
    error.of_local = std::max(error.of_local, std::abs(row.state.P / P - 1));
    EXPECT_TRUE(row.state.sigma.isZero() && row.state.F.isZero());
    EXPECT_TRUE(std::isnan(row.s_par) && std::isnan(row.F_par)) << "undefined on a path without shear";
  }
  return error;
}

TEST(Isotropic, O3LoopFollowsEquation14AndCloses) {
  // P(0.82) is 54 times P(0.67), and a relative error that is made up there is carried down as an absolute one: over the
  // local P the loop needs a tolerance that is as many times smaller.
  for (const Coupling coupling : {Coupling::energy, Coupling::single}) {
    figure("O3.error_over_largest_P_" + to_string(coupling), isotropic_loop(coupling, {1e-10, 1e-14}).of_largest, 1e-8);
    figure("O3.error_over_local_P_at_rtol_1e-12_" + to_string(coupling),
           isotropic_loop(coupling, {1e-12, 1e-16}).of_local, 1e-8);
  }
}

TEST(Isotropic, FabricAndStressKeepTheirDirectionUnderCompression) {
  // dsigma' = a2 B F' dx with F' constant: sigma' - sigma'_0 = a2 F' (P - P_0), exactly.
  const LawParameters<double> p = parameters();
  const auto path = path_from(0.70, {leg_to(Mode::ISO, 0.80)});
  LawState<double> start = predict::state_from_law(p, 0.70);
  start.F << 0.09, -0.03, 0.02, 0.01, -0.04;
  start.sigma << 0.001, 0.0005, -0.0002, 0, 0.0001;
  const auto rows = predict::predict(Model::evolution, p, Coupling::energy, path, start,
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
  const LawParameters<double> p = parameters();
  const auto path = path_from(0.70, {leg(Mode::ISO, 0.10, true)});
  const auto points = predict::uniform_points(path, 1000);
  double off = 0;
  for (const Method method : {Method::adams, Method::bdf}) {
    for (const double part : {0.1, 0.5, 0.9, 0.999, 1.0, 1.001, 1.5}) {
      LawState<double> start = predict::state_from_law(p, 0.70);
      const double P = start.P;
      start.P *= part;
      const Prediction unloading =
          predict::predict(Model::evolution, p, Coupling::energy, path, start, points, {1e-10, 1e-14, method}, {}, {});
      EXPECT_TRUE(unloading.unjammed);
      EXPECT_LT(unloading.rows.size(), points.size());
      const double at = 3 * unloading.unjammed_at.e;  // tr D = 3
      off = std::max(off, std::abs(at - expected_unjamming(p, (part - 1) * P)));
      for (const auto& row : unloading.rows) {
        EXPECT_GT(row.state.P, 0);
        EXPECT_LT(row.eps_vol, at);
      }
    }
  }
  figure("O8.unjamming_strain", off, 1e-9);
}

TEST(Isotropic, UnjammedPathsEndBeforeTheirNextSegment) {
  const LawParameters<double> p = parameters();
  const auto path = path_from(0.68, {leg(Mode::D2, 0.1), leg_to(Mode::ISO, 0.60, true), leg_to(Mode::ISO, 0.70)});
  for (const Model model : {Model::reduced, Model::evolution}) {
    const Prediction prediction = predict::predict(model, p, Coupling::energy, path, predict::state_from_law(p, 0.68),
                                                   {{0, 0.0}, {2, 0.01}}, {}, {}, {});
    EXPECT_TRUE(prediction.unjammed);
    EXPECT_EQ(prediction.rows.size(), 1U);
    EXPECT_EQ(prediction.unjammed_at.segment, 1);
  }
}

TEST(Isotropic, ShearedUnloadingUnjamsWithEitherMethod) {
  // With sigma' finite at P = 0 the pressure falls as a square root, with a vertical tangent.
  for (const Coupling coupling : {Coupling::energy, Coupling::single}) {
    const LawParameters<double> p = parameters();
    const auto path = path_from(0.75, {leg(Mode::D2, 0.1), leg(Mode::UNI, 0.2, true)});
    LawState<double> start = predict::state_from_law(p, 0.75);
    start.P *= 0.9;
    double at[2] = {};
    for (const Method method : {Method::adams, Method::bdf}) {
      const Prediction prediction =
          predict::predict(Model::evolution, p, coupling, path, start, predict::uniform_points(path, 500),
                           {1e-10, 1e-14, method}, {}, {});
      EXPECT_TRUE(prediction.unjammed);
      EXPECT_EQ(prediction.unjammed_at.segment, 1);
      at[method == Method::bdf] = prediction.unjammed_at.e;
      EXPECT_EQ(prediction.warnings.size(), 1U) << "a principal stress turns tensile on the way";
    }
    figure("O8.adams_against_bdf_" + to_string(coupling), std::abs(at[0] - at[1]), 1e-9);
  }
}

}  // namespace
}  // namespace grainlaw
