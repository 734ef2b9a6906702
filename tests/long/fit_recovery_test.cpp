// Hard case F1 in full: 1000 starts of the coupled fit, in quarters that can run side by side.

#include <gtest/gtest.h>

#include "tests/support/figure.hpp"
#include "tests/support/fit_recovery.hpp"

namespace grainlaw {
namespace {

class FitRecovery : public ::testing::TestWithParam<int> {};

TEST_P(FitRecovery, F1EvolutionInFull) {
  const testing::RecoveryCount count = testing::recover_evolution(250, 13 + static_cast<std::uint64_t>(GetParam()));
  const std::string name = "F1.evolution.quarter_" + std::to_string(GetParam());
  testing::expect_figure(name + ".missed", 1 - static_cast<double>(count.recovered) / count.starts, 0.01);
  testing::expect_figure(name + ".silent", count.silent(), 0);
}

INSTANTIATE_TEST_SUITE_P(Quarter, FitRecovery, ::testing::Range(1, 5));

}  // namespace
}  // namespace grainlaw
