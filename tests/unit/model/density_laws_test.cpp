// Expected numbers are the published ones (Tables 2 and 3) as evaluated, to their printed digits, in equations.md 5.1 and 6,
// and derivatives by extrapolated differences.

#include "model/density_laws.hpp"

#include <gtest/gtest.h>

#include <array>

#include "model/parameters.hpp"
#include "tests/support/derivative_check.hpp"

namespace grainlaw {
namespace {

using Row = std::array<double, 8>;  // C1, alpha, nu_c | phi_c, phi_v | p0, gamma_p, nu_c
constexpr Row kUni{8.3700, .5998, .6625, .1507, 15.6835, .04006, .03270, .6619};
constexpr Row kD3{7.9289, .5764, .6603, .1327, 14.6813, .03899, .02819, .6583};

StateLaw<double> law(const Row& r) { return {{r[0], r[1], r[2]}, {r[3], r[4]}, {r[5], r[6], r[7]}}; }
StateLaw<double> iso() { return published_parameters().isotropic; }
StateLaw<double> d2() { return published_parameters().steady; }

TEST(DensityLaws, CorrectedCoordinationNumber) {
  EXPECT_NEAR(law(kUni).coordination.C_star(0.82), 9.536, 5e-4);
  constexpr double nu[] = {.82, .80, .74, .70, .68, .67}, expected[] = {9.554, 9.280, 8.334, 7.504, 6.927, 6.504};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(iso().coordination.C_star(nu[i]), expected[i], 5.1e-4) << nu[i];
}

TEST(DensityLaws, RattlerFraction) {
  constexpr double nu[] = {.82, .80, .74, .70, .68, .67}, expected[] = {.0030, .0048, .0200, .0521, .0841, .1069};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(iso().rattlers.fraction(nu[i], iso().coordination.nu_c), expected[i], 5.1e-5) << nu[i];
  }
}

TEST(DensityLaws, CoordinationNumberLeavesTheRattlersOut) {
  const auto s = iso();
  for (const double nu : {0.5, 0.66, 0.7, 0.9}) {
    EXPECT_EQ(s.C(nu), (1 - s.rattlers.fraction(nu, s.coordination.nu_c)) * s.coordination.C_star(nu));
  }
}

TEST(DensityLaws, PressureOfTable2) {
  constexpr double nu[] = {.68, .70, .74, .80, .82};
  constexpr double expected[4][5] = {{.00607, .01602, .04031, .08477, .10142},
                                     {.00694, .01664, .04037, .08394, .10029},
                                     {.00846, .01821, .04165, .08418, .10006},
                                     {.00841, .01818, .04168, .08437, .10032}};
  const std::array<StateLaw<double>, 4> modes{iso(), law(kUni), d2(), law(kD3)};
  for (std::size_t mode = 0; mode < 4; ++mode) {
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_NEAR(modes[mode].P_star(nu[i]), expected[mode][i], 5.1e-6) << "mode " << mode << ", nu " << nu[i];
    }
  }
}

TEST(DensityLaws, BulkModulusPrinted) {
  constexpr double nu[] = {.68, .70, .74, .78, .82};
  constexpr double expected_iso[] = {.306, .378, .494, .597, .700}, expected_d2[] = {.304, .368, .474, .571, .667};
  for (std::size_t i = 0; i < 5; ++i) {
    // Two were rounded twice: .49346 to .4935 to .494, and .57049.
    EXPECT_NEAR(iso().B_star(nu[i]), expected_iso[i], 5.5e-4) << nu[i];
    EXPECT_NEAR(d2().B_star(nu[i]), expected_d2[i], 5.5e-4) << nu[i];
  }
}

TEST(DensityLaws, BulkModulusIsTheDerivativeOfThePressure) {
  for (const auto& s : {iso(), law(kUni), d2(), law(kD3)}) {
    for (double nu = 0.67; nu < 0.895; nu += 0.005) {
      const auto P = [&](double x) { return s.P_star(nu * std::exp(x)); };
      EXPECT_LE(testing::derivative_error(P, s.B_star(nu), 0.0, 2e-3), 1e-8) << nu;
    }
  }
}

TEST(DensityLaws, BulkModulusAtJamming) {
  // p0 C0 (1 - phi_c), where both nu_c are the same
  for (auto s : {iso(), law(kUni), d2()}) {
    s.pressure.nu_c = s.coordination.nu_c;
    const double limit = s.pressure.p0 * kIsostaticCoordination * (1 - s.rattlers.phi_c);
    EXPECT_NEAR(s.B_star(s.pressure.nu_c * (1 + 1e-14)) / limit, 1, 1e-6);
  }
}

TEST(DensityLaws, BelowJamming) {
  for (const double nu : {0.1, 0.5, 0.6649, 0.66489}) {
    EXPECT_EQ(iso().P_star(nu), 0) << nu;
    EXPECT_EQ(iso().B_star(nu), 0) << nu;
  }
  EXPECT_EQ(iso().coordination.C_star(0.6), 6);
  EXPECT_EQ(iso().coordination.C_star(0.6646), 6);
}

TEST(DensityLaws, Table3) {
  const auto p = published_parameters();
  constexpr double nu[] = {.6653, .680, .695, .700, .728, .740, .780, .820};
  constexpr double s_max[] = {.2054, .1907, .1781, .1744, .1572, .1514, .1371, .1282};
  constexpr double beta_s[] = {87.76, 70.03, 57.61, 54.42, 42.40, 39.34, 33.88, 31.89};
  constexpr double F_max[] = {.1694, .1532, .1382, .1335, .1102, .1015, .0772, .0586};
  constexpr double beta_F[] = {57.89, 51.42, 45.56, 43.76, 34.91, 31.69, 22.95, 16.62};
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(p.stress_ratio_max.value(nu[i], p.shear_nu_c), s_max[i], 5.1e-5) << nu[i];
    EXPECT_NEAR(p.stress_rate.value(nu[i], p.shear_nu_c), beta_s[i], 5.1e-3) << nu[i];
    EXPECT_NEAR(p.fabric_max.value(nu[i], p.shear_nu_c), F_max[i], 5.1e-5) << nu[i];
    EXPECT_NEAR(p.fabric_rate.value(nu[i], p.shear_nu_c), beta_F[i], 5.1e-3) << nu[i];
  }
}

TEST(DensityLaws, InitialShearStiffnessRisesWithDensityItsRatioToPressureFalls) {
  const auto p = published_parameters();
  constexpr double nu[] = {.68, .70, .74, .78, .82}, expected[] = {.113, .173, .248, .321, .409};  // D2's pressure
  double ratio_before = 1e9;
  for (std::size_t i = 0; i < 5; ++i) {
    const double ratio = p.stress_rate.value(nu[i], p.shear_nu_c) * p.stress_ratio_max.value(nu[i], p.shear_nu_c);
    EXPECT_NEAR(ratio * p.steady.P_star(nu[i]), expected[i], 5.1e-4) << nu[i];
    EXPECT_LT(ratio, ratio_before);
    ratio_before = ratio;
  }
}

}  // namespace
}  // namespace grainlaw
