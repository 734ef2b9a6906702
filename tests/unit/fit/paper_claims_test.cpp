#include "fit/published/paper_claims.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "fit/staged_laws.hpp"
#include "model/student.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kSteadyFrom = 0.15;
constexpr double kSize = 0.3;  // logarithmic strain of z

/// A D2 or D3 test of packing `seed` at .70: C* and P* go from their first to their steady value, s and F are steady.
TestRecord shear(Mode mode, Branch branch, std::uint64_t seed, double C_first, double C_steady, double P_first,
                 double P_steady, double s, double F) {
  TestRecord test;
  test.name = to_string(mode) + to_string(branch) + std::to_string(seed);
  test.role = mode == Mode::D2 && branch == Branch::unloading ? Role::calibration : Role::description;
  test.path.nu = 0.70;
  test.path.branch = branch;
  test.path.segments.resize(1);
  test.path.segments.front().mode = mode;
  test.packing.seed = seed;
  const double other = mode == Mode::D3 ? 0.5 : 1;
  test.path.segments.front().direction.tensor.diagonal() << other, 1 - other, -1;
  for (const double e : {0.0, 0.05, 0.1, 0.2, kSize}) {
    Observation row;
    row.strain.tensor(2, 2) = -e;
    row.strain.tensor(0, 0) = other * e;
    row.strain.tensor(1, 1) = (1 - other) * e;
    row.eps_dev = (mode == Mode::D3 ? 1.5 : std::numbers::sqrt3) * e;
    row.shape_strain = mode == Mode::D3 ? 1 : 0;
    row.lode_strain = mode == Mode::D3 ? 60 : 30;
    const bool steady = row.eps_dev >= kSteadyFrom;
    row.nu = 0.70;
    row.C_star = steady ? C_steady : C_first;
    row.P_star = steady ? P_steady : P_first;
    row.s_par = s;
    row.F_par = F;
    test.rows.push_back(row);
  }
  return test;
}

const Claim& find(const std::vector<Claim>& all, const std::string& statement) {
  const auto at = std::find_if(all.begin(), all.end(), [&](const Claim& c) { return c.statement == statement; });
  if (at == all.end()) throw std::logic_error(statement);
  return *at;
}

TEST(PaperClaims, ASignIsDecidedByItsRangeOnly) {
  const double t = student_95(4);
  for (const auto& [ours, verdict] :
       {std::pair{1.01 * t, "agrees"}, {0.99 * t, "undecided"}, {-0.99 * t, "undecided"}, {-1.01 * t, "differs"}}) {
    Claim c{"", "", 0, ours, 1, 0, ""};
    judge(c, {}, 5);
    EXPECT_EQ(c.verdict, verdict) << ours;
    EXPECT_TRUE(std::isnan(c.published));
  }
}

TEST(PaperClaims, APrintedValueMayBeOffByItsScatterAndHalfADigit) {
  const double reach = student_95(4) * std::sqrt(6.0) * 0.01 + 0.05;
  for (const double off : {0.99 * reach, -0.99 * reach, 1.01 * reach, -1.01 * reach}) {
    Claim c{"", "", 0, 9.5 + off, 0.01, 0, ""};
    judge(c, {9.5, 0.05, 1.01 * reach}, 5);
    EXPECT_EQ(c.verdict, std::abs(off) < reach ? "agrees" : "differs") << off;
    judge(c, {9.5, 0.05, 0.99 * reach}, 5);
    EXPECT_EQ(c.verdict, std::abs(off) < reach ? "inconclusive" : "differs") << "a range wider than what matters";
  }
}

TEST(PaperClaims, ExactKinematicsNeedsNoScatter) {
  for (const auto& [ours, verdict] : {std::pair{1.5 + 1e-7, "identity"}, {1.5 + 1e-5, "differs"}}) {
    Claim c{"", "", 0, ours, std::nan(""), 0, ""};
    judge(c, {1.5, 0}, 1);
    EXPECT_EQ(c.verdict, verdict);
  }
}

TEST(PaperClaims, OnePackingDecidesNothing) {
  Claim sign{"", "", 0, 1, 0.001, 0, ""}, equal = sign;
  judge(sign, {}, 1);
  judge_equal(equal, 1, 1);
  EXPECT_EQ(sign.verdict, "no error");
  EXPECT_EQ(equal.verdict, "no error");
}

TEST(PaperClaims, EqualSidesAgreeOnlyIfADifferenceThatMattersWouldShow) {
  const double range = student_95(4) * 0.01;
  for (const auto& [ours, matters, verdict] : {std::tuple{0.9 * range, 1.1 * range, "agrees"},
                                               {0.9 * range, 0.9 * range, "inconclusive"},
                                               {1.1 * range, 9 * range, "differs"}}) {
    Claim c{"", "", 0, ours, 0.01, 0, ""};
    judge_equal(c, matters, 5);
    EXPECT_EQ(c.verdict, verdict);
  }
}

TEST(PaperClaims, BranchesAndModesAreComparedPackingByPacking) {
  // packings differ by far more than the branches and modes do
  std::vector<TestRecord> tests;
  const double C[] = {7.4, 7.6, 7.9, 8.2}, jitter[] = {0.001, -0.001, 0.0012, -0.0009};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const double c = C[seed - 1], j = jitter[seed - 1];
    tests.push_back(shear(Mode::D2, Branch::unloading, seed, c, c + 0.2, 0.016, 0.018, 0.17, 0.13));
    tests.push_back(shear(Mode::D2, Branch::loading, seed, c + 0.01 + j, c + 0.2 + j, 0.020, 0.018, 0.17, 0.13));
    tests.push_back(shear(Mode::D3, Branch::unloading, seed, c, c + 0.2, 0.016, 0.018, 0.17 + j, 0.12 + j));
  }
  const std::vector<Claim> claims = claims_of(tests, nothing_known(), {}, kSteadyFrom);
  const Claim& before = find(claims, "C* before shear: loading branch above unloading branch");
  EXPECT_NEAR(before.ours, 0.010075, 1e-9);
  EXPECT_EQ(before.verdict, "agrees");
  EXPECT_EQ(find(claims, "steady C* in D2: the same from both branches (difference)").verdict, "agrees");
  EXPECT_EQ(find(claims, "P* in D2 from the unloading branch: rises at the lowest density").verdict, "agrees");
  EXPECT_EQ(find(claims, "P* in D2 from the loading branch: falls at the lowest density").verdict, "agrees");
  EXPECT_EQ(find(claims, "steady s: D3 as D2 (difference)").verdict, "agrees");
  const Claim& fabric = find(claims, "steady F: D3 as D2 (difference)");
  EXPECT_EQ(fabric.verdict, "differs");
  EXPECT_NEAR(fabric.ours, -0.01 + 7.5e-5, 1e-9);
  EXPECT_NEAR(fabric.nu, 0.70, 1e-12);
  EXPECT_EQ(find(claims, "D3: deviatoric strain over the largest compression").verdict, "identity");
  EXPECT_NEAR(find(claims, "D2: deviatoric strain over the largest compression").ours, std::numbers::sqrt3, 1e-12);
  EXPECT_EQ(find(claims, "D2: Lode angle of strain [deg]").verdict, "identity");
}

TEST(PaperClaims, JammingDensitiesAreOrdered) {
  Calibration c = nothing_known();
  c.law.parameters = published_parameters("ISO");
  c.law.parameters.anisotropy.a2 = 1.18;
  c.law.range.nu_min = 0.68;
  c.law.range.nu_max = 0.82;
  Description uni{"UNI", nothing_known()}, d3{"D3", nothing_known()};
  uni.calibration.law.parameters = published_parameters("UNI");
  d3.calibration.law.parameters = published_parameters("D3");
  const auto know = [](Calibration& calibration, double error) {
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      calibration.law.estimates[i] = {*fields(calibration.law.parameters)[i], error, Status::fitted, ""};
      calibration.law.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = error * error;
    }
  };
  for (Calibration* of : {&c, &uni.calibration, &d3.calibration}) of->size.packings = 5;
  for (const auto& [error, verdict] : {std::pair{1e-5, "agrees"}, {1e-2, "undecided"}}) {
    know(c, error);
    know(uni.calibration, error);
    know(d3.calibration, error);
    const std::vector<Claim> claims = claims_of({}, c, {uni, d3}, kSteadyFrom);
    const Claim& order = find(claims, "nu_c of P*: ISO above UNI");
    EXPECT_NEAR(order.ours, 0.6649 - 0.6619, 1e-12);
    EXPECT_NEAR(order.standard_error, error * std::numbers::sqrt2, 1e-3 * error);
    const Claim& coupling = find(claims, "A2*/F_dev, the row of deviatoric stress; the paper has one A");
    EXPECT_NEAR(coupling.ours, c.law.parameters.anisotropy.a2 * c.law.parameters.isotropic.B_star(0.74), 1e-12);
    EXPECT_EQ(coupling.verdict, "differs");
    for (const char* statement : {"nu_c of P*: ISO above UNI", "nu_c of P*: UNI above D2", "nu_c of C*: ISO above D2"})
      EXPECT_EQ(find(claims, statement).verdict, verdict) << statement;
  }
  // of a mode that was run on one packing there is no error, however many the others have
  know(c, 1e-5);
  know(uni.calibration, 1e-5);
  uni.calibration.size.packings = 1;
  const std::vector<Claim> claims = claims_of({}, c, {uni, d3}, kSteadyFrom);
  EXPECT_EQ(find(claims, "nu_c of P*: ISO above UNI").verdict, "no error");
  EXPECT_EQ(find(claims, "nu_c of C*: ISO above D2").verdict, "agrees");
}

}  // namespace
}  // namespace grainlaw::fit
