#include "dem/statics/linear_response.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "dem/statics/relax.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

LinearResponse response_of(const State& state) {
  const auto contacts = contacts_at(state.packing, pairs_within(state.packing, 0, 1));
  return linear_response(state.packing, contacts, state.material.stiffness);
}

/// Spheres that carry load, at rest as far as the minimiser goes.
State sixty_at_rest(double nu, std::uint64_t seed) {
  scene::Draw draw(seed);
  State state = scene::random_state(60, 3, nu, scene::cubic(1), draw);
  EXPECT_TRUE(relax(state, {}, RelaxOptions{1e-12, 400000}, {}).relaxed);
  return backbone_of(state, 1);
}

Eigen::Matrix3d reference_stress(const State& state) {
  return reference_sums(state.packing, state.material, scene::at_rest(state)).virial / state.packing.volume();
}

TEST(LinearResponse, CoordinatesAreThoseOfTheNorms) {
  Vector6 y;
  y << 0.3, 0.1, -0.4, 0.2, 0.5, -0.6;
  const Eigen::Matrix3d eps = strain_of(y);
  EXPECT_NEAR(eps.trace(), -0.3, 1e-15);
  EXPECT_NEAR(deviatoric_norm(eps), y.tail<5>().norm(), 1e-15);
  EXPECT_LE((stress_coordinates(-eps) - (Vector6() << 0.1, y.tail<5>()).finished()).norm(), 1e-15);
}

// The minimiser and the O(N^2) reference know nothing of the stiffness.
TEST(LinearResponse, EqualsDifferencesOfRelaxedStates) {
  for (const double nu : {0.70, 0.80}) {
    const State state = sixty_at_rest(nu, 4);
    const LinearResponse response = response_of(state);
    ASSERT_EQ(response.end, SolveEnd::solved);
    const double h = 1e-6;
    for (int a = 0; a < 3; ++a) {  // strains along the axes: the cell stays upper triangular
      Vector6 y[2];
      for (const int side : {0, 1}) {
        State strained = state;
        const Eigen::Vector3d eps = strain_of((side == 0 ? -h : h) * Vector6::Unit(a)).diagonal();
        strained.packing.H = eps.array().exp().matrix().asDiagonal() * state.packing.H;
        ASSERT_TRUE(relax(strained, {}, RelaxOptions{1e-12, 400000}, {}).relaxed);
        y[side] = stress_coordinates(reference_stress(strained));
      }
      const Vector6 slope = (y[1] - y[0]) / (2 * h);
      EXPECT_LE((slope - response.relaxed.col(a)).norm(), 1e-5 * slope.norm()) << "nu = " << nu << ", strain " << a;
    }
  }
}

TEST(LinearResponse, HasTheSymmetryOfAnEnergy) {
  const State state = sixty_at_rest(0.72, 9);
  const Tangent T = response_of(state).relaxed;
  const Deviator<double> sigma = deviator<double>(reference_stress(state));
  const Deviator<double> A1 = T.row(0).tail<5>(), A2 = T.col(0).tail<5>();
  EXPECT_GT(sigma.norm(), 1e-3 * T(0, 0));
  EXPECT_LE((A1 - 2.0 / 3 * (A2 - sigma)).norm(), 1e-8 * T(0, 0));
  const Eigen::Matrix<double, 5, 5> DG = T.bottomRightCorner<5, 5>();
  EXPECT_LE((DG - DG.transpose()).norm(), 1e-8 * DG.norm());
}

// Second derivatives of the energy per initial volume: (B - P, A1; A1, (2/3) DG); the stress terms are equal on both sides.
TEST(LinearResponse, RelaxationOnlySoftens) {
  const LinearResponse response = response_of(sixty_at_rest(0.72, 9));
  Tangent softened = response.affine - response.relaxed;
  softened.bottomRows<5>() *= 2.0 / 3;
  const Eigen::SelfAdjointEigenSolver<Tangent> eigen(0.5 * (softened + softened.transpose()));
  EXPECT_LE((softened - softened.transpose()).norm(), 1e-8 * softened.norm());
  EXPECT_GT(eigen.eigenvalues()(0), 0);
  EXPECT_LT(response.relaxed(0, 0), response.affine(0, 0));
}

TEST(LinearResponse, GivesNoNumbersWithoutAMinimum) {
  const double d = 1.9e-3;  // a zigzag under pressure in a wide cell
  Eigen::Matrix3d H = scene::cubic(2e-2);
  H(2, 2) = 2 * d;
  const State chain = scene::state_of(H, {{1e-3, {1e-2, 1e-2, 0}}, {1e-3, {1.002e-2, 1e-2, d}}});
  const LinearResponse response = response_of(chain);
  EXPECT_EQ(response.end, SolveEnd::not_positive);
  EXPECT_TRUE(response.relaxed.array().isNaN().all());
  EXPECT_TRUE(response.affine.allFinite());
}

}  // namespace
}  // namespace grainlaw::dem
