// The integrated law against closed forms at constant volume with A = 0 (a0 = 0, Coupling::single), where P stays and
//   ds/de = beta_s (sign s_max - s),  dF/de = beta_F (sign F_max - F)      on every straight piece of the path:
// Eqs. (17) and (18) on the first, the same with s_0, F_0 of the corner after each reversal. Hard cases O1, O6, O7.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "predict/predict.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/table.hpp"
#include "tests/support/tolerance_study.hpp"

namespace grainlaw {
namespace {

using predict::Method;
using predict::OutputPoint;
using predict::Prediction;
using testing::expect_figure;

constexpr double kDensities[] = {0.67, 0.68, 0.695, 0.70, 0.728, 0.74, 0.78, 0.80, 0.82};

LawParameters<double> uncoupled() {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a0 = 0;
  return p;
}

predict::Tolerances tolerances(double relative, Method method) {
  // The ratio of the defaults: P is 1e-3 to 1e-1, so that the absolute part stays far below the relative one.
  const predict::Tolerances standard;
  return {relative, relative * standard.absolute / standard.relative, method, standard.max_steps};
}

Prediction integrate(const std::vector<StraightSegment>& path, const LawState<double>& start,
                     const std::vector<OutputPoint>& points, const predict::Tolerances& t) {
  return predict::predict(Rung::evolution, uncoupled(), Coupling::single, path, start, points, t, {}, {});
}

/// Signed s or F along a zigzag of D2: the closed form of each piece, started from the end of the one before.
class Zigzag {
 public:
  Zigzag(const std::vector<StraightSegment>& path, double limit, double rate, double start)
      : path_(path), limit_(limit), rate_(rate) {
    double value = start;
    for (std::size_t k = 0; k < path.size(); ++k) {
      corners_.push_back(value);
      value = at(static_cast<int>(k), path[k].length);
    }
  }

  double at(int segment, double e) const {
    const auto k = static_cast<std::size_t>(segment);
    const double sign = path_[k].direction.tensor(2, 2) < 0 ? 1 : -1;
    return sign * limit_ - (sign * limit_ - corners_[k]) * std::exp(-rate_ * std::sqrt(3.0) * e);
  }

 private:
  const std::vector<StraightSegment>& path_;
  double limit_, rate_;
  std::vector<double> corners_;
};

struct Outcome {
  double error = std::numeric_limits<double>::infinity();
  long rhs_evaluations = 0;
};

/// Largest deviation of s from its closed form over s_max, of F over F_max and of P over P_0; starts from s_0, F_0 (in
/// these units).
Outcome run_against_closed_form(const std::vector<StraightSegment>& path, int outputs, const predict::Tolerances& t,
                                double s_0 = 0, double F_0 = 0) {
  const LawParameters<double> p = uncoupled();
  const double nu = path.front().nu_start;
  const double s_max = p.stress_ratio_max.value(nu, p.shear_nu_c), F_max = p.fabric_max.value(nu, p.shear_nu_c);
  const Zigzag s(path, s_max, p.stress_rate.value(nu, p.shear_nu_c), s_0 * s_max);
  const Zigzag F(path, F_max, p.fabric_rate.value(nu, p.shear_nu_c), F_0 * F_max);
  const Deviator<double> N = shear_direction(path);
  LawState<double> start = predict::state_from_law(p, nu);
  start.sigma = N * (s_0 * s_max * start.P);
  start.F = N * (F_0 * F_max);

  const auto points = predict::uniform_points(path, outputs);
  const Prediction prediction = integrate(path, start, points, t);
  if (prediction.rows.size() != points.size() || prediction.unjammed) return {};
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& row = prediction.rows[i];
    largest = std::max({largest, std::abs(row.s_par - s.at(points[i].segment, points[i].e)) / s_max,
                        std::abs(row.F_par - F.at(points[i].segment, points[i].e)) / F_max,
                        std::abs(row.state.P / start.P - 1)});
  }
  return {largest, prediction.statistics.rhs_evaluations};
}

double largest_error(const std::vector<StraightSegment>& path, int outputs, const predict::Tolerances& t,
                     double s_0 = 0, double F_0 = 0) {
  return run_against_closed_form(path, outputs, t, s_0, F_0).error;
}

TEST(ClosedForm, O1ErrorFollowsTheTolerance) {
  std::vector<std::vector<std::string>> table;
  for (const Method method : {Method::adams, Method::bdf}) {
    const std::string name = method == Method::adams ? "adams" : "bdf";
    testing::ToleranceStudy worst;
    double slope_off = 0;
    for (const double nu : kDensities) {
      testing::ToleranceStudy study;
      for (int k = 3; k <= 12; ++k) {
        const double relative = std::pow(10.0, -k);
        const Outcome run = run_against_closed_form(testing::reversals(nu, 0, 1.0), 200, tolerances(relative, method));
        study.add(relative, run.error, run.rhs_evaluations);
        worst.add(relative, run.error, run.rhs_evaluations);
      }
      slope_off = std::max(slope_off, std::abs(study.slope() - 1));
    }
    expect_figure("O1." + name + "_error_over_rtol", worst.largest_over_tolerance(), method == Method::adams ? 10 : 50);
    expect_figure("O1." + name + "_slope_off_one", slope_off, 0.2);
    for (auto& row : worst.rows(name)) table.push_back(std::move(row));
  }
  testing::print_table("O1.cvode", testing::ToleranceStudy::header(), table);
}

TEST(ClosedForm, O6Reversals) {
  for (const int corners : {1, 10, 1000}) {
    double adams = 0, bdf = 0;
    for (const double nu : {0.68, 0.74, 0.82}) {
      const auto path = testing::reversals(nu, corners, 1.0);
      for (int k = 3; k <= 12; k += corners == 1000 ? 3 : 1) {
        const double relative = std::pow(10.0, -k);
        adams = std::max(adams, largest_error(path, 5, tolerances(relative, Method::adams)) / relative);
        bdf = std::max(bdf, largest_error(path, 5, tolerances(relative, Method::bdf)) / relative);
      }
    }
    expect_figure("O6.adams_error_over_rtol_" + std::to_string(corners) + "_corners", adams, 10);
    expect_figure("O6.bdf_error_over_rtol_" + std::to_string(corners) + "_corners", bdf, 50);
  }
}

TEST(ClosedForm, O6EachCornerIsARestart) {
  const auto path = testing::reversals(0.70, 10, 0.5);
  const auto start = predict::state_from_law(uncoupled(), 0.70);
  const Prediction prediction = integrate(path, start, predict::uniform_points(path, 3), {});
  EXPECT_EQ(prediction.statistics.restarts, 11);
}

/// A D2 path that begins with a reversed piece of the given length; its effect on what follows is below rounding.
double error_after_tiny_piece(double length) {
  std::vector<StraightSegment> path = testing::reversals(0.70, 1, 0.4);
  path[0].length = length;
  path[0].direction.tensor = -path[1].direction.tensor;
  path[1].strain_start = path[0].strain(length);
  return largest_error(path, 50, tolerances(1e-8, Method::adams)) / 1e-8;
}

TEST(ClosedForm, O6CornerOneUlpAfterTheStart) {
  constexpr double ulp = std::numeric_limits<double>::epsilon();
  expect_figure("O6.error_over_rtol_corner_at_1_ulp", error_after_tiny_piece(ulp), 10);
  expect_figure("O6.error_over_rtol_corner_at_denormal",
                error_after_tiny_piece(std::numeric_limits<double>::denorm_min()), 10);
  expect_figure("O6.error_over_rtol_corner_at_1e-12", error_after_tiny_piece(1e-12), 10);
}

TEST(ClosedForm, O6CoincidentCorners) {
  std::vector<StraightSegment> path = testing::reversals(0.70, 3, 0.4);
  path[1].length = path[2].length = 0;  // the second and third corner fall on the first
  path[2].strain_start = path[3].strain_start = path[1].strain_start;
  expect_figure("O6.error_over_rtol_coincident_corners",
                largest_error(path, 50, tolerances(1e-8, Method::adams)) / 1e-8, 10);
}

TEST(ClosedForm, O7StressRatioAboveItsLimitFallsMonotonically) {
  const auto path = testing::reversals(0.70, 0, 0.5);
  expect_figure("O7.error_over_rtol", largest_error(path, 200, tolerances(1e-8, Method::adams), 1.2, 1.2) / 1e-8, 10);

  const LawParameters<double> p = uncoupled();
  const double s_max = p.stress_ratio_max.value(0.70, p.shear_nu_c);
  LawState<double> start = predict::state_from_law(p, 0.70);
  start.sigma = shear_direction(path) * (1.2 * s_max * start.P);
  const auto rows = integrate(path, start, predict::uniform_points(path, 200), tolerances(1e-8, Method::adams)).rows;
  for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_LE(rows[i].s_par, rows[i - 1].s_par + 1e-8) << i;
  EXPECT_NEAR(rows.back().s_par, s_max, 1e-7);
}

TEST(ClosedForm, ReducedModelIsTheClosedFormOfEachPiece) {
  // Written for the tensors in the product, for signed scalars here.
  const LawParameters<double> p = uncoupled();
  const auto path = testing::reversals(0.70, 4, 0.3);
  const double s_max = p.stress_ratio_max.value(0.70, p.shear_nu_c);
  const Zigzag s(path, s_max, p.stress_rate.value(0.70, p.shear_nu_c), 0);
  const auto points = predict::uniform_points(path, 7);
  const auto rows =
      predict::predict(Rung::reduced, p, Coupling::single, path, predict::state_from_law(p, 0.70), points, {}, {}, {})
          .rows;
  ASSERT_EQ(rows.size(), points.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i].s_par, s.at(points[i].segment, points[i].e), 1e-15) << i;
  }
}

}  // namespace
}  // namespace grainlaw
