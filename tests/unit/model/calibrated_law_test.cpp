#include "model/calibrated_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "model/density_curves.hpp"
#include "model/student.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw {
namespace {

using testing::refusal;

/// Every parameter has a value; none has an error.
CalibratedLaw complete() {
  CalibratedLaw law;
  law.parameters = published_parameters();
  law.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
  for (std::size_t i = 0; i < kParameterCount; ++i)
    law.estimates[i] = {*fields(law.parameters)[i], std::nan(""), Status::fitted, ""};
  return law;
}

void forget(CalibratedLaw& law, const std::string& name) {
  law.estimates[parameter_index(name)] = {std::nan(""), std::nan(""), Status::not_identified, "not in these data"};
}

/// The rungs that a law without `name` serves.
std::set<Rung> rungs_without(const std::string& name, Coupling coupling) {
  CalibratedLaw law = complete();
  law.coupling = coupling;
  forget(law, name);
  std::set<Rung> served;
  for (const Rung rung : kRungs) {
    const auto missing = missing_parameter(law, rung);
    if (!missing)
      served.insert(rung);
    else
      EXPECT_EQ(parameter_table()[*missing].name, name);
  }
  return served;
}

TEST(CalibratedLaw, EachRungLacksWhatItsEquationsRead) {
  using Rungs = std::set<Rung>;
  const Rungs all{kRungs.begin(), kRungs.end()}, none{};
  // Eqs. (11), (12), (14) of ISO and Eq. (20): by all of them
  for (const char* name :
       {"coordination.C1", "rattlers.phi_v", "pressure.nu_c", "shear.nu_c", "stress_ratio_max.Q_limit"})
    EXPECT_EQ(rungs_without(name, Coupling::energy), none) << name;
  EXPECT_EQ(rungs_without("fabric_max.alpha", Coupling::energy),
            Rungs{Rung::reduced});  // whose P* and s need no fabric
  EXPECT_EQ(rungs_without("stress_rate.Q_c", Coupling::energy), Rungs{Rung::memory})
      << "which has G and lambda for rates";
  EXPECT_EQ(rungs_without("fabric_rate.Q_limit", Coupling::energy), (Rungs{Rung::reduced, Rung::memory}));
  for (const char* name :
       {"steady_coordination.alpha", "steady_rattlers.phi_c", "steady_pressure.p0", "memory.G", "memory.m"})
    EXPECT_EQ(rungs_without(name, Coupling::energy), (Rungs{Rung::reduced, Rung::evolution})) << name;
  // one coefficient of anisotropy, by the coupling; none of it by the reduced law
  EXPECT_EQ(rungs_without("anisotropy.a2", Coupling::energy), (Rungs{Rung::reduced, Rung::memory}));
  EXPECT_EQ(rungs_without("anisotropy.a2", Coupling::single), all);
  EXPECT_EQ(rungs_without("anisotropy.a0", Coupling::single), (Rungs{Rung::reduced, Rung::memory}));
  EXPECT_EQ(rungs_without("anisotropy.a0", Coupling::energy), all);
  for (const char* name : {"overlap.D", "fabric.g3", "anisotropy.a1"})
    EXPECT_EQ(rungs_without(name, Coupling::energy), all) << name;
}

TEST(CalibratedLaw, TheCalibratedRungsAreThoseThatLackNothing) {
  using Rungs = std::vector<Rung>;
  CalibratedLaw law = complete();
  EXPECT_EQ(calibrated_rungs(law), (Rungs{Rung::reduced, Rung::evolution, Rung::memory}));
  forget(law, "memory.k");
  EXPECT_EQ(calibrated_rungs(law), (Rungs{Rung::reduced, Rung::evolution}));
  forget(law, "anisotropy.a2");
  EXPECT_EQ(calibrated_rungs(law), Rungs{Rung::reduced});
  forget(law, "pressure.p0");
  EXPECT_TRUE(calibrated_rungs(law).empty());
  EXPECT_TRUE(calibrated_rungs(CalibratedLaw{}).empty());
}

TEST(CalibratedLaw, RungsThatLackTheSameAreNamedInOneLine) {
  using Lines = std::vector<std::string>;
  CalibratedLaw law = complete();
  EXPECT_EQ(left_out_rungs(law), Lines{});
  forget(law, "memory.k");
  const std::string memory = "memory left out: parameters.memory.k is not identified: not in these data";
  EXPECT_EQ(left_out_rungs(law), Lines{memory});
  forget(law, "anisotropy.a2");
  EXPECT_EQ(left_out_rungs(law),
            (Lines{"evolution left out: parameters.anisotropy.a2 is not identified: not in these data", memory}));
  forget(law, "fabric_max.Q_c");
  EXPECT_EQ(left_out_rungs(law),
            Lines{"evolution, memory left out: parameters.fabric_max.Q_c is not identified: not in these data"});
}

TEST(CalibratedLaw, NoDecayIsNeededWithoutAnExponential) {
  CalibratedLaw law = complete();
  forget(law, "fabric_max.alpha");
  EXPECT_EQ(missing_parameter(law, Rung::evolution), parameter_index("fabric_max.alpha"));
  law.parameters.fabric_max.Q_c = 0;
  EXPECT_FALSE(missing_parameter(law, Rung::evolution).has_value());
  forget_unknown_fabric(law);
  EXPECT_TRUE(knows_fabric(law.parameters));
  forget(law, "fabric_max.Q_c");  // its value must not be read
  EXPECT_EQ(missing_parameter(law, Rung::evolution), parameter_index("fabric_max.Q_c"));
  forget_unknown_fabric(law);
  EXPECT_FALSE(knows_fabric(law.parameters));
}

TEST(CalibratedLaw, ARefusalNamesTheParameterAndWhy) {
  CalibratedLaw law = complete();
  EXPECT_EQ(refusal([&] { require_parameters(law, Rung::memory, "p.json"); }), "accepted");
  forget(law, "memory.G");
  EXPECT_EQ(refusal([&] { require_parameters(law, Rung::evolution, "p.json"); }), "accepted");
  EXPECT_EQ(
      refusal([&] { require_parameters(law, Rung::memory, "p.json"); }),
      "p.json: parameters.memory.G: is not identified and the memory model needs it: not in these data; calibrate "
      "with tests that contain it");
}

TEST(CalibratedLaw, AGroupIsKnownWithAllOfItsParameters) {
  CalibratedLaw law = complete();
  forget(law, "steady_pressure.p0");
  EXPECT_FALSE(has_values(law, "steady_pressure"));
  EXPECT_FALSE(has_values(law, "steady_pressure.p0"));
  EXPECT_TRUE(has_values(law, "steady_pressure.nu_c"));
  EXPECT_TRUE(has_values(law, "pressure")) << "another group";
  EXPECT_TRUE(has_values(law, "steady")) << "no group";
  for (const DensityCurve& curve : density_curves())
    EXPECT_EQ(has_values(law, curve), std::string(curve.quantity) != "steady_P_star") << curve.quantity;
}

TEST(CalibratedLaw, BandsNeedErrorsAndTwoPackings) {
  CalibratedLaw law = complete();
  EXPECT_TRUE(uncertain_parameters(law).empty());
  EXPECT_TRUE(available_bands(law).starts_with("none: ")) << available_bands(law);
  EXPECT_TRUE(uncertain_parameters(CalibratedLaw{}).empty()) << "without any covariance";
  law.covariance(7, 7) = law.covariance(3, 3) = 1e-4;
  EXPECT_EQ(uncertain_parameters(law), (std::vector<std::size_t>{3, 7}));
  EXPECT_TRUE(available_bands(law).starts_with("95 %, of the mean curve only: ")) << available_bands(law);
  law.scatter = {2, 5, 1e-3, 0.02, 0.01};
  EXPECT_EQ(available_bands(law),
            "95 %, of the mean curve and of a single run; the law's own error is not in them: no other "
            "path was rehearsed");
  law.rehearsals.emplace_back();
  EXPECT_EQ(available_bands(law), "95 %, of the mean curve and of a single run; with the law's own error");
}

TEST(Estimate, IntervalsAreStudents) {
  EXPECT_DOUBLE_EQ((Estimate{1, 0.1, Status::fitted, "", 3}).half_width(), 0.1 * student_95(3));
  EXPECT_TRUE(std::isnan((Estimate{1, 0.1, Status::fitted, ""}).half_width())) << "degrees of freedom are not known";
  EXPECT_TRUE(std::isnan((Estimate{1, std::nan(""), Status::fixed, "", 3}).half_width()));
}

TEST(Status, IsFoundByItsName) {
  for (const Status status : {Status::fitted, Status::fixed, Status::tied, Status::at_bound, Status::not_identified})
    EXPECT_EQ(value_of<Status>(to_string(status), "status"), status);
  EXPECT_EQ(to_string(Status::at_bound), "at_bound");
  EXPECT_EQ(refusal([] { value_of<Status>("sure", "status"); }),
            "status: 'sure' is none; give one of fitted, fixed, tied, at_bound, not_identified");
}

TEST(CalibratedLaw, AnIntervalSaysNothingThatIsWiderThanTheParameterMayBe) {
  CalibratedLaw law;
  const auto with = [&](const char* name, double value, double half_width) {
    const std::size_t i = parameter_index(name);
    law.estimates[i] = {value, half_width / student_95(1), Status::fitted, "", 1};
    return says_nothing(law, i);
  };
  EXPECT_TRUE(with("stress_rate.alpha", 2, 1225));
  EXPECT_FALSE(with("stress_rate.alpha", 2, 9)) << "contains zero, but not 11 and more";
  EXPECT_FALSE(with("stress_rate.alpha", 40, 39));
  EXPECT_TRUE(with("pressure.nu_c", 0.66, 0.021));
  EXPECT_FALSE(with("pressure.nu_c", 0.66, 0.019));
  EXPECT_FALSE(with("fabric_max.Q_limit", 0.01, 0.09)) << "as large as its Q_c may be";
  law.estimates[0] = {8, std::nan(""), Status::fixed, ""};
  EXPECT_FALSE(says_nothing(law, 0)) << "no interval";
}

}  // namespace
}  // namespace grainlaw
