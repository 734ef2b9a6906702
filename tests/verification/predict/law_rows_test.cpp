// The rows of a prediction: hard cases O10 (no rows, one, repeated ones, unsorted or without time) and O11 (very many
// rows, very large strain).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "model/vocabulary/error.hpp"
#include "predict/predict.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_parameters.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/not_finite.hpp"

namespace grainlaw {
namespace {

using predict::Method;

using predict::OutputPoint;
using predict::Prediction;
using testing::expect_figure;
using testing::leg;
using testing::leg_to;
using testing::path_from;

using testing::kNaN;

Prediction run(Rung model, const std::vector<StraightSegment>& path, const LawState<double>& start,
               const std::vector<OutputPoint>& points, Method method = Method::adams) {
  return predict::predict(model, testing::coupled_parameters(), Coupling::energy, path, start, points,
                          {1e-8, 1e-12, method}, {}, {});
}

TEST(Rows, O10TheInitialStateIsReturnedExactly) {
  const auto path = path_from(0.70, {leg(Mode::UNI, 0.1), leg(Mode::D2, 0.1)});
  LawState<double> start = predict::state_from_law(testing::coupled_parameters(), 0.70);
  const LawState<double> of_law = start;
  start.P *= 0.93;
  start.sigma << 1e-3, 2e-4, 0, 1e-5, 0;
  start.F << 0.01, 0, 0.02, 0, -0.003;
  double off = 0, apart = 0;
  for (const Method method : {Method::adams, Method::bdf}) {
    for (const std::vector<OutputPoint>& points :
         {std::vector<OutputPoint>{{0, 0}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0.04}, {0, 0.04}, {1, 0.01}, {1, 0.01}}}) {
      for (const bool measured : {false, true}) {
        const LawState<double>& from = measured ? start : of_law;
        const auto rows = run(Rung::evolution, path, from, points, method).rows;
        ASSERT_EQ(rows.size(), points.size());
        off = std::max({off, std::abs(rows[0].state.P - from.P), (rows[0].state.sigma - from.sigma).norm(),
                        (rows[0].state.F - from.F).norm(), rows[0].strain.tensor.norm()});
        for (std::size_t i = 1; i < rows.size(); ++i) {
          if (points[i].segment != points[i - 1].segment || points[i].e != points[i - 1].e) continue;
          apart = std::max({apart, std::abs(rows[i].state.P - rows[i - 1].state.P),
                            (rows[i].state.sigma - rows[i - 1].state.sigma).norm(),
                            (rows[i].state.F - rows[i - 1].state.F).norm()});
        }
      }
    }
    EXPECT_TRUE(run(Rung::evolution, path, start, {}, method).rows.empty());
  }
  expect_figure("O10.initial_state", off, 0);
  expect_figure("O10.repeated_rows", apart, 0);
}

/// True when `attempt` is refused as invalid input with a message of one line that contains `name`.
bool refused_by_name(const std::function<void()>& attempt, const std::string& name) {
  try {
    attempt();
  } catch (const InvalidInput& error) {
    const std::string what = error.what();
    return what.find(name) != std::string::npos && what.find('\n') == std::string::npos;
  }
  return false;
}

TEST(Rows, O10WhatIsOutOfOrderIsRefusedByName) {
  const auto path = path_from(0.70, {leg(Mode::UNI, 0.1), leg(Mode::D2, 0.1)});
  const LawState<double> start = predict::state_from_law(testing::coupled_parameters(), 0.70);
  int unnamed = 0;
  const auto expect_refusal = [&](const std::function<void()>& attempt, const std::string& name) {
    const bool refused = refused_by_name(attempt, name);
    EXPECT_TRUE(refused) << name;
    unnamed += !refused;
  };
  for (const Rung model : {Rung::reduced, Rung::evolution}) {
    expect_refusal([&] { run(model, {}, start, {}); }, "no segments");
    for (const OutputPoint& bad : {OutputPoint{0, 0.03}, {0, kNaN}, {0, -1.0}, {0, 0.2}, {2, 0.0}, {-1, 0.0}}) {
      expect_refusal([&] { run(model, path, start, {{0, 0.05}, bad}); }, "output point 1");
    }
  }
  TestRecord test;
  test.name = "made-up";
  test.path = {0.70, Branch::unloading, {leg(Mode::D2, 0.15), leg_to(Mode::ISO, 0.73)}};
  const auto segments = resolve(test.path);
  for (const OutputPoint& point : predict::uniform_points(segments, 4)) {
    Observation row;
    row.time = static_cast<double>(test.rows.size());
    row.segment = point.segment;
    row.strain = segments[static_cast<std::size_t>(point.segment)].strain(point.e);
    row.nu = segments[static_cast<std::size_t>(point.segment)].nu(point.e);
    test.rows.push_back(row);
  }
  ASSERT_EQ(predict::points_of(test).size(), test.rows.size());
  const auto with = [&](std::size_t row, const std::function<void(Observation&)>& change) {
    TestRecord changed = test;
    change(changed.rows[row]);
    expect_refusal([&] { predict::points_of(changed); }, "made-up: row " + std::to_string(row + 1) + ":");
  };
  for (std::size_t row = 0; row < test.rows.size(); ++row) {
    with(row, [](Observation& o) { o.time = kNaN; });
    with(row, [](Observation& o) { o.nu = kNaN; });
    with(row, [](Observation& o) { o.strain.tensor(2, 2) = kNaN; });
    if (row > 0) with(row, [](Observation& o) { o.time -= 1.5; });
  }
  TestRecord unsorted = test;
  std::swap(unsorted.rows[2].strain, unsorted.rows[3].strain);
  expect_refusal([&] { predict::points_of(unsorted); }, "made-up: row 4:");
  expect_figure("O10.not_refused_by_name", unnamed, 0);
}

TEST(Rows, O11WorkPerRowDoesNotGrowWithTheNumberOfRows) {
  const auto path = path_from(0.695, {leg_to(Mode::UNI, 0.82)});
  const LawState<double> start = predict::state_from_law(testing::coupled_parameters(), 0.695);
  for (const Method method : {Method::adams, Method::bdf}) {
    double per_row[2] = {}, last[2] = {};
    for (const int i : {0, 1}) {
      const int rows = i == 0 ? 10000 : 1000000;
      const Prediction prediction = run(Rung::evolution, path, start, predict::uniform_points(path, rows - 1), method);
      ASSERT_EQ(prediction.rows.size(), static_cast<std::size_t>(rows));
      per_row[i] = static_cast<double>(prediction.statistics.rhs_evaluations) / rows;
      last[i] = prediction.rows.back().state.P;
    }
    EXPECT_NEAR(last[1] / last[0], 1, 1e-7);
    expect_figure(std::string("O11.work_per_row_of_1e6_over_1e4_") + (method == Method::adams ? "adams" : "bdf"),
                  per_row[1] / per_row[0], 1);
  }
}

TEST(Rows, O11WorkPerCornerDoesNotGrowWithTheNumberOfCorners) {
  // Pieces of one length, so that each costs the same: 1e3 and 2e4 reversals.
  double per_corner[2] = {};
  for (const int i : {0, 1}) {
    const int corners = i == 0 ? 1000 : 20000;
    const auto path = testing::reversals(0.74, corners, 1e-3 * (corners + 1));
    const Prediction prediction =
        run(Rung::evolution, path, predict::state_from_law(testing::coupled_parameters(), 0.74),
            predict::uniform_points(path, 1));
    ASSERT_EQ(prediction.rows.size(), 2 * path.size());
    EXPECT_EQ(prediction.statistics.restarts, corners + 1);
    per_corner[i] = static_cast<double>(prediction.statistics.rhs_evaluations) / corners;
  }
  expect_figure("O11.work_per_corner_of_2e4_over_1e3", per_corner[1] / per_corner[0], 1.05);
}

TEST(Rows, O11LargeStrainSaturates) {
  // At shear strain 10 nothing is left of the start: exp(-beta e) < exp(-300). s = s_max(nu), F = F_max(nu).
  for (const Method method : {Method::adams, Method::bdf}) {
    double off = 0;
    for (const double nu : {0.68, 0.74, 0.82}) {
      for (const Coupling coupling : {Coupling::energy, Coupling::single}) {
        const LawParameters<double> p = testing::coupled_parameters();
        const auto path = path_from(nu, {leg(Mode::D2, 10)});
        const auto rows = predict::predict(Rung::evolution, p, coupling, path, predict::state_from_law(p, nu),
                                           predict::uniform_points(path, 20), {1e-8, 1e-12, method}, {}, {})
                              .rows;
        ASSERT_EQ(rows.size(), 21U);
        for (std::size_t i = 4; i < rows.size(); ++i) {  // from strain 2 on: exp(-beta e) < 1e-14 at its slowest
          off = std::max({off, std::abs(rows[i].s_par / p.stress_ratio_max.value(nu, p.shear_nu_c) - 1),
                          std::abs(rows[i].F_par / p.fabric_max.value(nu, p.shear_nu_c) - 1)});
        }
      }
    }
    expect_figure(std::string("O11.saturation_error_over_rtol_") + (method == Method::adams ? "adams" : "bdf"),
                  off / 1e-8, method == Method::adams ? 10 : 50);
  }
}

}  // namespace
}  // namespace grainlaw
