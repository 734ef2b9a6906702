// Hard case O5, a manufactured solution of Eq. (16) on all eleven unknowns. Every component is chosen to be
//   Y(e) = m (1 + a sin(w e + phi))
// which no law would give, and what it lacks is added to the right-hand side as a source:
//   dy/de = f(e, y) + Y'(e) - f(e, Y(e)),   so that y(0) = Y(0) gives y = Y.
// It tests what no closed form does: all terms at once, tensors whose axes are not those of the strain, nu that changes.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "predict/segment_law.hpp"
#include "predict/solvers/cvode.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_parameters.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/table.hpp"
#include "tests/support/tolerance_study.hpp"

namespace grainlaw::predict {
namespace {

using testing::expect_figure;
using testing::leg;
using testing::leg_to;

constexpr Method kSolvers[] = {Method::adams, Method::bdf};

/// One component of the solution: m (1 + a sin(w e + phi)).
struct Wave {
  double m, a, w, phi;
  double value(double e) const { return m * (1 + a * std::sin(w * e + phi)); }
  double slope(double e) const { return m * a * w * std::cos(w * e + phi); }
};

struct Solution {
  Wave P;
  std::array<Wave, 5> sigma, F;

  LawState<double> at(double e) const {
    LawState<double> y{P.value(e), {}, {}};
    for (int i = 0; i < 5; ++i) {
      y.sigma(i) = sigma[static_cast<std::size_t>(i)].value(e);
      y.F(i) = F[static_cast<std::size_t>(i)].value(e);
    }
    return y;
  }

  LawState<double> slope(double e) const {
    LawState<double> y{P.slope(e), {}, {}};
    for (int i = 0; i < 5; ++i) {
      y.sigma(i) = sigma[static_cast<std::size_t>(i)].slope(e);
      y.F(i) = F[static_cast<std::size_t>(i)].slope(e);
    }
    return y;
  }
};

/// P of the size of P_0, sigma' some tenths of it, F' a tenth: each component with its own frequency and phase.
Solution solution_of_size(double P_0) {
  Solution s{{P_0, 0.3, 21, 0.4}, {}, {}};
  for (std::size_t i = 0; i < 5; ++i) {
    const double k = static_cast<double>(i);
    s.sigma[i] = {(i % 2 == 0 ? 0.08 : -0.05) * P_0, 0.6, 13 + 7 * k, 0.9 * k};
    s.F[i] = {(i % 2 == 0 ? -0.06 : 0.09), 0.5, 33 - 5 * k, 1.3 * k};
  }
  return s;
}

LawState<double> difference(const LawState<double>& a, const LawState<double>& b) {
  return {a.P - b.P, a.sigma - b.sigma, a.F - b.F};
}

struct ErrorOfSolution {
  double error = 0;  // of P over P, of the deviators over their norm
  long rhs_evaluations = 0;
};

/// The law `p` with the sources that belong to `of_sources`.
ErrorOfSolution integrate(const LawParameters<double>& p, const LawParameters<double>& of_sources, Coupling coupling,
                          const StraightSegment& segment, const Tolerances& tolerances) {
  const Solution exact = solution_of_size(p.isotropic.P_star(segment.nu_start));
  const LawDirection direction = law_direction(segment.direction);
  const SegmentLaw law(p, Rung::evolution, coupling, segment, 0);
  const auto rate = [&](double e, const double* y, double* out) {
    law.rate(e, y, out);
    const LawState<double> source = difference(
        exact.slope(e), testing::evolution_rate(of_sources, coupling, exact.at(e), segment.nu(e), direction));
    // The unknowns are an affine function of the state.
    const Unknowns with = law.unknowns_of(e, source),
                   without = law.unknowns_of(e, {0, Deviator<double>::Zero(), Deviator<double>::Zero()});
    for (std::size_t i = 0; i < kUnknowns; ++i) out[i] += with[i] - without[i];
  };
  Cvode solver(kUnknowns, tolerances, rate, {},
               [&](double e, const double* y, double* scale) { law.scale(e, y, scale); });
  Unknowns y = law.unknowns_of(0, exact.at(0));
  solver.start(0, y, segment.length);
  ErrorOfSolution outcome;
  for (int i = 1; i <= 100; ++i) {
    const double e = i == 100 ? segment.length : segment.length * i / 100;
    if (solver.advance(e, y).kind != Arrival::Kind::reached) {
      ADD_FAILURE() << "no arrival at e = " << e;
      return outcome;
    }
    const LawState<double> found = law.state_of(e, y.data()), expected = exact.at(e), off = difference(found, expected);
    outcome.error = std::max({outcome.error, std::abs(off.P / expected.P), off.sigma.norm() / expected.sigma.norm(),
                              off.F.norm() / expected.F.norm()});
  }
  outcome.rhs_evaluations = solver.statistics().rhs_evaluations;
  return outcome;
}

std::vector<StraightSegment> segments() {
  PathSegment oblique{Mode::tensor, {}, ExtentKind::eps_dev, 0.2};
  oblique.direction.tensor << 0.4, 0.3, -0.2, 0.3, -0.6, 0.1, -0.2, 0.1, 0.15;  // dilates slightly and turns nowhere
  return {testing::path_from(0.68, {leg_to(Mode::UNI, 0.80)})[0],
          testing::path_from(0.80, {leg_to(Mode::UNI, 0.70, true)})[0],
          testing::path_from(0.70, {leg(Mode::D3, 0.2)})[0], testing::path_from(0.76, {oblique})[0]};
}

TEST(Manufactured, O5SolutionWithSourcesIsFollowedToTheTolerance) {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a2 = 1.18;
  std::vector<std::vector<std::string>> table;
  for (const Method method : kSolvers) {
    const std::string name = method == Method::adams ? "adams" : "bdf";
    testing::ToleranceStudy worst;
    double slope_off = 0;
    for (const Coupling coupling : {Coupling::energy, Coupling::single}) {
      for (const StraightSegment& segment : segments()) {
        testing::ToleranceStudy study;
        for (int k = 3; k <= 12; ++k) {
          const double relative = std::pow(10.0, -k);
          const ErrorOfSolution outcome = integrate(p, p, coupling, segment, {relative, 1e-4 * relative, method});
          study.add(relative, outcome.error, outcome.rhs_evaluations);
          worst.add(relative, outcome.error, outcome.rhs_evaluations);
        }
        slope_off = std::max(slope_off, std::abs(study.slope() - 1));
      }
    }
    expect_figure("O5." + name + "_error_over_rtol", worst.largest_over_tolerance(), method == Method::adams ? 10 : 50);
    expect_figure("O5." + name + "_slope_off_one", slope_off, 0.2);
    for (auto& row : worst.rows(name)) table.push_back(std::move(row));
  }
  testing::print_table("O5.cvode", testing::ToleranceStudy::header(), table);
}

TEST(Manufactured, ALawThatIsALittleOffIsNoticed) {
  LawParameters<double> p = published_parameters(), off = p;
  p.anisotropy.a2 = 1.18;
  off.anisotropy.a2 = 1.18 * (1 + 1e-6);
  for (const Method method : kSolvers) {
    EXPECT_GT(integrate(off, p, Coupling::energy, segments()[0], {1e-11, 1e-15, method}).error, 1e-8);
  }
}

}  // namespace
}  // namespace grainlaw::predict
