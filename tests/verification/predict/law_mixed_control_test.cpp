// Stresses, P or the stress ratio given in place of strains: what is given is kept, and the strain that comes out, given
// back as a strain-controlled path, leads to the same stress by another way of integration.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/vocabulary/error.hpp"
#include "predict/mixed_control.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_parameters.hpp"
#include "tests/support/law_path.hpp"

namespace grainlaw {
namespace {

using predict::predict_by_law;
using predict::Prediction;
using testing::expect_figure;
using Quantity = Condition::Quantity;

PathSegment segment(Mode mode, ExtentKind kind, double extent, std::vector<Condition> conditions = {},
                    bool reverse = false) {
  PathSegment s{mode, direction_of(mode, "xyz", reverse), kind, extent};
  s.conditions = std::move(conditions);
  return s;
}

Prediction run(const Path& path, int rows = 50, const predict::Tolerances& tolerances = {1e-9, 1e-13}) {
  const LawParameters<double> p = testing::coupled_parameters();
  return predict_by_law(Rung::evolution, p, Coupling::energy, path, predict::state_from_law(p, path.nu), rows,
                        tolerances, {}, {});
}

Eigen::Matrix3d stress(const predict::PredictedRow& row) {
  return tensor_of(row.state.sigma) + row.state.P * Eigen::Matrix3d::Identity();
}

TEST(MixedControl, TriaxialCompressionKeepsTheLateralStress) {
  const Path path{0.70,
                  Branch::unloading,
                  {segment(Mode::UNI, ExtentKind::eps_dev, 0.1, {{0, Quantity::stress, 0}, {1, Quantity::stress, 0}})}};
  const Prediction triaxial = run(path);
  ASSERT_EQ(triaxial.rows.size(), 51U);
  double drift = 0;
  for (const auto& row : triaxial.rows) {
    for (const int i : {0, 1})
      drift = std::max(drift, std::abs(stress(row)(i, i) / stress(triaxial.rows[0])(i, i) - 1));
  }
  expect_figure("mixed.triaxial.stress_drift", drift, 1e-8);
  EXPECT_NEAR(triaxial.rows.back().shear_path, 0.1, 1e-9);
  EXPECT_GT(stress(triaxial.rows.back())(2, 2), 1.1 * stress(triaxial.rows[0])(2, 2)) << "the axial stress grows";
}

TEST(MixedControl, ConstantPressureShearStopsAtItsStressRatio) {
  const Path path{
      0.70,
      Branch::unloading,
      {segment(Mode::D2, ExtentKind::target_stress_ratio, 0.12, {{Condition::volume, Quantity::P_star, 0}})}};
  const Prediction shear = run(path);
  double drift = 0;
  for (const auto& row : shear.rows) drift = std::max(drift, std::abs(row.state.P / shear.rows[0].state.P - 1));
  expect_figure("mixed.constant_P.drift", drift, 1e-8);
  expect_figure("mixed.target_stress_ratio.off", std::abs(shear.rows.back().s_dev - 0.12), 1e-9);
  // along D2 at constant P, s = s_max (1 - exp(-beta_s eps_dev)) but for the volume that keeps P
  EXPECT_NE(shear.rows.back().nu, 0.70);
  EXPECT_NEAR(shear.rows.back().nu, 0.70, 0.005);
}

TEST(MixedControl, ConstantStressRatioCompressionStopsAtItsPressure) {
  const Path path{
      0.70,
      Branch::unloading,
      {segment(Mode::D2, ExtentKind::eps_dev, 0.02),
       segment(Mode::UNI, ExtentKind::target_P_star, 0.05, {{Condition::volume, Quantity::stress_ratio, 0}})}};
  const Prediction radial = run(path);
  double drift = 0;
  for (const auto& row : radial.rows) {
    if (row.segment == 1) drift = std::max(drift, std::abs(row.s_dev - radial.rows[50].s_dev));
  }
  expect_figure("mixed.stress_ratio.drift", drift, 1e-8);
  expect_figure("mixed.target_P_star.off", std::abs(radial.rows.back().state.P - 0.05), 1e-9);
}

TEST(MixedControl, RampsFollowTheirRate) {
  const Path path{0.70,
                  Branch::unloading,
                  {segment(Mode::D2, ExtentKind::eps_dev, 0.05, {{Condition::volume, Quantity::P_star, 0.02}})}};
  const Prediction ramp = run(path);
  const double P_0 = ramp.rows[0].state.P, length = (ramp.rows.back().state.P - P_0) / 0.02;
  double off = 0;
  for (std::size_t i = 0; i < ramp.rows.size(); ++i)
    off = std::max(off, std::abs(ramp.rows[i].state.P - P_0 - 0.02 * length * static_cast<double>(i) / 50) / P_0);
  expect_figure("mixed.ramp.drift", off, 1e-8);
}

// What is given per unit of the path parameter may be given per a thousandth or a million of it.
TEST(MixedControl, TheUnitOfRatesDoesNotMatter) {
  const auto at = [](double unit) {
    PathSegment s =
        segment(Mode::UNI, ExtentKind::eps_dev, 0.05, {{0, Quantity::stress, 0.02 * unit}, {1, Quantity::stress, 0}});
    s.mode = Mode::tensor;
    s.direction.tensor = unit * direction_of(Mode::UNI).tensor;
    return run({0.70, Branch::unloading, {s}}).rows;
  };
  const auto rows = at(1);
  double off = 0;
  for (const double unit : {1e-12, 1e-4, 1e3, 1e6}) {
    const auto others = at(unit);
    ASSERT_EQ(others.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      off = std::max({off, std::abs(others[i].state.P / rows[i].state.P - 1),
                      (others[i].strain.tensor - rows[i].strain.tensor).norm()});
  }
  expect_figure("mixed.unit_of_rates", off, 1e-9);
}

TEST(MixedControl, StrainsGivenBackLeadToTheSameStress) {
  // The predicted strain of triaxial compression, row by row, as a strain-controlled path of straight pieces.
  const LawParameters<double> p = testing::coupled_parameters();
  const Path path{
      0.70,
      Branch::unloading,
      {segment(Mode::UNI, ExtentKind::eps_dev, 0.05, {{0, Quantity::stress, 0}, {1, Quantity::stress, 0}})}};
  const Prediction mixed = run(path, 800);
  std::vector<PathSegment> pieces;
  for (std::size_t i = 1; i < mixed.rows.size(); ++i) {
    PathSegment piece{Mode::tensor, {}, ExtentKind::eps_dev, 0};
    const Eigen::Matrix3d step = mixed.rows[i].strain.tensor - mixed.rows[i - 1].strain.tensor;
    piece.direction.tensor = step / step.norm();
    piece.extent = deviatoric_norm(step);
    pieces.push_back(piece);
  }
  const auto segments = testing::path_from(0.70, pieces);
  std::vector<predict::OutputPoint> ends;
  for (std::size_t k = 0; k < segments.size(); ++k) ends.push_back({static_cast<int>(k), segments[k].length});
  const auto back = predict::predict(Rung::evolution, p, Coupling::energy, segments, predict::state_from_law(p, 0.70),
                                     ends, {1e-10, 1e-14}, {}, {});
  double off = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto &a = mixed.rows[i + 1].state, &b = back.rows[i].state;
    off = std::max({off, std::abs(a.P - b.P) / b.P, (a.sigma - b.sigma).norm() / b.P, (a.F - b.F).norm()});
  }
  expect_figure("mixed.strain_given_back", off, 1e-7);
}

// Where the free strains alone shear, they alone turn the shear back: memory begins anew there as along the same strains given.
TEST(MixedControl, ACornerOfFreeStrainsIsAReversal) {
  const LawParameters<double> p = testing::memory_parameters();
  const auto end_of = [&](const std::vector<PathSegment>& segments) {
    return predict_by_law(Rung::memory, p, Coupling::energy, {0.72, Branch::unloading, segments},
                          predict::state_from_law(p, 0.72), 50, {1e-10, 1e-14}, {}, {})
        .rows.back()
        .state;
  };
  std::vector<PathSegment> by_stress, by_strain;
  for (const double sense : {1.0, -1.0}) {
    by_stress.push_back({Mode::tensor, {}, ExtentKind::eps_dev, 0.03});
    by_stress.back().conditions = {{5, Quantity::stress, 0.1 * sense}};
    by_strain.push_back({Mode::tensor, {}, ExtentKind::eps_dev, 0.03});
    by_strain.back().direction.tensor(0, 1) = by_strain.back().direction.tensor(1, 0) = -sense;
  }
  const LawState<double> found = end_of(by_stress), expected = end_of(by_strain);
  EXPECT_NEAR(found.P / expected.P, 1, 1e-6);
  EXPECT_NEAR((found.sigma - expected.sigma).norm() / expected.P, 0, 1e-5);
  EXPECT_NEAR((found.F - expected.F).norm(), 0, 1e-5);
}

// Between corners it has no event for that: then it says so.
TEST(MixedControl, LoadingThatEndsWithinASegmentIsSaid) {
  const LawParameters<double> p = testing::memory_parameters();
  const auto warnings_of = [&](Rung rung, const PathSegment& last) {
    const Path path{
        0.72,
        Branch::unloading,
        {segment(Mode::D2, ExtentKind::eps_dev, 0.05), segment(Mode::D2, ExtentKind::eps_dev, 0.008, {}, true), last}};
    return predict_by_law(rung, p, Coupling::energy, path, predict::state_from_law(p, 0.72), 50, {1e-9, 1e-13}, {}, {})
        .warnings;
  };
  // compression takes the stress ratio down faster than a little shear brings it up
  PathSegment compress{Mode::tensor, {}, ExtentKind::target_nu, 0.76};
  compress.direction.tensor = direction_of(Mode::ISO).tensor + 0.002 * direction_of(Mode::D2).tensor;
  ASSERT_EQ(warnings_of(Rung::memory, compress).size(), 1u);
  EXPECT_NE(warnings_of(Rung::memory, compress)[0].find("loading ends within segments[2]"), std::string::npos)
      << warnings_of(Rung::memory, compress)[0];
  EXPECT_TRUE(warnings_of(Rung::evolution, compress).empty());
  EXPECT_TRUE(warnings_of(Rung::memory, segment(Mode::D2, ExtentKind::eps_dev, 0.05)).empty());
}

TEST(MixedControl, WithoutConditionsItIsThePrediction) {
  const LawParameters<double> p = testing::coupled_parameters();
  const Path path{0.70,
                  Branch::unloading,
                  {segment(Mode::D2, ExtentKind::eps_dev, 0.05), segment(Mode::UNI, ExtentKind::target_nu, 0.75),
                   segment(Mode::D2, ExtentKind::target_eps_dev, 0.15, {}, true)}};
  const auto segments = resolve(path);
  const auto expected =
      predict::predict(Rung::evolution, p, Coupling::energy, segments, predict::state_from_law(p, 0.70),
                       predict::uniform_points(segments, 50), {1e-10, 1e-14}, {}, {});
  const Prediction found = run(path, 50, {1e-10, 1e-14});
  ASSERT_EQ(found.rows.size(), expected.rows.size());
  double off = 0;
  for (std::size_t i = 0; i < found.rows.size(); ++i) {
    const auto &a = found.rows[i], &b = expected.rows[i];
    off = std::max({off, std::abs(a.state.P / b.state.P - 1), (a.state.sigma - b.state.sigma).norm() / b.state.P,
                    (a.state.F - b.state.F).norm(), std::abs(a.nu - b.nu), std::abs(a.shear_path - b.shear_path)});
  }
  expect_figure("mixed.without_conditions", off, 1e-7);
}

TEST(MixedControl, WhatCannotBeKeptOrReachedIsSaid) {
  const auto message = [](const Path& path) {
    try {
      run(path);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  // the stress ratio stops at s_max, some .17 here
  EXPECT_NE(
      message({0.70,
               Branch::unloading,
               {segment(Mode::D2, ExtentKind::target_stress_ratio, 0.5, {{Condition::volume, Quantity::P_star, 0}})}})
          .find("segments[0]"),
      std::string::npos);
  EXPECT_NE(message({0.70, Branch::unloading, {segment(Mode::D2, ExtentKind::target_stress_ratio, 0.5)}})
                .find("target_stress_ratio = 0.5 is not reached"),
            std::string::npos);
  const std::string dense = message({0.72, Branch::unloading, {segment(Mode::ISO, ExtentKind::target_P_star, 0.5)}});
  EXPECT_NE(dense.find("segments[0] at nu = "), std::string::npos) << dense;
  EXPECT_NE(dense.find("is denser than nu = 0.9"), std::string::npos) << dense;
  const LawParameters<double> p = testing::coupled_parameters();
  EXPECT_THROW(predict_by_law(Rung::reduced, p, Coupling::energy,
                              {0.70, Branch::unloading, {segment(Mode::ISO, ExtentKind::target_P_star, 0.05)}},
                              predict::state_from_law(p, 0.70), 10, {}, {}, {}),
               InvalidInput);
}

TEST(MixedControl, RowsEndWhereTheStateUnjams) {
  const Path path{0.70, Branch::unloading, {segment(Mode::ISO, ExtentKind::target_P_star, 1e-30, {}, true)}};
  const Prediction unloading = run(path);
  EXPECT_TRUE(unloading.unjammed);
  ASSERT_EQ(unloading.events.size(), 1U);
  EXPECT_EQ(unloading.rows.size(), 50U);
  EXPECT_NEAR(unloading.events[0].nu, testing::coupled_parameters().isotropic.pressure.nu_c, 1e-6);
}

}  // namespace
}  // namespace grainlaw
