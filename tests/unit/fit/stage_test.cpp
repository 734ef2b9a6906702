#include "fit/stages/stage.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/fit_stages.hpp"

namespace grainlaw::fit {
namespace {

/// overlap.D is the mean of `values`, one for each packing, less what fabric.g3 is of them.
StageDefinition mean_stage(const std::vector<double>& values) {
  StageDefinition stage;
  stage.name = "mean";
  stage.free = {"overlap.D"};
  stage.blocks = [values](const LawParameters<double>& law) {
    std::vector<ResidualBlock> blocks;
    for (std::size_t c = 0; c < values.size(); ++c) {
      ResidualBlock block;
      block.cluster = static_cast<int>(c);
      block.weight = Eigen::VectorXd::Ones(1);
      block.channels = {{"value", 0, 1, 0, 1}};
      block.evaluate = [value = values[c], g3 = law.fabric_g3](const double* x, double* misfit, double* jacobian) {
        misfit[0] = x[0] + g3 - value;
        if (jacobian != nullptr) jacobian[0] = 1;
        return true;
      };
      blocks.push_back(std::move(block));
    }
    return blocks;
  };
  return stage;
}

/// Of `g3` with an influence of +-`error`/sqrt(2) of two packings.
FoundErrors known_g3(double error) {
  FoundErrors found = no_errors();
  widen(found.influence, 2);
  const auto k = static_cast<Eigen::Index>(parameter_index("fabric.g3"));
  found.influence.row(k) << error / std::sqrt(2.0), -error / std::sqrt(2.0);
  found.degrees_of_freedom(k) = 1;
  return found;
}

TEST(Stage, TakesOverTheValueAndAddsWhatIsInherited) {
  LawParameters<double> law = start_parameters();
  law.fabric_g3 = 1;
  StageDefinition stage = mean_stage({3, 5});
  const StageFit alone = run_stage(stage, law, {}, {});
  EXPECT_NEAR(law.overlap_D, 3, 1e-9);
  EXPECT_NEAR(alone.stage.estimates[0].estimate.standard_error, 1, 1e-9);
  // The first packing is low by one and moved g3 up: both move D down.
  stage.given = {"fabric"};
  const StageFit fit = run_stage(stage, law, {}, {}, known_g3(0.5));
  EXPECT_NEAR(fit.stage.estimates[0].estimate.standard_error, 1.5, 1e-8);
}

TEST(Stage, JudgesAfterTheFitAndSaysWhatIsAbsent) {
  LawParameters<double> law = start_parameters();
  StageDefinition stage = mean_stage({3, 5});
  stage.judge = [](StageFit& fit, const LawParameters<double>& found) {
    EXPECT_EQ(found.overlap_D, fit.solution.x(0));
    fit.mark_not_identified("overlap.D", "because");
  };
  stage.absent = {{"fabric.g3", {0, kUndefined, Status::not_identified, "add it"}}};
  const StageFit fit = run_stage(stage, law, {}, {});
  ASSERT_EQ(fit.stage.estimates.size(), 2u);
  EXPECT_EQ(testing::estimate(fit, "overlap.D").note, "because");
  EXPECT_EQ(testing::estimate(fit, "fabric.g3").note, "add it");
}

TEST(Stage, JammingKeepsBelowTheRows) {
  StageDefinition stage = mean_stage({3, 5});
  stage.free = {"pressure.nu_c"};
  stage.least_nu = 0.66;
  stage.start = [](LawParameters<double>& law) { law.isotropic.pressure.nu_c = 0.65; };
  const Problem problem = problem_of(stage, start_parameters(), Loss::huber);
  EXPECT_EQ(problem.parameters[0].start, 0.65);
  EXPECT_EQ(problem.parameters[0].upper, 0.66 - kNearestJamming);
  EXPECT_EQ(problem.loss, Loss::huber);
}

TEST(Stage, WhatWasLeftOutSaysSo) {
  LawParameters<double> law = start_parameters();
  const StageFit fit = run_stage(left_out("overlap", parameters_of("overlap"), "no data"), law, {}, {});
  EXPECT_TRUE(fit.stage.converged);
  EXPECT_EQ(fit.stage.termination, "left out");
  ASSERT_EQ(fit.stage.estimates.size(), 1u);
  EXPECT_EQ(fit.stage.estimates[0].name, "overlap.D");
  EXPECT_EQ(fit.stage.estimates[0].estimate.status, Status::not_identified);
  EXPECT_EQ(fit.stage.estimates[0].estimate.note, "no data");
}

TEST(Stage, GroupsAreThoseOfTheTable) {
  EXPECT_EQ(parameters_of("pressure"), (std::vector<std::string>{"pressure.p0", "pressure.gamma_p", "pressure.nu_c"}));
  EXPECT_TRUE(parameters_of("press").empty());
}

}  // namespace
}  // namespace grainlaw::fit
