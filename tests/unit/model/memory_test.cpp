#include "model/memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/law.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw {
namespace {

LawParameters<double> parameters() {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a2 = 1.18;
  p.memory = {0.782, 0.59, 2, 16.5, 40, 12, 1.18, 0.8, 0.6, 1.3};
  return p;
}

const Deviator<double> kN = law_direction(direction_of(Mode::D2)).N;
const Deviator<double> kZero = Deviator<double>::Zero();

LawState<double> coaxial(double P, double s, double F, double s_r, double E = 0) {
  return {P, s * P * kN, F * kN, s_r * kN, E * kN};
}

LawState<double> rate(const LawParameters<double>& p, const LawState<double>& y, double nu, const LawDirection& d) {
  return law_rate(p, Rung::memory, Coupling::energy, y, nu, d);
}

double elastic(const LawParameters<double>& p, double nu_P) {
  return 0.782 * std::pow(nu_P / p.isotropic.pressure.nu_c - 1, 0.59);
}

double limit(double s_max, double dilatancy) { return std::exp(std::asinh(dilatancy / s_max)) * s_max; }

TEST(Memory, InvariantFormOnCoaxialPaths) {
  // with sg the sign of the shear: S = 1 - q xi^n, xi = sg (s - s_r)/Delta, Delta = s_lim - sg s_r, n = 1 + (1 + sg E)^2
  const LawParameters<double> p = parameters();
  int dilating = 0, contracting = 0, partly = 0, not_loading = 0, yielding = 0;
  for (const double nu : {0.68, 0.74, 0.82}) {
    const double s_max = p.stress_ratio_max.value(nu, p.shear_nu_c), F_max = p.fabric_max.value(nu, p.shear_nu_c);
    for (const double sg : {1.0, -1.0}) {
      for (const double dx : {-0.8, 0.0, 1.3, 20.0}) {
        const double P = p.isotropic.P_star(nu), F = sg * 0.05, s_r = -sg * 0.1, s = s_r + sg * 0.2, de = 1.7;
        const double E = dx > 1 ? -sg * 0.6 : 0.7;
        const LawState<double> r = rate(p, coaxial(P, s, F, s_r, E), nu, {dx, de, sg * kN});
        const double B = p.isotropic.B_star(nu), A1 = 2.0 / 3 * (1.3 * B * F - s * P);
        const double f = sg * F / F_max;
        const double DG = elastic(p, nu);
        const double P_t = P + (p.steady.P_star(nu) - P) * f * std::abs(f);
        const double s_lim = limit(s_max, 0.8 * 16.5 * (P_t - P) / B);
        const double q = std::clamp(1 - B * std::max(dx, 0.0) * sg * (s - 1.18 * F) / (DG * de), 0.0, 1.0);
        const double xi = sg * (s - s_r) / (s_lim - sg * s_r), S = 1 - q * std::pow(xi, 1 + std::pow(1 + sg * E, 2));
        const double sheared_P = (A1 * S * sg + 16.5 * (1 - kPlasticRelaxation * S) * (P_t - P)) * de,
                     sheared_s = (DG * S * sg * de - s * sheared_P) / P;
        dilating += s_lim > 1.01 * s_max ? 1 : 0;
        contracting += s_lim < 0.99 * s_max ? 1 : 0;
        partly += q > 0 && q < 1 ? 1 : 0;
        not_loading += q == 0 ? 1 : 0;
        EXPECT_NEAR(r.P, B * dx + sheared_P, 1e-12);
        // expansion loads along M = sg_M kN, the sign of s - a2 F, as shear does, with the exponent m
        const double away = s - 1.18 * F, sg_M = away < 0 ? -1 : 1, f_M = sg_M * F / F_max;
        const double lim_M =
            limit(s_max, 0.8 * 16.5 * (p.steady.P_star(nu) - P) * f_M * std::abs(f_M) / p.isotropic.B_star(nu));
        const double xi_M = std::max(0.0, sg_M * (s - s_r) / (lim_M - sg_M * s_r));
        const double yields = B * away * std::pow(xi_M, 2) * std::max(-dx, 0.0);
        yielding += std::abs(yields) > 1e-5 ? 1 : 0;
        EXPECT_NEAR(r.sigma.dot(kN), 1.18 * B * F * dx + DG * S * sg * de - yields, 1e-12);
        EXPECT_NEAR(r.F.dot(kN),
                    (40 * (F_max / s_max * s - F)) * de + 0.6 * F_max / s_max * sheared_s -
                        12 / 0.4 * (F - 0.6 * F_max / s_max * s) * std::max(dx, 0.0),
                    1e-12);
        EXPECT_NEAR(r.E.dot(kN), (sg - E) * de / kStrainMemory, 1e-12);
        EXPECT_LE((r.sigma - r.sigma.dot(kN) * kN).norm() + (r.F - r.F.dot(kN) * kN).norm(), 1e-14) << "stays co-axial";
        EXPECT_LE((r.E - r.E.dot(kN) * kN).norm(), 1e-14);
        EXPECT_TRUE(r.s_r.isZero(0));
      }
    }
  }
  EXPECT_GT(dilating, 0);
  EXPECT_GT(contracting, 0);
  EXPECT_GT(partly, 0);
  EXPECT_GT(not_loading, 0);
  EXPECT_GT(yielding, 0);
}

TEST(Memory, WhileItDilatesItBearsMore) {
  // flow vanishes at s_lim, in proportion to the dilatancy k (P_t - P)/B; a packing at its sheared pressure has s_max.
  const LawParameters<double> p = parameters();
  const double nu = 0.69, F = p.fabric_max.value(nu, p.shear_nu_c), s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  const double P_D2 = p.steady.P_star(nu);
  for (const double P : {p.isotropic.P_star(nu), 0.5 * (p.isotropic.P_star(nu) + P_D2), P_D2, 1.02 * P_D2}) {
    const double nu_P = nu * std::exp((P - p.isotropic.P_star(nu)) / p.isotropic.B_star(nu));
    const double dilatancy = 16.5 * (P_D2 - P) / p.isotropic.B_star(nu_P);
    const double s_lim = limit(s_max, 0.8 * dilatancy);
    EXPECT_NEAR(rate(p, coaxial(P, s_lim, F, 0), nu, {0, 1, kN}).sigma.norm(), 0, 1e-14) << P;
    EXPECT_GT(rate(p, coaxial(P, 0.99 * s_lim, F, 0), nu, {0, 1, kN}).sigma.dot(kN), 0) << P;
  }
}

TEST(Memory, OnTheLimitCompressionTakesTheStressAlong) {
  // What compression would take from s, shear gives back elastically: dsigma' = s B dx as long as shear gives enough.
  LawParameters<double> p = parameters();
  p.memory.chi = 0;
  const double nu = 0.74, P = p.steady.P_star(nu), s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  const double nu_P = nu * std::exp((P - p.isotropic.P_star(nu)) / p.isotropic.B_star(nu)),
               B = p.isotropic.B_star(nu_P);
  const LawState<double> y = coaxial(P, s_max, 0.05, 0);
  for (const double dx : {0.0, 0.3, 1.0}) EXPECT_NEAR(rate(p, y, nu, {dx, 1, kN}).sigma.dot(kN), s_max * B * dx, 1e-13);
  const double DG = elastic(p, nu_P);
  EXPECT_NEAR(rate(p, y, nu, {9, 1, kN}).sigma.dot(kN), 1.18 * B * 0.05 * 9 + DG, 1e-13) << "no longer";
  // and where shear fades, so does its part, whatever the direction
  const LawState<double> alone = rate(p, y, nu, {1, 0, kZero});
  for (const double sg : {1.0, -1.0}) {
    const LawState<double> faint = rate(p, y, nu, {1, 1e-9, sg * kN});
    EXPECT_LE((faint.sigma - alone.sigma).norm() + (faint.F - alone.F).norm() + std::abs(faint.P - alone.P), 1e-6);
  }
}

TEST(Memory, ExpansionTakesTheStressRatioToItsLimitAndNoFurther) {
  LawParameters<double> p = parameters();
  p.memory.chi = 0;
  const double nu = 0.74, P = p.isotropic.P_star(nu), s_max = p.stress_ratio_max.value(nu, p.shear_nu_c), F = 0.05;
  const double B = p.isotropic.B_star(nu);
  const LawDirection expansion{-1, 0, kZero};
  const auto ds = [&](const LawState<double>& y) {
    const LawState<double> r = rate(p, y, nu, expansion);
    return Deviator<double>((r.sigma - y.sigma * (r.P / y.P)) / y.P);
  };
  EXPECT_NEAR(ds(coaxial(P, s_max, F, 0)).norm(), 0, 1e-12) << "on the limit";
  EXPECT_NEAR(ds(coaxial(P, 0.1, F, 0.1)).dot(kN), B * (0.1 - 1.18 * F) / P, 1e-12) << "at a reversal: elastic";
  EXPECT_NEAR(ds(coaxial(P, -0.1, -F, -0.1)).dot(kN), -B * (0.1 - 1.18 * F) / P, 1e-12) << "either sign of shear";
  EXPECT_NEAR(ds(coaxial(P, 0.03, F, 0)).dot(kN), B * (0.03 - 1.18 * F) / P, 1e-12) << "towards zero: elastic";
  // Whatever the direction of s, and however fast P falls.
  Deviator<double> across = kZero;
  across << 0, 0, 0.6, -0.8, 0;
  for (const double angle : {0.0, 0.7, 1.5}) {
    const Deviator<double> n = std::cos(angle) * kN + std::sin(angle) * across;
    LawState<double> y{P, 0.9 * s_max * P * n, kZero, kZero, kN};
    const double step = 1e-4;
    double at = nu;
    for (int i = 0; i < 700; ++i, at *= std::exp(-step)) {
      const LawState<double> r = rate(p, y, at, expansion);
      y.P += r.P * step;
      y.sigma += r.sigma * step;
      ASSERT_LE(y.sigma.norm() / y.P, 1.01 * p.stress_ratio_max.value(at, p.shear_nu_c)) << at;
    }
    EXPECT_NEAR((y.sigma / y.sigma.norm()).dot(n / n.norm()), 1, 1e-12) << "s keeps its direction";
    EXPECT_GT(y.sigma.norm() / y.P, 0.9 * s_max);
  }
}

TEST(Memory, WithoutItsTermsItIsEquation16) {
  // m = 1, k = c_F = 0, a_P = a2, s_r = 0 and P on ISO unloading: with DG = beta_s s_max P the rows of P and sigma' are those of Eq. (16); the
  // fabric's where s = s_max N, with lambda = beta_F.
  LawParameters<double> p = parameters();
  for (const double nu : {0.68, 0.74, 0.82}) {
    const LawModuli<double> m = moduli_at(p, nu);
    const double P = p.isotropic.P_star(nu);
    p.memory = {m.beta_s * m.s_max * P, 0, 1, 0, m.beta_F, 0, p.anisotropy.a2, 0, 0, p.anisotropy.a2};
    for (const double dx : {-0.5, 0.0, 0.9}) {
      LawState<double> y{P, 0.03 * P * kN, 0.06 * kN, kZero};
      y.sigma(3) += 0.04 * P;
      y.F(1) -= 0.02;
      const LawDirection d{dx, 1.3, kN};
      {
        constexpr Coupling coupling = Coupling::energy;
        const LawState<double> memory = law_rate(p, Rung::memory, coupling, y, nu, d),
                               eq16 = law_rate(p, Rung::evolution, coupling, y, nu, d);
        EXPECT_NEAR(memory.P, eq16.P, 1e-13);
        if (dx >= 0) {  // Eq. (16) yields to shear alone
          EXPECT_LE((memory.sigma - eq16.sigma).norm(), 1e-13);
        }
        y.sigma = m.s_max * P * kN;
        EXPECT_LE((law_rate(p, Rung::memory, coupling, y, nu, d).F - law_rate(p, Rung::evolution, coupling, y, nu, d).F)
                      .norm(),
                  1e-12);
      }
    }
  }
}

TEST(Memory, ShearFirstGoesWithTheElasticSlopeInAnyDirectionAfterAReversal) {
  const LawParameters<double> p = parameters();
  const double nu = 0.7, P = p.isotropic.P_star(nu);
  LawState<double> y = coaxial(P, 0.16, 0.12, 0);
  const LawDirection back{0, 1, -kN};
  const double DG = elastic(p, nu);
  EXPECT_NEAR(rate(p, y, nu, back).sigma.dot(kN), -DG, 1e-14) << "not yet turned, but treated as if";
  turn_corner(Rung::memory, y, back);
  EXPECT_NEAR(rate(p, y, nu, back).sigma.dot(kN), -DG, 1e-14);
}

TEST(Memory, ATurnTakesWhatLiesAlongTheShearAlone) {
  const LawDirection back{0, 1, -kN};
  LawState<double> y = coaxial(0.02, 0.16, 0.12, 0);
  y.sigma += 0.02 * Deviator<double>(0.02, 0.05, -0.03, 0.01, 0.04);
  y.s_r << 0.04, -0.03, 0.06, 0.01, -0.02;
  const Deviator<double> before = y.s_r;
  ASSERT_LT(reversal_value(y, back), -1e-3);
  turn_corner(Rung::memory, y, back);
  EXPECT_NEAR(reversal_value(y, back), 0, 1e-15);
  const Deviator<double> moved = y.s_r - before;
  EXPECT_LE((moved - moved.dot(kN) * kN).norm(), 1e-15);
}

// While s_r follows, the rate is that of the turned state and <s - s_r, N> = 0 stays: by central differences along the rate.
TEST(Memory, WhereItFollowsNothingIsLeftToTurn) {
  const LawParameters<double> p = parameters();
  const double nu = 0.72, h = 1e-5;
  const LawDirection direction{0.5, 1, kN};  // compression takes s down
  LawState<double> y = coaxial(p.isotropic.P_star(nu), 0.16, 0.05, 0.2);
  reverse(y, direction);
  const LawState<double> following = following_rate(law_moduli(p, nu, Rung::memory), p, y, direction);
  const auto value_at = [&](double e) {
    LawState<double> there = y;
    there.P += e * following.P;
    there.sigma += e * following.sigma;
    there.s_r += e * following.s_r;
    return reversal_value(there, direction);
  };
  ASSERT_GT(following.s_r.norm(), 0.01) << "or it would not have to follow";
  EXPECT_NEAR((value_at(h) - value_at(-h)) / (2 * h), 0, 1e-6 * following.s_r.norm());
}

TEST(Memory, StressRatioEndsOnItsLimitWhateverTheReversal) {
  // flow vanishes where s = s_b, |s_b| = s_max, s_b - s_r along N
  const LawParameters<double> p = parameters();
  const double nu = 0.7, P = p.isotropic.P_star(nu), s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  LawState<double> y{P, kZero, kZero, kZero};
  y.s_r << 0.04, -0.03, 0.06, 0.01, -0.02;
  const double along = y.s_r.dot(kN), Delta = -along + std::sqrt(along * along + s_max * s_max - y.s_r.squaredNorm());
  const Deviator<double> s_b = y.s_r + Delta * kN;
  ASSERT_NEAR(s_b.norm(), s_max, 1e-15);
  y.sigma = P * s_b;
  EXPECT_LE(rate(p, y, nu, {0, 1, kN}).sigma.norm(), 1e-15);
}

TEST(Memory, NearTheLimitNothingStiffensAndFromBeyondItComesBack) {
  LawParameters<double> p = parameters();
  p.memory.chi = 0;
  const double nu = 0.7, P = p.isotropic.P_star(nu), s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  const double DG = elastic(p, nu);
  for (const double beyond : {0.999, 1.0, 1.001, 1.3}) {
    const LawState<double> y = coaxial(P, beyond * s_max, 0.1, beyond * s_max);
    const double slope = rate(p, y, nu, {0, 1, kN}).sigma.dot(kN);
    EXPECT_NEAR(slope, DG * (1 - beyond) / kLeastDistance, 1e-12) << beyond;
  }
  // also where shear along N would miss the limit
  Deviator<double> M = kZero;
  M(3) = 1;
  ASSERT_EQ(M.dot(kN), 0);
  const LawState<double> aside{P, 1.2 * s_max * P * M, 0.1 * kN, 1.2 * s_max * M};
  EXPECT_NEAR(rate(p, aside, nu, {0, 1, kN}).sigma.dot(M), -DG * 0.2 / kLeastDistance, 1e-12);
}

TEST(Memory, FlowIsContinuousWhereTheLimitComesNear) {
  const double s_lim = 0.16, n = 3, h = 1e-9;
  for (const double distance : {kLeastDistance, 0.0}) {  // Delta over s_lim, where the formula changes
    const auto flow_at = [&](double Delta) {
      const Deviator<double> s_r = (1 - Delta) * s_lim * kN;
      return memory_flow<double>(s_r + 0.05 * s_lim * kN, s_r, kN, s_lim, n).dot(kN);
    };
    EXPECT_NEAR(flow_at(distance - h), flow_at(distance + h), 1e-6) << distance;
  }
}

TEST(Memory, PressureGoesToItsShearedLevel) {
  // At s = s_max, F = F_max all terms but the relaxation vanish: dP = k (P_D2 - P) de.
  LawParameters<double> p = parameters();
  p.memory.chi = 0;
  const double nu = 0.69, P = p.isotropic.P_star(nu), s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  const LawState<double> y = coaxial(P, s_max, p.fabric_max.value(nu, p.shear_nu_c), 0);
  EXPECT_NEAR(rate(p, y, nu, {0, 1, kN}).P, 16.5 * (p.steady.P_star(nu) - P), 1e-14);
}

TEST(Memory, BulkModulusIsThatOfTheReferenceAtThePressure) {
  // nu_P to first order: second order in P - P_iso. Below jamming the tangent: finite at any nu while P > 0.
  const LawParameters<double> p = parameters();
  const LawDirection iso = law_direction(direction_of(Mode::ISO));
  for (const double nu : {0.67, 0.7, 0.8}) {
    for (const double shift : {1e-3, 1e-4}) {
      const double nu_P = nu * (1 + shift);
      const LawState<double> y{p.isotropic.P_star(nu_P), kZero, kZero, kZero};
      const double curvature = 40;  // of B over nu at .67, the largest, in B/nu^2
      EXPECT_NEAR(rate(p, y, nu, iso).P / 3, p.isotropic.B_star(nu_P), curvature * shift * shift) << nu;
    }
  }
  const LawState<double> y{1e-3, kZero, kZero, kZero};
  for (const double nu : {0.66, p.isotropic.pressure.nu_c, 0.6}) {
    const double B = rate(p, y, nu, iso).P / 3;
    EXPECT_GT(B, 0.2) << nu;
    EXPECT_LT(B, 0.3) << nu;
  }
}

TEST(Memory, OtherScalarGivesTheSameRate) {
  const LawParameters<double> p = parameters();
  LawState<double> y = coaxial(0.021, 0.08, 0.05, -0.03, 0.4);
  y.sigma(2) += 3e-4;
  const LawDirection d = law_direction(direction_of(Mode::UNI));
  const auto q = cast<long double>(p);
  const LawState<long double> wide{y.P, y.sigma.cast<long double>(), y.F.cast<long double>(), y.s_r.cast<long double>(),
                                   y.E.cast<long double>()};
  const auto a = rate(p, y, 0.7, d);
  const auto b = law_rate(q, Rung::memory, Coupling::energy, wide, 0.7, d);
  EXPECT_NEAR(a.P, static_cast<double>(b.P), 1e-13 * std::abs(a.P));
  EXPECT_LE((a.sigma - b.sigma.cast<double>()).norm(), 1e-13 * a.sigma.norm());
  EXPECT_LE((a.F - b.F.cast<double>()).norm(), 1e-13 * a.F.norm());
  EXPECT_LE((a.E - b.E.cast<double>()).norm(), 1e-13 * a.E.norm());
}

TEST(Memory, DirectionOfShearIsRememberedOverItsStrain) {
  // strain_memory() is the solution of dE = (N - E) de/eps_E on a straight segment, <E,N> from -1 to 1.
  const LawParameters<double> p = parameters();
  LawDirection d = law_direction(direction_of(Mode::UNI));
  const Deviator<double> after = strain_memory(-d.N, d, 0.2), h_after = strain_memory(-d.N, d, 0.2 + 1e-6),
                         h_before = strain_memory(-d.N, d, 0.2 - 1e-6);
  LawState<double> y = coaxial(p.isotropic.P_star(0.7), 0.1, 0.05, 0);
  y.E = after;
  EXPECT_LE((rate(p, y, 0.7, d).E - (h_after - h_before) / 2e-6).norm(), 1e-8);
  EXPECT_LE((strain_memory(kZero, d, 100) - d.N).norm(), 1e-12);
  EXPECT_EQ(strain_memory(after, law_direction(direction_of(Mode::ISO)), 0.3), after) << "no shear, nothing forgotten";
  y.E = after;
  EXPECT_TRUE(rate(p, y, 0.7, law_direction(direction_of(Mode::ISO))).E.isZero(0));
}

TEST(Memory, AfterLongShearAReversalSoftensSooner) {
  // n = 1 + (m - 1)(1 + <E,N>)^2: from 1 where all of memory lies behind, through m at none, to 1 + 4 (m - 1).
  const LawParameters<double> p = parameters();
  const double nu = 0.7, P = p.steady.P_star(nu), F = p.fabric_max.value(nu, p.shear_nu_c);
  const double s_max = p.stress_ratio_max.value(nu, p.shear_nu_c);
  const auto S = [&](double E) {  // half-way from s_r = 0 to the limit of a packing at its sheared pressure
    return rate(p, coaxial(P, s_max / 2, F, 0, E), nu, {0, 1, kN}).sigma.dot(kN) /
           rate(p, coaxial(P, 0, F, 0, E), nu, {0, 1, kN}).sigma.dot(kN);
  };
  EXPECT_NEAR(S(-1), 1 - 0.5, 1e-14);
  EXPECT_NEAR(S(0), 1 - std::pow(0.5, 2), 1e-14);
  EXPECT_NEAR(S(1), 1 - std::pow(0.5, 5), 1e-14);
}

TEST(Memory, CompressionDilutesOnlyWhatDoesNotFollowStressAtOnce) {
  const LawParameters<double> p = parameters();
  const double nu = 0.7, P = p.isotropic.P_star(nu);
  const double r = p.fabric_max.value(nu, p.shear_nu_c) / p.stress_ratio_max.value(nu, p.shear_nu_c);
  const LawDirection iso = law_direction(direction_of(Mode::ISO));
  EXPECT_LE(rate(p, coaxial(P, 0.1, 0.6 * r * 0.1, 0), nu, iso).F.norm(), 1e-15);
  EXPECT_NEAR(rate(p, coaxial(P, 0.1, r * 0.1, 0), nu, iso).F.dot(kN), -12 * r * 0.1 * 3, 1e-14) << "in proportion";
}

}  // namespace
}  // namespace grainlaw
