// parameters.json of earlier versions: their memory rungs are other laws.
#include <Eigen/Core>
#include <string>

#include "model/files/json_document.hpp"
#include "chain/parameters_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

using testing::refusal;

class OlderParameters : public testing::TemporaryFolder {};

TEST_F(OlderParameters, HaveNoMemoryRung) {
  fit::Calibration c;
  c.parameters = published_parameters();
  c.nu_min = 0.68;
  c.nu_max = 0.82;
  c.parameters.memory = {0.9, 0.7, 2.5, 10, 40, 10, 1, 0.9, 0.6, 1.18};
  c.covariance = Eigen::MatrixXd::Identity(kParameterCount, kParameterCount);
  for (std::size_t i = 0; i < kParameterCount; ++i)
    c.estimates[i] = {*fields(c.parameters)[i], 1, fit::Status::fitted, "", 4};
  chain::write_parameters(folder_ / "p.json", {c, "", {}});
  const chain::ParametersFile whole = chain::read_parameters(folder_ / "p.json");
  EXPECT_EQ(refusal([&] { chain::require_parameters(whole, Rung::memory, "p.json"); }), "accepted");
  Json old = read_json(folder_ / "p.json", JsonSource::own);
  old["parameters"]["memory.g"] = old["parameters"]["memory.m"];  // which this program does not know
  for (const int version : {1, 2, 3}) {
    old["format_version"] = version;
    write_json(folder_ / "old.json", OrderedJson(old));
    const chain::ParametersFile read = chain::read_parameters(folder_ / "old.json");
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const bool memory = std::string(parameter_table()[i].name).starts_with("memory.");
      EXPECT_EQ(read.calibration.estimates[i].status, memory ? fit::Status::not_identified : fit::Status::fitted);
      EXPECT_EQ(read.calibration.covariance(k, k), memory ? 0 : 1);
    }
    EXPECT_EQ(refusal([&] { chain::require_parameters(read, Rung::evolution, "old.json"); }), "accepted");
    EXPECT_NE(refusal([&] { chain::require_parameters(read, Rung::memory, "old.json"); }).find("older than the memory rung"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace grainlaw::app
