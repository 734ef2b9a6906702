#include "dem/statics/stiffness.hpp"

#include <gtest/gtest.h>

#include "dem/statics/relax.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

Eigen::Matrix3Xd random_displacements(std::size_t spheres, double largest, scene::Draw& draw) {
  Eigen::Matrix3Xd u(3, static_cast<Eigen::Index>(spheres));
  for (Eigen::Index i = 0; i < u.cols(); ++i) u.col(i) = draw.vector(-largest, largest);
  return u;
}

Eigen::Matrix3Xd reference_forces(State state, const Eigen::Matrix3Xd& u) {
  for (Eigen::Index i = 0; i < u.cols(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    scene::place(state.packing, at,
                 scene::fraction(state.packing, at) + state.packing.H.triangularView<Eigen::Upper>().solve(u.col(i)));
  }
  const ReferenceSums sums = reference_sums(state.packing, state.material, scene::at_rest(state));
  Eigen::Matrix3Xd f(3, u.cols());
  for (Eigen::Index i = 0; i < u.cols(); ++i) f.col(i) = sums.force[static_cast<std::size_t>(i)];
  return f;
}

State overlapping(std::uint64_t seed) {
  scene::Draw draw(seed);
  return scene::random_state(80, 3, 0.75, scene::random_shape(1.2, 0.2, draw), draw);
}

std::vector<NetworkContact> contacts_of(const State& state) {
  return contacts_at(state.packing, pairs_within(state.packing, 0, 1));
}

TEST(Stiffness, IsTheDerivativeOfTheReferenceForces) {
  const State state = overlapping(5);
  scene::Draw draw(6);
  const Eigen::Matrix3Xd u = random_displacements(state.packing.size(), 1, draw);
  const double h = 1e-9;  // displacements of 1e-6 <r>: second order terms of 1e-6, rounding of 1e-9
  const Eigen::Matrix3Xd slope = (reference_forces(state, h * u) - reference_forces(state, -h * u)) / (2 * h);
  const Eigen::Matrix3Xd expected = stiffness_times(contacts_of(state), state.material.stiffness, u);
  EXPECT_LE((slope + expected).norm(), 1e-5 * expected.norm());
}

TEST(Stiffness, SolutionMeetsItsEquation) {
  State state = overlapping(8);
  ASSERT_TRUE(relax(state, {}, RelaxOptions{1e-9, 200000}, {}).relaxed);
  const State backbone = backbone_of(state, 1);
  const auto contacts = contacts_of(backbone);
  scene::Draw draw(9);
  Eigen::Matrix3Xd f = random_displacements(backbone.packing.size(), 1, draw);
  f.colwise() -= Eigen::Vector3d(f.rowwise().mean());
  const double k = state.material.stiffness;
  const StiffnessSolution solution = solve_stiffness(contacts, k, f, 1e-10, 10000);
  ASSERT_EQ(solution.end, SolveEnd::solved);
  EXPECT_LE((stiffness_times(contacts, k, solution.u) - f).norm(), 1e-9 * f.norm());
  EXPECT_LE(solution.u.rowwise().sum().norm(), 1e-12 * solution.u.norm());
  EXPECT_EQ(solve_stiffness(contacts, k, f, 1e-10, 3).end, SolveEnd::too_long);
  EXPECT_EQ(solve_stiffness(contacts, k, Eigen::Matrix3Xd::Zero(3, f.cols()), 1e-10, 3).iterations, 0);
}

// A straight chain under pressure buckles: sideways its stiffness is that of the pre-stress, -k delta/d per contact.
TEST(Stiffness, SaysWhereTheEnergyHasNoMinimum) {
  const double d = 1.9e-3;
  Eigen::Matrix3d H = scene::cubic(2e-2);
  H(2, 2) = 2 * d;
  const State chain = scene::state_of(H, {{1e-3, {1e-2, 1e-2, 0}}, {1e-3, {1e-2, 1e-2, d}}});
  const auto contacts = contacts_of(chain);
  ASSERT_EQ(contacts.size(), 2u);
  Eigen::Matrix3Xd f(3, 2);
  f << 1, -1, 0, 0, 0, 0;
  EXPECT_EQ(solve_stiffness(contacts, 1e8, f, 1e-10, 100).end, SolveEnd::not_positive);
  f << 0, 0, 0, 0, 1, -1;  // along the chain two springs of k between the two: u_1 - u_2 = f/(2k)
  const StiffnessSolution solution = solve_stiffness(contacts, 1e8, f, 1e-12, 100);
  ASSERT_EQ(solution.end, SolveEnd::solved);
  EXPECT_NEAR(solution.u(2, 0) - solution.u(2, 1), 1 / 2e8, 1e-20);
}

}  // namespace
}  // namespace grainlaw::dem
