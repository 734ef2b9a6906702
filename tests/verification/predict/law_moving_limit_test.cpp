// Hard case O7: the stress isotropy S = 1 - s/s_max changes its sign. Uniaxial compression (de = dx, nu = nu_0 exp(x)) with
// A = 0 and a constant rate beta, where Eq. (16) is linear, dsigma/dx = beta (s_max(nu) P - sigma), in two closed forms:
//
//   s_max falls with nu, P stays (p0 = 0, hence B = 0). u = nu/nu_c, gamma the lower incomplete gamma function:
//     s u^beta = s_0 u_0^beta + Q (u^beta - u_0^beta) + Q_c e^alpha beta alpha^-beta (gamma(beta, alpha u) - gamma(beta, alpha u_0))
//     s from 0 overtakes the falling limit once, and falls from there on; s from 1.2 s_max falls after it and never meets it.
//   s_max stays, P = k x e^x grows (C = 6, gamma_p = 0, x = ln(nu/nu_c)) and dilutes s. b = 1 + beta:
//     sigma e^(beta x) = sigma_0 e^(beta x_0) + beta s_max k [e^(b x)(x/b - 1/b^2)]
//     s from 1.2 s_max falls through s_max once; s from 0 stays below.
//   dF/dx = beta (F_max(nu) - F) is the first equation again.

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "predict/predict.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_path.hpp"
#include "tests/support/tolerance_study.hpp"

namespace grainlaw {
namespace {

using predict::Method;
using testing::expect_figure;
using testing::leg_to;

constexpr double kBeta = 30, kStart = 0.68, kEnd = 0.84;
constexpr double kFromZero = 0, kFromAbove = 1.2;  // of s_max

/// Law without coupling and with one constant rate for stress and fabric.
LawParameters<double> linear_law() {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a0 = 0;
  p.stress_rate = p.fabric_rate = {kBeta, 0, 1};
  return p;
}

/// Closed form of dq/dx = beta (Q(nu) - q).
double following(const ExponentialLaw<double>& Q, double nu_c, double q_0, double nu) {
  const double u = nu / nu_c, u_0 = kStart / nu_c, ratio = std::pow(u_0 / u, kBeta);
  // alpha^-beta (gamma(beta, alpha u) - gamma(beta, alpha u_0)) u^-beta, by the logarithm: gamma(beta) alone is 1e31.
  const double between = boost::math::gamma_p(kBeta, Q.alpha * u) - boost::math::gamma_p(kBeta, Q.alpha * u_0);
  const double decaying = kBeta * between * std::exp(Q.alpha + std::lgamma(kBeta) - kBeta * std::log(Q.alpha * u));
  return q_0 * ratio + Q.Q_limit * (1 - ratio) + Q.Q_c * decaying;
}

struct Case {
  std::string name;
  LawParameters<double> law;
  LawState<double> start;  // without deviators
  std::function<double(double s_0, double nu)> s;
};

Case falling_limit() {
  LawParameters<double> p = linear_law();
  p.isotropic.pressure.p0 = 0;
  return {"falling_limit", p, {0.02, Deviator<double>::Zero(), Deviator<double>::Zero()}, [p](double s_0, double nu) {
            return following(p.stress_ratio_max, p.shear_nu_c, s_0, nu);
          }};
}

Case growing_pressure() {
  LawParameters<double> p = linear_law();
  p.isotropic.coordination.C1 = p.isotropic.rattlers.phi_c = p.isotropic.pressure.gamma_p = 0;
  p.stress_ratio_max = {0.15, 0, 1};
  return {"growing_pressure", p, predict::state_from_law(p, kStart), [p](double s_0, double nu) {
            const double k = 6 * p.isotropic.pressure.p0, b = 1 + kBeta, s_max = p.stress_ratio_max.Q_limit;
            const double x = std::log(nu / p.isotropic.pressure.nu_c),
                         x_0 = std::log(kStart / p.isotropic.pressure.nu_c);
            const auto primitive = [&](double t) { return std::exp(b * t - kBeta * x) * (t / b - 1 / (b * b)); };
            const double P = k * x * std::exp(x), P_0 = k * x_0 * std::exp(x_0);
            return (s_0 * P_0 * std::exp(-kBeta * (x - x_0)) + kBeta * s_max * k * (primitive(x) - primitive(x_0))) / P;
          }};
}

double s_max_at(const Case& c, double nu) { return c.law.stress_ratio_max.value(nu, c.law.shear_nu_c); }

/// Rows from s_0 and F_0, both given in units of their limits at the start.
std::vector<predict::PredictedRow> integrate(const Case& c, double part, int outputs, const predict::Tolerances& t,
                                             long* rhs_evaluations = nullptr) {
  const auto path = testing::path_from(kStart, {leg_to(Mode::UNI, kEnd)});
  LawState<double> start = c.start;
  start.sigma = shear_direction(path) * (part * s_max_at(c, kStart) * start.P);
  start.F = shear_direction(path) * (part * c.law.fabric_max.value(kStart, c.law.shear_nu_c));
  const auto prediction = predict::predict(Rung::evolution, c.law, Coupling::single, path, start,
                                           predict::uniform_points(path, outputs), t, {}, {});
  EXPECT_EQ(prediction.rows.size(), static_cast<std::size_t>(outputs) + 1);
  if (rhs_evaluations) *rhs_evaluations = prediction.statistics.rhs_evaluations;
  return prediction.rows;
}

/// Largest deviation of s and F from their closed forms, over their limits at the start.
double largest_error(const Case& c, double part, const std::vector<predict::PredictedRow>& rows) {
  const double s_scale = s_max_at(c, kStart), F_scale = c.law.fabric_max.value(kStart, c.law.shear_nu_c);
  double largest = 0;
  for (const auto& row : rows) {
    const double F = following(c.law.fabric_max, c.law.shear_nu_c, part * F_scale, row.nu);
    largest = std::max(
        {largest, std::abs(row.s_par - c.s(part * s_scale, row.nu)) / s_scale, std::abs(row.F_par - F) / F_scale});
  }
  return largest;
}

TEST(MovingLimit, ClosedFormsSolveTheirEquations) {
  // Central differences of the closed forms against beta (s_max P - sigma).
  for (const Case& c : {falling_limit(), growing_pressure()}) {
    const auto P = [&](double nu) { return c.law.isotropic.pressure.p0 > 0 ? c.law.isotropic.P_star(nu) : c.start.P; };
    for (const double nu : {0.69, 0.73, 0.82}) {
      const double h = 1e-5, s_0 = 0.1;
      const auto sigma = [&](double x) { return c.s(s_0, nu * std::exp(x)) * P(nu * std::exp(x)); };
      const double expected = kBeta * (s_max_at(c, nu) * P(nu) - sigma(0));
      EXPECT_NEAR((sigma(h) - sigma(-h)) / (2 * h), expected, 1e-6 * kBeta * s_max_at(c, nu) * P(nu)) << c.name << nu;
    }
    EXPECT_NEAR(c.s(0.1, kStart), 0.1, 1e-14);
  }
}

TEST(MovingLimit, O7StressRatioFollowsTheClosedForm) {
  for (const Case& c : {falling_limit(), growing_pressure()}) {
    for (const Method method : {Method::adams, Method::bdf}) {
      double largest = 0, slope_off = 0;
      for (const double part : {kFromZero, kFromAbove}) {
        testing::ToleranceStudy study;
        for (int k = 3; k <= 12; ++k) {
          const double relative = std::pow(10.0, -k);
          const auto rows = integrate(c, part, 200, {relative, 1e-4 * relative, method});
          study.add(relative, largest_error(c, part, rows), 0);
        }
        largest = std::max(largest, study.largest_over_tolerance());
        slope_off = std::max(slope_off, std::abs(study.slope() - 1));
      }
      const std::string name = c.name + (method == Method::adams ? ".adams" : ".bdf");
      expect_figure("O7." + name + "_error_over_rtol", largest, method == Method::adams ? 10 : 50);
      expect_figure("O7." + name + "_slope_off_one", slope_off, 0.2);
    }
  }
}

/// Rows after which S has another sign, and steps between rows against the sense that S commands.
struct Crossing {
  int crossings = 0, against = 0;
};

Crossing crossing_of(const Case& c, const std::vector<predict::PredictedRow>& rows) {
  constexpr double slack = 1e-9;  // ten times the tolerance
  Crossing result;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double S_before = s_max_at(c, rows[i - 1].nu) - rows[i - 1].s_par,
                 S = s_max_at(c, rows[i].nu) - rows[i].s_par;
    const double step = rows[i].s_par - rows[i - 1].s_par;
    result.crossings += S_before * S < 0;
    // Where P stays, s rises below its limit and falls above it. Where P grows, it also falls by dilution: never up above.
    if (S < 0 && S_before < 0 && step > slack) ++result.against;
    if (c.name == "falling_limit" && S > 0 && S_before > 0 && step < -slack) ++result.against;
  }
  return result;
}

TEST(MovingLimit, O7StressIsotropyChangesItsSignOnceAndSMovesAccordingly) {
  int against = 0;
  for (const Case& c : {falling_limit(), growing_pressure()}) {
    for (const Method method : {Method::adams, Method::bdf}) {
      for (const double part : {kFromZero, kFromAbove}) {
        const Crossing crossing = crossing_of(c, integrate(c, part, 1000, {1e-10, 1e-14, method}));
        const bool crosses = (c.name == "falling_limit") == (part == kFromZero);
        EXPECT_EQ(crossing.crossings, crosses ? 1 : 0) << c.name << " from " << part;
        against += crossing.against;
      }
    }
  }
  expect_figure("O7.steps_against_the_sign_of_S", against, 0);
}

}  // namespace
}  // namespace grainlaw
