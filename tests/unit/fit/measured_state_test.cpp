#include "fit/stages/measured_state.hpp"

#include <gtest/gtest.h>

namespace grainlaw::fit {
namespace {

TEST(MeasuredState, DropsTheUnitOfStressOnly) {
  // k/(2<r>) = 1e8/2e-3 = 5e10 Pa. Uniaxial along z: |sigma|_dev = sigma_zz - sigma_xx, |F|_dev likewise.
  TestRecord test;
  test.packing = {1, 100, 3, 1e-3, 1e8};
  Observation row;
  row.stress.tensor = Eigen::Vector3d(1e9, 1e9, 4e9).asDiagonal();
  row.fabric.tensor = Eigen::Vector3d(1.8, 1.8, 2.1).asDiagonal();
  row.P_star = 2e9 / 5e10;
  const LawState<double> state = measured_state(test, row);
  EXPECT_DOUBLE_EQ(state.P, 0.04);
  EXPECT_NEAR(state.sigma.norm(), 3e9 / 5e10, 1e-15);
  EXPECT_NEAR(state.F.norm(), 0.3, 1e-15);
  // Compression along z leads to stress and fabric along +N.
  const LawDirection direction = law_direction(direction_of(Mode::UNI));
  EXPECT_GT(state.sigma.dot(direction.N), 0);
  EXPECT_GT(state.F.dot(direction.N), 0);
}

}  // namespace
}  // namespace grainlaw::fit
