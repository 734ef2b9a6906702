#include "predict/predict.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/vocabulary/error.hpp"
#include "tests/support/law_parameters.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/not_finite.hpp"

namespace grainlaw::predict {
namespace {

using testing::leg;
using testing::leg_to;
using testing::path_from;

using testing::kInfinity;
using testing::kNaN;
constexpr Rung kModels[] = {Rung::reduced, Rung::evolution};

Prediction run(Rung model, const std::vector<StraightSegment>& path, const std::vector<OutputPoint>& points,
               const ValidRange& range = {}, const Tolerances& tolerances = {}) {
  const LawParameters<double> p = testing::coupled_parameters();
  return predict(model, p, Coupling::energy, path, state_from_law(p, path.front().nu_start), points, tolerances, range,
                 {});
}

bool equal(const LawState<double>& a, const LawState<double>& b) {
  return a.P == b.P && a.sigma == b.sigma && a.F == b.F;
}

TEST(Start, FromTheLaw) {
  const LawParameters<double> p = testing::coupled_parameters();
  const LawState<double> state = state_from_law(p, 0.70);
  EXPECT_EQ(state.P, p.isotropic.P_star(0.70));
  EXPECT_TRUE(state.sigma.isZero() && state.F.isZero());
  for (const double nu : {0.6649, 0.66, 0.0, -1.0, kNaN}) EXPECT_THROW(state_from_law(p, nu), InvalidInput) << nu;
}

TEST(Start, FromAMeasuredRow) {
  Observation row;
  const double unit = 5e10;  // k/(2<r>) [Pa]
  row.stress.tensor << 0.9, 0.01, -0.02, 0.01, 1.0, 0.03, -0.02, 0.03, 1.1;
  row.stress.tensor *= 0.016 * unit;
  row.P_star = 0.016;
  row.fabric.tensor << 1.5, 0.02, 0.01, 0.02, 1.6, -0.01, 0.01, -0.01, 1.7;
  const LawState<double> state = state_from_row(row);
  EXPECT_EQ(state.P, 0.016);
  EXPECT_LE((tensor_of(state.sigma) + state.P * Eigen::Matrix3d::Identity() - row.stress.tensor / unit).norm(), 1e-16);
  EXPECT_LE(
      (tensor_of(state.F) + row.fabric.tensor.trace() / 3 * Eigen::Matrix3d::Identity() - row.fabric.tensor).norm(),
      1e-14);

  Observation bad = row;
  bad.P_star = 0;
  EXPECT_THROW(state_from_row(bad), InvalidInput);
  bad = row;
  bad.stress.tensor.setZero();
  EXPECT_THROW(state_from_row(bad), InvalidInput);
  bad = row;
  bad.fabric.tensor(0, 1) = kNaN;
  EXPECT_THROW(state_from_row(bad), InvalidInput);
  bad.fabric.tensor.setConstant(kNaN);  // nobody measured it
  EXPECT_EQ(state_from_row(bad).P, state.P);
  EXPECT_THROW(state_from_row(Observation{}), InvalidInput);
}

TEST(Predict, O10StartIsReturnedExactly) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.70, {leg(Mode::UNI, 0.1)});
  LawState<double> start = state_from_law(p, 0.70);
  start.sigma << 1e-3, 2e-4, 0, 1e-5, 0;
  start.F << 0.01, 0, 0.02, 0, 0;
  for (const std::vector<OutputPoint>& points :
       {std::vector<OutputPoint>{{0, 0}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0.05}}}) {
    const auto rows = predict(Rung::evolution, p, Coupling::energy, path, start, points, {}, {}, {}).rows;
    ASSERT_EQ(rows.size(), points.size());
    EXPECT_TRUE(equal(rows[0].state, start));
    EXPECT_TRUE(rows[0].strain.tensor.isZero());
    EXPECT_EQ(rows[0].nu, 0.70);
  }
}

TEST(Predict, O10NoPointsGiveNoRows) {
  for (const Rung model : kModels) {
    const Prediction prediction = run(model, path_from(0.70, {leg(Mode::UNI, 0.1)}), {});
    EXPECT_TRUE(prediction.rows.empty());
    EXPECT_FALSE(prediction.unjammed);
  }
}

TEST(Predict, O10RepeatedPointsGiveEqualRows) {
  const auto path = path_from(0.70, {leg(Mode::UNI, 0.1), leg(Mode::D2, 0.1)});
  const double end = path[0].length;
  for (const Rung model : kModels) {
    const auto rows =
        run(model, path, {{0, 0.03}, {0, 0.03}, {0, 0.03}, {0, end}, {0, end}, {1, 0}, {1, 0}, {1, 0.05}}).rows;
    ASSERT_EQ(rows.size(), 8U);
    EXPECT_TRUE(equal(rows[0].state, rows[1].state) && equal(rows[1].state, rows[2].state));
    EXPECT_TRUE(equal(rows[3].state, rows[4].state));
    EXPECT_TRUE(equal(rows[5].state, rows[6].state));
    EXPECT_NEAR(rows[5].state.P, rows[4].state.P, 1e-15) << "the corner belongs to both segments";
    EXPECT_LE((rows[5].state.sigma - rows[4].state.sigma).norm(), 1e-15);
  }
}

TEST(Predict, O10PointsOffThePathAreRefused) {
  const auto path = path_from(0.70, {leg(Mode::UNI, 0.1), leg(Mode::D2, 0.1)});
  const std::vector<std::vector<OutputPoint>> bad = {
      {{0, kNaN}},           {{0, -1e-12}},         {{0, 0.2}}, {{0, kInfinity}}, {{2, 0}}, {{-1, 0}},
      {{1, 0.01}, {0, 0.1}}, {{0, 0.05}, {0, 0.04}}};
  for (const Rung model : kModels) {
    for (const auto& points : bad) EXPECT_THROW(run(model, path, points), InvalidInput);
  }
}

TEST(Predict, RefusesWhatCannotBeIntegrated) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.70, {leg(Mode::UNI, 0.1)});
  const LawState<double> good = state_from_law(p, 0.70);
  const auto attempt = [&](const std::vector<StraightSegment>& segments, const LawState<double>& start,
                           const Tolerances& t) {
    predict(Rung::evolution, p, Coupling::energy, segments, start, {{0, 0.0}}, t, {}, {});
  };
  EXPECT_NO_THROW(attempt(path, good, {}));
  EXPECT_THROW(attempt({}, good, {}), InvalidInput);
  auto broken = path;
  broken[0].length = kNaN;
  EXPECT_THROW(attempt(broken, good, {}), InvalidInput);
  broken = path;
  broken[0].direction.tensor(1, 1) = kInfinity;
  EXPECT_THROW(attempt(broken, good, {}), InvalidInput);
  for (const double P : {0.0, -1e-3, kNaN, kInfinity})
    EXPECT_THROW(attempt(path, {P, good.sigma, good.F}, {}), InvalidInput);
  LawState<double> odd = good;
  odd.F(3) = kNaN;
  EXPECT_THROW(attempt(path, odd, {}), InvalidInput);
  EXPECT_THROW(attempt(path_from(0.66, {leg(Mode::UNI, 0.1)}), good, {}), InvalidInput) << "below nu_c";
  for (const double relative : {0.0, -1e-8, 1.0, kNaN, 1e-15})
    EXPECT_THROW(attempt(path, good, {relative}), InvalidInput);
  for (const double absolute : {-1e-12, kNaN, kInfinity})
    EXPECT_THROW(attempt(path, good, {1e-8, absolute}), InvalidInput);
  EXPECT_THROW(attempt(path, good, {1e-8, 1e-12, Method::adams, 0}), InvalidInput);
}

TEST(Predict, ParametersThatAreNoNumbersGiveNoRows) {
  const auto path = path_from(0.70, {leg(Mode::UNI, 0.1)});
  LawParameters<double> p = testing::coupled_parameters();
  const LawState<double> start = state_from_law(p, 0.70);
  p.stress_rate.Q_c = kNaN;
  for (const Rung model : kModels) {
    EXPECT_THROW(predict(model, p, Coupling::energy, path, start, {{0, 0.05}}, {}, {}, {}), Error);
  }
}

TEST(Predict, FailureNamesSegmentStrainAndReason) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.70, {leg(Mode::ISO, 0.01), leg(Mode::UNI, 0.1)});
  try {
    predict(Rung::evolution, p, Coupling::energy, path, state_from_law(p, 0.70), {{1, 0.1}},
            {1e-8, 1e-12, Method::adams, 20}, {}, {});
    FAIL() << "20 steps cannot be enough";
  } catch (const NotConverged& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("segments[1]"), std::string::npos) << what;
    EXPECT_NE(what.find("e = "), std::string::npos) << what;
    EXPECT_NE(what.find("mxstep"), std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

TEST(Predict, StopsWhenAsked) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.70, {leg(Mode::UNI, 0.1)});
  std::stop_source source;
  source.request_stop();
  RunControl control;
  control.stop = source.get_token();
  for (const Rung model : kModels) {
    EXPECT_THROW(predict(model, p, Coupling::energy, path, state_from_law(p, 0.70), {{0, 0.05}}, {}, {}, control),
                 Interrupted);
  }
}

TEST(Predict, RowsCarryTheGeometryOfThePath) {
  const auto path = path_from(0.70, {leg(Mode::D2, 0.10), leg(Mode::D2, 0.04, true), leg_to(Mode::ISO, 0.72)});
  for (const Rung model : kModels) {
    const auto rows = run(model, path, uniform_points(path, 2)).rows;
    ASSERT_EQ(rows.size(), 9U);
    const double eps_dev[] = {0, .05, .10, .10, .08, .06, .06, .06, .06},
                 shear_path[] = {0, .05, .10, .10, .12, .14, .14, .14, .14};
    const int segment[] = {0, 0, 0, 1, 1, 1, 2, 2, 2};
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_EQ(rows[i].segment, segment[i]);
      EXPECT_NEAR(rows[i].eps_dev, eps_dev[i], 1e-15) << i;
      EXPECT_NEAR(rows[i].shear_path, shear_path[i], 1e-15) << i;
      EXPECT_NEAR(rows[i].nu, 0.70 * std::exp(-rows[i].eps_vol), 1e-15) << i;
      EXPECT_NEAR(rows[i].eps_vol, rows[i].strain.tensor.trace(), 1e-17);
      EXPECT_NEAR(rows[i].s_dev, std::abs(rows[i].s_par), 1e-14) << "co-axial";
      EXPECT_NEAR(rows[i].F_dev, std::abs(rows[i].F_par), 1e-14);
    }
    EXPECT_NEAR(rows.back().nu, 0.72, 1e-15);
    EXPECT_LT(rows[5].s_par, rows[2].s_par) << "reversal lowers the signed ratio";
  }
}

TEST(Predict, O11WorkDoesNotGrowWithTheNumberOfOutputs) {
  const auto path = path_from(0.695, {leg_to(Mode::UNI, 0.82)});
  const auto few = run(Rung::evolution, path, uniform_points(path, 100));
  const auto many = run(Rung::evolution, path, uniform_points(path, 100000));
  ASSERT_EQ(many.rows.size(), 100001U);
  EXPECT_LE(many.statistics.rhs_evaluations, 3 * few.statistics.rhs_evaluations);
  EXPECT_NEAR(many.rows.back().state.P, few.rows.back().state.P, 1e-8);
  EXPECT_EQ(few.statistics.restarts, 1);
  EXPECT_GT(few.statistics.steps, 0);
  EXPECT_GT(few.statistics.seconds, 0);
}

TEST(Predict, O11LargeStrainSaturates) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.74, {leg(Mode::D2, 10)});
  const auto row =
      predict(Rung::evolution, p, Coupling::single, path, state_from_law(p, 0.74), {{0, path[0].length}}, {}, {}, {})
          .rows.at(0);
  EXPECT_NEAR(row.s_par, p.stress_ratio_max.value(0.74, p.shear_nu_c), 1e-8);
  EXPECT_NEAR(row.F_par, p.fabric_max.value(0.74, p.shear_nu_c), 1e-8);
}

TEST(Predict, StateDoesNotDependOnWhereOutputsAre) {
  const auto path = path_from(0.695, {leg_to(Mode::UNI, 0.74), leg(Mode::D3, 0.1, true)});
  const OutputPoint end{1, path[1].length};
  const auto last = [&](std::vector<OutputPoint> points) {
    points.push_back(end);
    return run(Rung::evolution, path, points).rows.back().state;
  };
  const LawState<double> a = last({}), b = last(uniform_points(path, 37)),
                         c = last({{0, 1e-300}, {0, 1e-15}, {0, 1e-9}, {1, 1e-20}});
  for (const LawState<double>& other : {b, c}) {
    EXPECT_NEAR(other.P / a.P, 1, 1e-7);
    EXPECT_LE((other.sigma - a.sigma).norm(), 1e-7 * a.sigma.norm());
    EXPECT_LE((other.F - a.F).norm(), 1e-7 * a.F.norm());
  }
}

TEST(Predict, WarnsOncePerKindOutsideTheCalibratedRange) {
  const ValidRange range{0.70, 0.80, 0.15};
  const auto up = path_from(0.72, {leg(Mode::D2, 0.3), leg_to(Mode::ISO, 0.82), leg_to(Mode::ISO, 0.68, true)});
  for (const Rung model : kModels) {
    const auto warnings = run(model, up, uniform_points(up, 50), range).warnings;
    ASSERT_EQ(warnings.size(), 3U);
    EXPECT_EQ(warnings[0], "nu = 0.68 lies outside the calibrated range 0.7-0.8");
    EXPECT_EQ(warnings[1], "nu = 0.82 lies outside the calibrated range 0.7-0.8");
    EXPECT_EQ(warnings[2], "eps_dev = 0.3 lies beyond the calibrated strain 0.15");
  }
  // volume and the way sheared have limits of their own: there and back ends where it began
  const ValidRange narrow{0.60, 0.90, 0.30, 0.05, 0.30};
  const auto to_and_fro = path_from(0.72, {leg(Mode::D2, 0.2), leg(Mode::D2, 0.2, true), leg_to(Mode::ISO, 0.78)});
  const auto warnings = run(Rung::evolution, to_and_fro, uniform_points(to_and_fro, 50), narrow).warnings;
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0], "|eps_vol| = 0.08004 lies beyond the calibrated volumetric strain 0.05");
  EXPECT_EQ(warnings[1], "shear_path = 0.4 is longer than the calibrated 0.3");
  const auto inside = path_from(0.70, {leg_to(Mode::UNI, 0.80)});
  EXPECT_TRUE(run(Rung::evolution, inside, uniform_points(inside, 10), range).warnings.empty())
      << "the limits belong to it";
}

TEST(Reduced, PressureIsThatOfTheDensity) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.70, {leg(Mode::D2, 0.1), leg_to(Mode::UNI, 0.78)});
  LawState<double> start = state_from_law(p, 0.70);
  start.P *= 1.3;
  start.sigma = shear_direction(path) * (0.02 * start.P);
  const auto rows = predict(Rung::reduced, p, Coupling::energy, path, start, uniform_points(path, 10), {}, {}, {}).rows;
  for (const auto& row : rows) EXPECT_EQ(row.state.P, p.isotropic.P_star(row.nu));
  EXPECT_NEAR(rows[0].s_par, 0.02, 1e-16) << "the measured ratio, not the measured stress, is the start";
}

TEST(Reduced, IsotropicSegmentsKeepTheRatios) {
  const auto path = path_from(0.70, {leg(Mode::D2, 0.05), leg_to(Mode::ISO, 0.75), leg_to(Mode::ISO, 0.72, true)});
  const auto rows = run(Rung::reduced, path, uniform_points(path, 5)).rows;
  for (std::size_t i = 6; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i].s_par, rows[5].s_par, 1e-15);
    EXPECT_NEAR(rows[i].F_par, rows[5].F_par, 1e-15);
  }
}

TEST(Reduced, OffAxisPartsDecay) {
  // Shear along another axis: what was built up along the first decays with exp(-beta_s e), exp(-beta_F e).
  const LawParameters<double> p = testing::coupled_parameters();
  auto second = leg(Mode::D2, 0.05);
  second.direction = StrainRate{};
  second.direction.tensor(0, 1) = second.direction.tensor(1, 0) = -0.5;  // orthogonal to any diagonal direction
  const auto path = path_from(0.70, {leg(Mode::D2, 0.05), second});
  const auto rows = run(Rung::reduced, path, uniform_points(path, 4)).rows;
  const double beta_s = p.stress_rate.value(0.70, p.shear_nu_c), beta_F = p.fabric_rate.value(0.70, p.shear_nu_c);
  for (std::size_t i = 5; i < rows.size(); ++i) {
    const double e = rows[i].shear_path - 0.05;
    EXPECT_NEAR(rows[i].s_par, rows[4].s_par * std::exp(-beta_s * e), 1e-15);
    EXPECT_NEAR(rows[i].F_par, rows[4].F_par * std::exp(-beta_F * e), 1e-15);
  }
  EXPECT_GT(rows.back().s_dev, 2 * rows.back().s_par) << "the new direction has taken over";
}

TEST(Reduced, UnjamsAndJamsAgainAtTheJammingDensity) {
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = path_from(0.70, {leg_to(Mode::UNI, 0.60, true), leg_to(Mode::UNI, 0.70)});
  const Prediction prediction = run(Rung::reduced, path, uniform_points(path, 100));
  EXPECT_TRUE(prediction.unjammed);
  EXPECT_NEAR(prediction.unjammed_at.e, std::log(0.70 / p.isotropic.pressure.nu_c), 1e-15);
  ASSERT_EQ(prediction.rows.size(), 202U);
  ASSERT_EQ(prediction.events.size(), 2U);
  EXPECT_EQ(prediction.events[1].kind, EventKind::jammed);
  EXPECT_EQ(prediction.events[1].at.segment, 1);
  EXPECT_NEAR(prediction.events[1].at.e, std::log(p.isotropic.pressure.nu_c / 0.60), 1e-15);
  for (const PredictedRow& row : prediction.rows) {
    EXPECT_EQ(row.state.P, p.isotropic.P_star(row.nu));
    EXPECT_EQ(row.state.P == 0, std::isnan(row.s_dev));
    EXPECT_EQ(row.state.P == 0, row.F_dev == 0 && row.state.sigma.isZero(0) && row.nu <= p.isotropic.pressure.nu_c);
  }
  // shear counts from where it jams
  const PredictedRow& end = prediction.rows.back();
  const double e = std::log(0.70 / p.isotropic.pressure.nu_c);
  EXPECT_NEAR(end.s_dev,
              p.stress_ratio_max.value(0.70, p.shear_nu_c) * -std::expm1(-p.stress_rate.value(0.70, p.shear_nu_c) * e),
              1e-14);
}

TEST(Predict, NamesOfModels) {
  EXPECT_EQ(to_string(Rung::reduced), "reduced");
  EXPECT_EQ(to_string(Rung::evolution), "evolution");
}

TEST(Reduced, ALegInPartsIsOneLeg) {
  const LawParameters<double> p = published_parameters();
  const auto end_of = [&](const std::vector<PathSegment>& segments) {
    const auto path = testing::path_from(0.70, segments);
    return predict(Rung::reduced, p, Coupling::energy, path, state_from_law(p, 0.70), uniform_points(path, 2), {}, {},
                   {})
        .rows.back();
  };
  const PredictedRow whole = end_of({testing::leg_to(Mode::UNI, 0.80)});
  std::vector<PathSegment> parts;
  for (int i = 1; i <= 10; ++i) parts.push_back(testing::leg_to(Mode::UNI, 0.70 + 0.01 * i));
  parts[4].direction.tensor *= 7;  // at another rate
  const PredictedRow in_parts = end_of(parts);
  EXPECT_NEAR(in_parts.F_par, whole.F_par, 1e-12);
  EXPECT_NEAR(in_parts.s_par, whole.s_par, 1e-12);
  parts[5] = leg(Mode::D2, 0.01);
  EXPECT_GT(std::abs(end_of(parts).F_par - whole.F_par), 1e-3) << "a turn is a corner";
}

}  // namespace
}  // namespace grainlaw::predict
