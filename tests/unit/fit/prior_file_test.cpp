#include "fit/prior_file.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

Json example() {
  return {{"packings", 48},
          {"spheres", 38400},
          {"names", {"overlap.D", "coordination.C1"}},
          {"degrees_of_freedom", {12.5, 40}},
          {"covariance", {{0.25, 0.1}, {0.1, 1.0 / 3}}}};
}

TEST(PriorFile, ComesBackAsItWas) {
  const VariancePrior prior = prior_from_json(example(), "here");
  const auto D = static_cast<Eigen::Index>(parameter_index("overlap.D")),
             C = static_cast<Eigen::Index>(parameter_index("coordination.C1"));
  EXPECT_EQ(prior.size.packings, 48);
  EXPECT_EQ(prior.covariance(C, C), 1.0 / 3);
  EXPECT_EQ(prior.covariance(C, D), 0.1);
  EXPECT_EQ(prior.degrees_of_freedom(D), 12.5);
  EXPECT_TRUE(std::isnan(prior.degrees_of_freedom(D + 1)));
  const VariancePrior again = prior_from_json(Json(prior_to_json(prior)), "here");
  EXPECT_EQ(again.covariance, prior.covariance);
}

TEST(PriorFile, KeepsTheLargestNumbers) {  // found by the fuzzer: their sum is none
  Json json = example();
  json["covariance"] = {{1e308, 0.1}, {0.1, 1}};
  const auto D = static_cast<Eigen::Index>(parameter_index("overlap.D"));
  EXPECT_EQ(prior_from_json(json, "here").covariance(D, D), 1e308);
}

TEST(PriorFile, IsRefusedByTheNameOfWhatIsWrong) {
  const auto message_of = [](const char* key, Json value) -> std::string {
    Json json = example();
    json[key] = std::move(value);
    try {
      prior_from_json(json, "mine.json");
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message_of("names", {"overlap.D"}).find("mine.json"), std::string::npos);
  EXPECT_NE(message_of("names", {"overlap.D", "overlap.E"}).find("overlap.E"), std::string::npos);
  EXPECT_NE(message_of("degrees_of_freedom", {12, -1}).find("degrees_of_freedom[1]"), std::string::npos);
  EXPECT_NE(message_of("covariance", {{1, 0.5}, {0.4, 1}}).find("symmetric"), std::string::npos);
  EXPECT_NE(message_of("spheres", 0).find("spheres"), std::string::npos);
}

TEST(PriorFile, TheBuiltInOneKnowsEveryStage) {
  const VariancePrior& prior = shipped_prior();
  for (const char* name : {"coordination.nu_c", "rattlers.phi_v", "pressure.nu_c", "steady_pressure.nu_c",
                           "stress_ratio_max.Q_c", "stress_rate.Q_c", "anisotropy.a2", "memory.lambda"}) {
    const auto k = static_cast<Eigen::Index>(parameter_index(name));
    EXPECT_GT(prior.covariance(k, k), 0) << name;
    EXPECT_GT(prior.degrees_of_freedom(k), 0) << name;
    EXPECT_LT(prior.degrees_of_freedom(k), prior.size.packings) << name;
  }
}

}  // namespace
}  // namespace grainlaw::fit
