#include "fit/published/verdicts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fit/staged_laws.hpp"
#include "model/student.hpp"

namespace grainlaw::fit {
namespace {

/// The published laws of `mode`, the parameters of `groups` with errors of this part of them.
Calibration published(const std::string& mode, const std::vector<std::string>& groups, double part = 0.01) {
  Calibration c = nothing_known();
  c.law.parameters = published_parameters(mode);
  c.law.range.nu_min = 0.69;
  c.law.range.nu_max = 0.81;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const std::string name = parameter_table()[i].name;
    if (std::find(groups.begin(), groups.end(), name.substr(0, name.find('.'))) == groups.end()) continue;
    const double value = *fields(c.law.parameters)[i], error = part * std::max(value, 0.1);
    c.law.estimates[i] = {value, error, Status::fitted, ""};
    c.law.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = error * error;
  }
  return c;
}

const Verdict& find(const std::vector<Verdict>& all, const std::string& mode, const std::string& quantity) {
  const auto at =
      std::find_if(all.begin(), all.end(), [&](const Verdict& v) { return v.mode == mode && v.quantity == quantity; });
  if (at == all.end()) throw std::logic_error(mode + " " + quantity);
  return *at;
}

TEST(Verdicts, AgreeWithinTheRangeOfStudentsT) {
  const std::size_t packings = 5;
  const double limit = student_95(4) * std::sqrt(6.0);
  for (const double errors : {0.0, 0.99 * limit, -0.99 * limit, 1.01 * limit, -1.01 * limit}) {
    Calibration c = published("", {"coordination"});
    const std::size_t i = parameter_index("coordination.C1");
    c.law.estimates[i].value += errors * c.law.estimates[i].standard_error;
    const Verdict v = find(verdicts_of(c.law, {}, packings), "ISO", "coordination.C1");
    EXPECT_NEAR(v.distance, errors / std::sqrt(6.0), 1e-9);
    EXPECT_EQ(v.verdict, std::abs(errors) < limit ? "agrees" : "differs") << errors;
  }
}

TEST(Verdicts, AnIntervalWiderThanWhatMattersAgreesWithNothing) {
  const std::size_t i = parameter_index("coordination.nu_c");
  const double half = difference_that_matters("coordination.nu_c", {}, 0.6646) / (student_95(4) * std::sqrt(6.0));
  for (const auto& [error, verdict] : {std::pair{0.99 * half, "agrees"}, {1.01 * half, "inconclusive"}}) {
    Calibration c = published("", {"coordination"});
    c.law.estimates[i].standard_error = error;
    EXPECT_EQ(find(verdicts_of(c.law, {}, 5), "ISO", "coordination.nu_c").verdict, verdict);
    c.law.estimates[i].value += 0.01;  // four times what matters
    EXPECT_EQ(find(verdicts_of(c.law, {}, 5), "ISO", "coordination.nu_c").verdict, "differs");
    c.law.estimates[i].degrees_of_freedom = 40;  // of a moderated error
    EXPECT_NEAR(find(verdicts_of(c.law, {}, 5), "ISO", "coordination.nu_c").range,
                student_95(40) * std::sqrt(6.) * error, 1e-12);
  }
}

TEST(Verdicts, WhatMattersIsSaidOfEveryNumber) {
  const Calibration c = published(
      "", {"coordination", "rattlers", "pressure", "steady_coordination", "steady_rattlers", "steady_pressure",
           "overlap", "fabric", "stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate"});
  for (const Verdict& v : verdicts_of(c.law, {}, 5)) {
    EXPECT_GT(v.matters, 0) << v.quantity;
    EXPECT_LE(v.matters, v.nu ? 0.35 * v.published : std::max(0.3 * v.published, 10.)) << v.quantity;
  }
  EXPECT_NEAR(difference_that_matters("P_star", 0.70, 0.016), 0.02 * 0.016, 1e-15);
  EXPECT_NEAR(difference_that_matters("steady_C_star", 0.68, 6), 0.12, 1e-15);
  EXPECT_NEAR(difference_that_matters("rattler_fraction", 0.80, 0.01), 0.0015, 1e-15);
}

TEST(Verdicts, SayWhatCannotBeJudged) {
  Calibration c = published("", {"coordination"});
  c.law.estimates[parameter_index("coordination.alpha")].standard_error = std::nan("");
  const std::vector<Verdict> all = verdicts_of(c.law, {}, 5);
  EXPECT_EQ(find(all, "ISO", "coordination.alpha").verdict, "no error");
  EXPECT_EQ(find(all, "ISO", "pressure.p0").verdict, "not identified");
  EXPECT_TRUE(std::isnan(find(all, "ISO", "pressure.p0").ours));
  for (const Verdict& v : verdicts_of(c.law, {}, 1)) EXPECT_NE(v.verdict, "agrees") << v.quantity;
}

TEST(Verdicts, AParameterOnItsBoundHasNoDistance) {
  Calibration c = published("", {"coordination"});
  Estimate& bound = c.law.estimates[parameter_index("coordination.alpha")];
  bound.standard_error = 0;
  bound.value *= 1.5;
  const Verdict v = find(verdicts_of(c.law, {}, 5), "ISO", "coordination.alpha");
  EXPECT_TRUE(std::isnan(v.distance)) << "a number that no file could hold: " << v.distance;
  EXPECT_EQ(v.verdict, "no error");
}

TEST(Verdicts, SpheresOfAnotherMaterialAreNotJudgedByThePapersNumbers) {
  ModeComparison compared;
  compared.verdicts = verdicts_of(published("", {"coordination"}).law, {}, 5);
  const double none = std::nan("");
  compared.claims = {{"Eq. 19", "a number", none, 0.2, 0.01, 0.137, "differs", 0.0137},
                     {"Fig. 7", "a sign", none, 0.2, 0.01, none, "agrees"},
                     {"Fig. 15", "the same", none, 0.2, 0.01, 0, "differs", 0.01},
                     {"Table 1", "kinematics", none, 1.5, 0, 1.5, "identity"}};
  std::vector<TestRecord> tests(1);
  for (const double width : {0., 3.}) {  // of 0 nothing is known
    tests[0].packing.size_width = width;
    ModeComparison same = compared;
    set_aside_other_material(same, tests);
    EXPECT_EQ(find(same.verdicts, "ISO", "coordination.C1").verdict, "agrees") << width;
    EXPECT_EQ(same.claims[0].verdict, "differs") << width;
  }
  std::vector<TestRecord> rough = tests, narrow = tests;
  rough[0].packing.contacts.friction = 0.1;
  narrow[0].packing.size_width = 1;
  for (const std::vector<TestRecord>& others : {rough, narrow}) {
    ModeComparison set_aside = compared;
    set_aside_other_material(set_aside, others);
    for (const Verdict& v : set_aside.verdicts) EXPECT_EQ(v.verdict, "another material") << v.quantity;
    std::vector<std::string> claims;
    for (const Claim& claim : set_aside.claims) claims.push_back(claim.verdict);
    EXPECT_EQ(claims, (std::vector<std::string>{"another material", "agrees", "differs", "identity"}));
  }
}

TEST(Verdicts, RangesAreOfThePackingsAndDegreesOfFreedomOfEachFit) {
  std::vector<Description> modes{{"UNI", published("UNI", {"coordination"})}};
  modes[0].calibration.size.packings = 2;
  Calibration c = published("", {"coordination"});
  const std::size_t i = parameter_index("coordination.C1");
  c.law.estimates[i].degrees_of_freedom = 1.5;  // two of its five packings nearly alone say it
  const std::vector<Verdict> all = verdicts_of(c.law, modes, 5);
  const Verdict iso = find(all, "ISO", "coordination.C1"), uni = find(all, "UNI", "coordination.C1");
  EXPECT_NEAR(iso.range, student_95(1.5) * std::sqrt(6.) * iso.standard_error, 1e-12);
  EXPECT_NEAR(uni.range, student_95(1) * std::sqrt(3.) * uni.standard_error, 1e-12);
}

TEST(Verdicts, EachModeHasTheNumbersOfItsOwnRow) {
  std::vector<Description> modes{
      {"UNI", published("UNI", {"coordination", "rattlers", "pressure"}, 1e-5)},
      {"D3", published("D3", {"steady_coordination", "steady_rattlers", "steady_pressure", "fabric_max"}, 1e-5)}};
  for (Description& d : modes) d.calibration.size.packings = 5;
  const std::vector<Verdict> all =
      verdicts_of(published("", {"coordination", "steady_coordination", "stress_rate"}, 1e-5).law, modes, 5);
  EXPECT_EQ(find(all, "UNI", "coordination.C1").published, 8.37);
  EXPECT_EQ(find(all, "D3", "steady_pressure.nu_c").published, 0.6583);
  EXPECT_EQ(find(all, "ISO", "coordination.C1").published, 8.2720);
  EXPECT_EQ(find(all, "D2", "steady_coordination.C1").published, 7.9219);
  EXPECT_EQ(find(all, "D3", "fabric_max.Q_c").published, 0.1694);
  // curves at the densities that the rows reach, and only of laws that are known
  std::vector<double> densities;
  for (const Verdict& v : all) {
    if (v.nu && v.mode == "UNI" && v.quantity == "P_star") densities.push_back(*v.nu);
    EXPECT_TRUE(!v.nu || v.verdict == "agrees") << v.mode << v.quantity;
  }
  EXPECT_EQ(densities, (std::vector<double>{0.70, 0.74, 0.80}));
  EXPECT_THROW(find(all, "UNI", "steady_coordination.C1"), std::logic_error);
  EXPECT_THROW(find(all, "D3", "coordination.C1"), std::logic_error);
}

TEST(Verdicts, WhatNoDataTellIsNotJudged) {
  Calibration c = published("", {"coordination", "rattlers", "pressure"});
  for (const char* name : {"coordination.C1", "coordination.alpha", "rattlers.phi_c", "rattlers.phi_v"})
    c.law.estimates[parameter_index(name)].status = Status::fixed;  // as published, no row counts contacts
  c.law.estimates[parameter_index("coordination.nu_c")].status = Status::tied;
  const std::vector<Verdict> all = verdicts_of(c.law, {}, 5);
  for (const Verdict& v : all)
    EXPECT_TRUE(v.verdict == "not identified" || v.quantity.starts_with("pressure.") || v.quantity == "P_star")
        << v.quantity << " agrees with itself";
  EXPECT_NO_THROW(find(all, "ISO", "pressure.nu_c"));
  EXPECT_NO_THROW(find(all, "ISO", "P_star"));
}

TEST(Verdicts, ShearFromLoadingIsJudgedByItsOwnMode) {
  EXPECT_EQ(published_parameters("D3-loading").steady.pressure.nu_c, published_parameters("D3").steady.pressure.nu_c);
  EXPECT_NE(published_parameters("D3-loading").steady.pressure.nu_c, published_parameters("D2").steady.pressure.nu_c);
}

}  // namespace
}  // namespace grainlaw::fit
