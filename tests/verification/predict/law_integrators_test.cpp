// Paths by every integrator of the study, against the closed forms of Eqs. (17) and (18) and against one another.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "model/vocabulary/error.hpp"
#include "predict/predict.hpp"
#include "predict/studies/walker.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_parameters.hpp"
#include "tests/support/law_path.hpp"

namespace grainlaw::predict {
namespace {

using testing::expect_figure;
using testing::leg;
using testing::leg_to;
using testing::path_from;

double distance(const LawState<double>& a, const LawState<double>& b) {
  return std::max({std::abs(a.P / b.P - 1), (a.sigma - b.sigma).norm() / b.P, (a.F - b.F).norm()});
}

TEST(Integrators, FollowTheClosedFormAtConstantVolume) {
  // a0 = 0: Eqs. (17) and (18) exactly, P constant
  LawParameters<double> p = testing::coupled_parameters();
  p.anisotropy.a0 = 0;
  const auto path = path_from(0.70, {leg(Mode::D2, 0.05)});
  const LawState<double> start = state_from_law(p, 0.70);
  const double s =
      p.stress_ratio_max.value(0.70, p.shear_nu_c) * -std::expm1(-0.05 * p.stress_rate.value(0.70, p.shear_nu_c));
  const double F =
      p.fabric_max.value(0.70, p.shear_nu_c) * -std::expm1(-0.05 * p.fabric_rate.value(0.70, p.shear_nu_c));
  const Deviator<double> N = shear_direction(path);
  const LawState<double> exact{start.P, N * (s * start.P), N * F};
  for (const Integrator integrator : kIntegrators) {
    const bool euler = integrator == Integrator::euler;
    double errors[2] = {};
    for (const int i : {0, 1}) {
      const double accuracy = (euler ? 1e-4 : 1e-5) * (i == 0 ? 1 : euler ? 0.1 : 1e-3);
      Walker walker(integrator, accuracy, p, Rung::evolution, Coupling::single);
      errors[i] = distance(walker.walk(path, start).ends.back(), exact);
    }
    expect_figure("integrators." + to_string(integrator) + ".error", errors[1], euler ? 1e-4 : 1e-6);
    EXPECT_LT(errors[1], 0.2 * errors[0]) << to_string(integrator) << ": a finer accuracy is more accurate";
  }
}

TEST(Integrators, RandomPathsBySeveralSolversAgreeWithATightReference) {
  const LawParameters<double> p = testing::coupled_parameters();
  std::mt19937_64 engine{7};
  const auto uniform = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); };
  Walker reference(Integrator::erk_8, 1e-13, p, Rung::evolution, Coupling::energy);
  constexpr std::array kCompared{Integrator::adams, Integrator::erk_5, Integrator::dopri_5};
  std::vector<std::unique_ptr<Walker>> walkers;
  for (const Integrator integrator : kCompared)
    walkers.push_back(std::make_unique<Walker>(integrator, 1e-9, p, Rung::evolution, Coupling::energy));
  std::array<double, kCompared.size()> off{};
  for (int i = 0; i < 200; ++i) {
    std::vector<PathSegment> legs;
    for (int k = 0; k < 5; ++k) {
      PathSegment any{Mode::tensor, {}, ExtentKind::eps_dev, uniform(0.01, 0.1)};
      Eigen::Matrix3d D;
      for (int r = 0; r < 9; ++r) D(r) = uniform(-1, 1);
      any.direction.tensor = (D + D.transpose()) / 2;
      // dense enough for a jammed state: the volume grows on no leg, and shrinks little
      any.direction.tensor -= Eigen::Matrix3d::Identity() * (any.direction.tensor.trace() / 3 + uniform(0, 0.05));
      legs.push_back(any);
    }
    const auto path = path_from(uniform(0.69, 0.74), legs);
    const LawState<double> start = state_from_law(p, path[0].nu_start);
    const auto expected = reference.walk(path, start).ends;
    for (std::size_t j = 0; j < walkers.size(); ++j) {
      const auto ends = walkers[j]->walk(path, start).ends;
      for (std::size_t k = 0; k < path.size(); ++k) off[j] = std::max(off[j], distance(ends[k], expected[k]));
    }
  }
  for (std::size_t j = 0; j < off.size(); ++j)
    expect_figure("integrators.random_paths." + to_string(kCompared[j]) + "_error_over_rtol", off[j] / 1e-9, 10);
}

TEST(Integrators, BatchesDoNotDependOnThreads) {
  const LawParameters<double> p = testing::coupled_parameters();
  std::vector<BatchPath> paths;
  for (int i = 0; i < 50; ++i) {
    const double nu = 0.68 + 0.001 * i;
    paths.push_back({path_from(nu, {leg_to(Mode::UNI, 0.80)}), state_from_law(p, nu)});
  }
  const auto run = [&](int threads) {
    return walk_batch(paths, Integrator::adams, 1e-8, p, Rung::evolution, Coupling::energy, threads, {});
  };
  const auto one = run(1);
  ASSERT_EQ(one.size(), paths.size());
  int different = 0;
  for (const int threads : {2, 3, 64}) {
    const auto many = run(threads);
    for (std::size_t i = 0; i < paths.size(); ++i)
      different += many[i].P != one[i].P || many[i].sigma != one[i].sigma || many[i].F != one[i].F;
  }
  expect_figure("integrators.batch.differing_paths", different, 0);

  paths[20].start.P = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(run(2), std::exception);
}

TEST(Integrators, RefuseAccuraciesThatAreNone) {
  const LawParameters<double> p = testing::coupled_parameters();
  for (const double bad : {0.0, -1e-6, 1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(Walker(Integrator::erk_5, bad, p, Rung::evolution, Coupling::energy), std::exception) << bad;
}

TEST(Integrators, FollowWhatTurnsOnTheWay) {
  const LawParameters<double> p = testing::memory_parameters();
  auto path = path_from(0.70, {leg(Mode::D2, 0.02), leg(Mode::D2, 0.005), leg(Mode::D2, 0.01)});
  path[1].spin << 0, 0, -400, 0, 0, 0, 400, 0, 0;
  const LawState<double> start = state_from_law(p, 0.70);
  const LawState<double> end =
      predict(Rung::memory, p, Coupling::energy, path, start, {{2, path[2].length}}, {1e-11, 1e-15}, {}, {})
          .rows.back()
          .state;
  EXPECT_GT(end.s_r.norm(), 0.01);
  for (const Integrator integrator : kIntegrators) {
    const bool euler = integrator == Integrator::euler;
    const LawState<double> walked =
        Walker(integrator, euler ? 1e-5 : 1e-8, p, Rung::memory, Coupling::energy).walk(path, start).ends.back();
    const double off = std::max((walked.sigma / walked.P - end.sigma / end.P).norm(), (walked.s_r - end.s_r).norm());
    EXPECT_LE(off, euler ? 1e-3 : 1e-5) << to_string(integrator);
  }
}

}  // namespace
}  // namespace grainlaw::predict
