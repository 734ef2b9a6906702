// Hard case O9: whatever the path, no row carries a tensile pressure or a tensile principal stress; states that unjam are
// zero until they jam again, and the prediction goes on. And O8 along the same paths: what is unjammed says so, and no row
// holds what is not a number.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "predict/predict.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_parameters.hpp"
#include "tests/support/law_path.hpp"

namespace grainlaw {
namespace {

using predict::Method;

using testing::expect_figure;
using testing::leg;
using testing::leg_to;

class Random {
 public:
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  std::size_t index(std::size_t count) { return engine_() % count; }

 private:
  std::mt19937_64 engine_{42};
};

/// Shear, unloading past jamming and compression again, in modes and lengths that differ from path to path.
std::vector<StraightSegment> there_and_back(Random& random, double nu) {
  const Mode modes[] = {Mode::UNI, Mode::D2, Mode::D3};
  const Mode volumetric[] = {Mode::ISO, Mode::UNI};
  std::vector<PathSegment> legs{leg(modes[1 + random.index(2)], random.uniform(0.01, 0.2), random.index(2) == 0),
                                leg_to(volumetric[random.index(2)], random.uniform(0.60, 0.67), true),
                                leg(modes[1 + random.index(2)], random.uniform(0.01, 0.2), random.index(2) == 0),
                                leg_to(volumetric[random.index(2)], random.uniform(0.70, 0.80))};
  return testing::path_from(nu, std::move(legs));
}

struct Tally {
  int paths = 0, unjammed = 0, jammed_again = 0, cut = 0, not_numbers = 0, ended_early = 0, out_of_order = 0;
  double most_tensile = 0;            // largest -P of any row
  double most_tensile_principal = 0;  // largest -(P + least eigenvalue of sigma') of any row, over the start's P
};

/// Unjammed and jammed take turns, and no event lies before the one above.
bool in_order(const std::vector<predict::PathEvent>& events) {
  bool jammed = true;
  predict::OutputPoint before;
  for (const auto& event : events) {
    if (std::tie(event.at.segment, event.at.e) < std::tie(before.segment, before.e)) return false;
    before = event.at;
    if (jammed != (event.kind != predict::EventKind::jammed)) return false;
    jammed = !jammed;
  }
  return true;
}

Tally walk_random_paths(Rung model) {
  Random random;
  Tally tally;
  const LawParameters<double> p = testing::coupled_parameters();
  const predict::Tolerances tolerances;
  for (; tally.paths < 400; ++tally.paths) {
    const double nu = random.uniform(0.675, 0.80);
    const auto path = there_and_back(random, nu);
    LawState<double> start = predict::state_from_law(p, nu);
    start.P *= random.uniform(0.3, 1.5);
    const double s = random.uniform(0, 1.2) * p.stress_ratio_max.value(nu, p.shear_nu_c);
    Deviator<double> direction, of_fabric;
    for (int i = 0; i < 5; ++i) direction(i) = random.uniform(-1, 1), of_fabric(i) = random.uniform(-1, 1);
    start.sigma = direction.normalized() * (s * start.P);
    start.F = of_fabric.normalized() * (random.uniform(0, 1.2) * p.fabric_max.value(nu, p.shear_nu_c));
    predict::Tolerances t = tolerances;
    t.method = random.index(2) == 0 ? Method::adams : Method::bdf;
    const Coupling coupling = random.index(2) == 0 ? Coupling::energy : Coupling::single;
    const auto points = predict::uniform_points(path, 50);
    const auto prediction = predict::predict(model, p, coupling, path, start, points, t, {}, {});
    tally.unjammed += prediction.unjammed;
    tally.ended_early += prediction.rows.size() < points.size();
    tally.out_of_order += !in_order(prediction.events);
    for (const auto& event : prediction.events) {
      tally.jammed_again += event.kind == predict::EventKind::jammed;
      tally.cut += event.kind == predict::EventKind::tension;
    }
    for (const auto& row : prediction.rows) {
      tally.most_tensile = std::max(tally.most_tensile, -row.state.P);
      const double principal =
          row.state.P +
          Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor_of(row.state.sigma)).eigenvalues().minCoeff();
      tally.most_tensile_principal = std::max(tally.most_tensile_principal, -principal / start.P);
      const double all = row.state.P + row.state.sigma.sum() + row.state.F.sum() + row.F_dev + row.F_par + row.nu +
                         row.strain.tensor.sum();
      const bool zero = row.state.P == 0;
      tally.not_numbers += !std::isfinite(all) || std::isnan(row.s_dev) != zero || std::isnan(row.s_par) != zero;
    }
  }
  return tally;
}

TEST(Tension, O9NoRowIsTensileOnPathsThatUnjamAndCompressAgain) {
  for (const Rung model : {Rung::reduced, Rung::evolution}) {
    const Tally tally = walk_random_paths(model);
    EXPECT_GT(tally.unjammed, 300);
    EXPECT_LT(tally.unjammed, tally.paths);
    EXPECT_GT(tally.jammed_again, 300);
    EXPECT_GE(tally.cut, model == Rung::evolution ? 10 : 0);
    const std::string name = to_string(model);
    expect_figure("O9." + name + ".largest_tension", tally.most_tensile, predict::Tolerances{}.absolute);
    expect_figure("O9." + name + ".largest_principal_tension", tally.most_tensile_principal, 1e-9);
    expect_figure("O9." + name + ".events_out_of_order", tally.out_of_order, 0);
    expect_figure("O8." + name + ".not_numbers", tally.not_numbers, 0);
    expect_figure("O8." + name + ".ended_early", tally.ended_early, 0);
  }
}

TEST(Tension, O9JammedAgainTheStressGrowsFromNothing) {
  // Uniaxial compression of an unjammed state: P grows from zero, and s_dev, which Eq. (16) draws towards a mean of s_max
  // and a2 F_dev, stays below the larger of the two; both are largest at jamming.
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path =
      testing::path_from(0.70, {leg(Mode::D2, 0.1), leg_to(Mode::ISO, 0.64, true), leg_to(Mode::UNI, 0.75)});
  const double nu_J = p.isotropic.pressure.nu_c;
  const double most =
      std::max(p.stress_ratio_max.value(nu_J, p.shear_nu_c), p.anisotropy.a2 * p.fabric_max.value(nu_J, p.shear_nu_c));
  const auto points = predict::uniform_points(path, 200);
  for (const Method method : {Method::adams, Method::bdf}) {
    const auto rows = predict::predict(Rung::evolution, p, Coupling::energy, path, predict::state_from_law(p, 0.70),
                                       points, {1e-9, 1e-13, method}, {}, {})
                          .rows;
    ASSERT_EQ(rows.size(), points.size());
    double before = 0;
    for (const auto& row : rows) {
      if (row.segment < 2) continue;
      EXPECT_GE(row.state.P, before);
      before = row.state.P;
      EXPECT_FALSE(row.s_dev > most) << row.nu;
    }
    EXPECT_GT(rows.back().s_dev, 0.05);
  }
}

TEST(Tension, O9TensionIsCutOffWhereAPrincipalStressVanishes) {
  // UNI extension after shear: sigma' outlives P. Just before the event the least principal stress is all but zero while
  // P is not; from there on all is zero. Both solvers find one place.
  const LawParameters<double> p = testing::coupled_parameters();
  const auto path = testing::path_from(0.75, {leg(Mode::D2, 0.1), leg(Mode::UNI, 0.2, true)});
  LawState<double> start = predict::state_from_law(p, 0.75);
  start.P *= 0.9;
  double at[2] = {}, least = 0;
  for (const Method method : {Method::adams, Method::bdf}) {
    const auto run = [&](const std::vector<predict::OutputPoint>& points) {
      return predict::predict(Rung::evolution, p, Coupling::energy, path, start, points, {1e-10, 1e-14, method}, {},
                              {});
    };
    const auto events = run({{1, path[1].length}}).events;
    ASSERT_EQ(events.size(), 1U);
    ASSERT_EQ(events[0].kind, predict::EventKind::tension);
    at[method == Method::bdf] = events[0].at.e;
    const auto rows = run({{1, events[0].at.e - 1e-9}, {1, events[0].at.e + 1e-9}}).rows;
    const auto& before = rows.at(0).state;
    EXPECT_GT(before.P, 1e-4 * start.P);
    const double principal =
        before.P + Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor_of(before.sigma)).eigenvalues().minCoeff();
    EXPECT_GT(principal, 0);
    least = std::max(least, principal / start.P);
    EXPECT_EQ(rows.at(1).state.P, 0);
  }
  expect_figure("O9.least_principal_stress_before_the_cut", least, 1e-6);
  expect_figure("O9.place_of_the_cut_adams_against_bdf", std::abs(at[0] - at[1]), 1e-9);
}

}  // namespace
}  // namespace grainlaw
