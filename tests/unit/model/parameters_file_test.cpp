#include "model/parameters_file.hpp"

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>

#include "model/files/json_document.hpp"
#include "tests/support/odd_law.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw {
namespace {

using testing::refusal;

class ParametersFileTest : public testing::TemporaryFolder {};

TEST_F(ParametersFileTest, IsReadBackBitForBit) {
  const CalibratedLaw c = testing::odd_law();
  write_parameters(folder_ / "parameters.json", {c, {{"command", "test"}}});
  const ParametersFile read = read_parameters(folder_ / "parameters.json");
  testing::expect_same(c, read.law);
  EXPECT_EQ(read.law.dataset_digest, std::string(64, 'b'));
  const Json file = read_json(folder_ / "parameters.json", JsonSource::own);
  EXPECT_TRUE(file["parameters"]["anisotropy.a2"]["value"].is_null());
  EXPECT_TRUE(file["parameters"]["shear.nu_c"]["standard_error"].is_null());
}

TEST_F(ParametersFileTest, DoubtfulParametersAreRefused) {
  write_parameters(folder_ / "p.json", {testing::odd_law(), {}});
  const Json good = read_json(folder_ / "p.json", JsonSource::own);
  const auto message = [&](const std::function<void(Json&)>& damage) {
    Json bad = good;
    damage(bad);
    write_json(folder_ / "bad.json", OrderedJson(bad));
    return refusal([&] { read_parameters(folder_ / "bad.json"); });
  };
  EXPECT_NE(message([](Json& j) {
              j["parameters"]["pressure.p0"]["value"] = nullptr;
            }).find("bad.json: parameters.pressure.p0.value: must be null exactly"),
            std::string::npos);
  EXPECT_NE(message([](Json& j) {
              j["parameters"]["pressure.p0"]["value"] = -3;
            }).find("parameters.pressure.p0.value: -3 is outside its bounds"),
            std::string::npos);
  EXPECT_NE(message([](Json& j) {
              j["parameters"]["pressure.p1"] = j["parameters"]["pressure.p0"];
            }).find("'pressure.p1' is no parameter"),
            std::string::npos);
  EXPECT_NE(message([](Json& j) { j["parameters"]["pressure.p0"]["status"] = "sure"; }).find("got \"sure\""),
            std::string::npos);
  EXPECT_NE(message([](Json& j) { j["covariance"]["matrix"].erase(0); }).find("covariance.matrix: needs one row"),
            std::string::npos);
  EXPECT_NE(message([](Json& j) { j["ranges"]["nu"] = {0.7}; }).find("ranges.nu"), std::string::npos);
  EXPECT_NE(message([](Json& j) { j.erase("coupling"); }).find("misses the key 'coupling'"), std::string::npos);

  const ParametersFile read = read_parameters(folder_ / "p.json");
  EXPECT_EQ(refusal([&] { require_parameters(read.law, Rung::evolution, "p.json"); }),
            "accepted");  // single coupling reads a0
  ParametersFile energy = read;
  energy.law.coupling = Coupling::energy;
  EXPECT_NE(refusal([&] {
              require_parameters(energy.law, Rung::evolution, "p.json");
            }).find("p.json: parameters.anisotropy.a2: is not identified"),
            std::string::npos);
  EXPECT_EQ(refusal([&] { require_parameters(energy.law, Rung::reduced, "p.json"); }), "accepted");
  energy.law.estimates[parameter_index("stress_rate.alpha")].status = Status::not_identified;
  EXPECT_NE(refusal([&] { require_parameters(energy.law, Rung::reduced, "p.json"); }).find("stress_rate.alpha"),
            std::string::npos);
  energy.law.parameters.stress_rate.Q_c = 0;  // the exponential is gone, and its decay with it
  EXPECT_EQ(refusal([&] { require_parameters(energy.law, Rung::reduced, "p.json"); }), "accepted");
}

TEST_F(ParametersFileTest, WhatWasReadIsWrittenAgainByteForByte) {
  write_parameters(folder_ / "first.json", {testing::odd_law(), {{"command", "test"}}});
  write_parameters(folder_ / "second.json", read_parameters(folder_ / "first.json"));
  EXPECT_EQ(content(folder_ / "second.json"), content(folder_ / "first.json"));
}

// Found by the fuzzer: 3e9 packings were read as a negative number.
TEST_F(ParametersFileTest, RefusesIntegersThatTheLawDoesNotHold) {
  write_parameters(folder_ / "p.json", {testing::odd_law(), {}});
  Json changed = read_json(folder_ / "p.json", JsonSource::own);
  changed["scatter"]["packings"] = 3000000000;
  write_json(folder_ / "changed.json", OrderedJson(changed));
  const std::string why = refusal([&] { read_parameters(folder_ / "changed.json"); });
  EXPECT_NE(why.find("changed.json: scatter.packings: got 3000000000"), std::string::npos) << why;
}

// Found by the fuzzer: one of F_max's parameters is not known, so the law forgets the others; what is written keeps them.
TEST_F(ParametersFileTest, KeepsWhatTheLawForgets) {
  CalibratedLaw law = testing::odd_law();
  const std::size_t limit = parameter_index("fabric_max.Q_limit"), Q_c = parameter_index("fabric_max.Q_c");
  law.estimates[limit] = {std::nan(""), std::nan(""), Status::not_identified, ""};
  law.estimates[Q_c] = {0.17, std::nan(""), Status::fitted, ""};
  *fields(law.parameters)[Q_c] = 0.17;
  write_parameters(folder_ / "first.json", {law, {}});
  ParametersFile read = read_parameters(folder_ / "first.json");
  EXPECT_TRUE(std::isnan(*fields(read.law.parameters)[Q_c]));
  write_parameters(folder_ / "second.json", read);
  EXPECT_EQ(content(folder_ / "second.json"), content(folder_ / "first.json"));
}

// Found by the fuzzer: what moves a terminal's cursor came through in the name of a parameter.
TEST_F(ParametersFileTest, NamesUnknownParametersInOneLine) {
  write_parameters(folder_ / "p.json", {testing::odd_law(), {}});
  Json changed = read_json(folder_ / "p.json", JsonSource::own);
  changed["parameters"]["pressure.p0\x7f"] = changed["parameters"]["pressure.p0"];
  write_json(folder_ / "changed.json", OrderedJson(changed));
  const std::string why = refusal([&] { read_parameters(folder_ / "changed.json"); });
  EXPECT_NE(why.find("'pressure.p0\\x7f' is no parameter of the law"), std::string::npos) << why;
}

// Files without degrees of freedom, scatter, covariance, digest or word of convergence.
TEST_F(ParametersFileTest, OlderOnesSayLess) {
  write_parameters(folder_ / "p.json", {testing::odd_law(), {}});
  Json old = read_json(folder_ / "p.json", JsonSource::own);
  for (auto& entry : old["parameters"]) {
    entry.erase("degrees_of_freedom");
    entry.erase("interval_95");
  }
  for (const char* key : {"scatter", "covariance", "dataset_digest", "converged"}) old.erase(key);
  write_json(folder_ / "old.json", OrderedJson(old));
  const CalibratedLaw law = read_parameters(folder_ / "old.json").law;
  EXPECT_EQ(law.estimates[parameter_index("pressure.p0")].degrees_of_freedom, std::numeric_limits<double>::infinity())
      << "as if errors were exact";
  EXPECT_TRUE(std::isnan(law.estimates[parameter_index("shear.nu_c")].degrees_of_freedom)) << "no error";
  EXPECT_TRUE(uncertain_parameters(law).empty());
  EXPECT_TRUE(std::isnan(law.scatter.compression));
  EXPECT_EQ(law.dataset_digest, "");
  EXPECT_FALSE(law.converged);
}

// The memory rungs of earlier versions are other laws.
TEST_F(ParametersFileTest, OlderOnesHaveNoMemoryRung) {
  CalibratedLaw c;
  c.parameters = published_parameters();
  c.range.nu_min = 0.68;
  c.range.nu_max = 0.82;
  c.parameters.memory = {0.9, 0.7, 2.5, 10, 40, 10, 1, 0.9, 0.6, 1.18};
  c.covariance = Eigen::MatrixXd::Identity(kParameterCount, kParameterCount);
  for (std::size_t i = 0; i < kParameterCount; ++i)
    c.estimates[i] = {*fields(c.parameters)[i], 1, Status::fitted, "", 4};
  write_parameters(folder_ / "p.json", {c, {}});
  const ParametersFile whole = read_parameters(folder_ / "p.json");
  EXPECT_EQ(refusal([&] { require_parameters(whole.law, Rung::memory, "p.json"); }), "accepted");
  Json old = read_json(folder_ / "p.json", JsonSource::own);
  old["parameters"]["memory.g"] = old["parameters"]["memory.m"];  // which this program does not know
  for (const int version : {1, 2, 3}) {
    old["format_version"] = version;
    write_json(folder_ / "old.json", OrderedJson(old));
    const ParametersFile read = read_parameters(folder_ / "old.json");
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const bool memory = std::string(parameter_table()[i].name).starts_with("memory.");
      EXPECT_EQ(read.law.estimates[i].status, memory ? Status::not_identified : Status::fitted);
      EXPECT_EQ(read.law.covariance(k, k), memory ? 0 : 1);
    }
    EXPECT_EQ(refusal([&] { require_parameters(read.law, Rung::evolution, "old.json"); }), "accepted");
    EXPECT_NE(
        refusal([&] { require_parameters(read.law, Rung::memory, "old.json"); }).find("older than the memory rung"),
        std::string::npos);
  }
}

}  // namespace
}  // namespace grainlaw
