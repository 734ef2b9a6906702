// Hard case F1 in full: 1000 starts of the coupled fit.

#include <gtest/gtest.h>

#include "tests/support/figure.hpp"
#include "tests/support/fit_recovery.hpp"

namespace grainlaw {
namespace {

TEST(FitRecovery, F1EvolutionInFull) {
  const testing::RecoveryCount count = testing::recover_evolution(1000, 13);
  testing::figure("F1.evolution.missed", 1 - static_cast<double>(count.recovered) / count.starts, 0.01);
  testing::figure("F1.evolution.silent", count.silent(), 0);
}

}  // namespace
}  // namespace grainlaw
