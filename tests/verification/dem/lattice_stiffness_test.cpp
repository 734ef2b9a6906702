// Moduli of compressed lattices in closed form; edge a, spheres of radius r, contacts of length d, overlap delta = 2r - d.
//   fcc: P = 8 k delta d/a^3, B = (4/3)(k/a)(1 + delta/d) + P/3, DG = (k/a)(1 + delta/d) - 2P of strains along the axes
//        and 2 (k/a)(1 + delta/d) - 2P of shears
//   one sphere in a cell L_1 x L_2 x L_3, touching its images: sigma_i = k (2r - L_i) L_i/V, so for strains eps_i
//   (compression positive) dsigma_i = k L_i^2/V eps_i + sigma_i (tr eps - eps_i), dsigma_ij = -(sigma_i + sigma_j) eps_ij
// The fcc sums: over the 24 contacts of a cell, sum l_x^4 = a^4, sum l_x^2 l_y^2 = a^4/2. Spheres of a lattice follow the strain.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dem/statics/linear_response.hpp"
#include "tests/support/dem_scene.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using testing::expect_figure;

const double kStiffness = Material{}.stiffness;

LinearResponse response_of(const State& state) {
  return linear_response(state.packing, contacts_at(state.packing, pairs_within(state.packing, 0, 1)), kStiffness);
}

TEST(LatticeStiffness, FaceCentredCubic) {
  const double a = 3e-3, d = a / std::sqrt(2.0);
  double error = 0;
  for (const double overlap : {1e-4, 0.02}) {
    const double r = 0.5 * d / (1 - overlap), delta = 2 * r - d, P = 8 * kStiffness * delta * d / (a * a * a);
    std::vector<scene::Sphere> spheres;
    for (const Eigen::Vector3d& site : {Eigen::Vector3d(0, 0, 0), {0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}}) {
      spheres.push_back({r, a * (site + Eigen::Vector3d(0.1, 0.3, -0.2)), Eigen::Vector3d::Zero()});
    }
    const LinearResponse response = response_of(scene::state_of(scene::cubic(a), spheres));
    ASSERT_EQ(response.end, SolveEnd::solved);
    const double stiff = kStiffness / a * (1 + delta / d);
    Vector6 expected;
    expected << 4.0 / 3 * stiff + P / 3, stiff - 2 * P, stiff - 2 * P, 2 * stiff - 2 * P, 2 * stiff - 2 * P,
        2 * stiff - 2 * P;
    const Tangent off = response.relaxed - Tangent(expected.asDiagonal());
    error = std::max(
        {error, off.cwiseAbs().maxCoeff() / stiff, (response.relaxed - response.affine).cwiseAbs().maxCoeff() / stiff});
  }
  expect_figure("lattice_stiffness.fcc", error, 1e-12);
}

TEST(LatticeStiffness, OneSphereInAnOblongCell) {
  const Eigen::Vector3d L(1.9e-3, 1.95e-3, 1.8e-3);
  const double r = 1e-3, V = L.prod();
  const State state = scene::state_of(L.asDiagonal(), {{r, {1e-4, 2e-4, 3e-4}, Eigen::Vector3d::Zero()}});
  const LinearResponse response = response_of(state);
  ASSERT_EQ(response.end, SolveEnd::solved);
  const Eigen::Vector3d sigma = kStiffness / V * (2 * r - L.array()) * L.array();
  double error = 0, largest = 0;
  for (int a = 0; a < 6; ++a) {
    const Eigen::Matrix3d eps = -strain_of(Vector6::Unit(a));
    Eigen::Matrix3d change;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        change(i, j) = i == j ? kStiffness * L[i] * L[i] / V * eps(i, i) + sigma[i] * (eps.trace() - eps(i, i))
                              : -(sigma[i] + sigma[j]) * eps(i, j);
      }
    }
    const Vector6 expected = stress_coordinates(change);
    error = std::max(error, (response.relaxed.col(a) - expected).norm());
    largest = std::max(largest, expected.norm());
  }
  const Deviator<double> A1 = response.relaxed.row(0).tail<5>(), A2 = response.relaxed.col(0).tail<5>();
  const Eigen::Matrix3d stress = sigma.asDiagonal();
  expect_figure("lattice_stiffness.oblong", error / largest, 1e-12);
  expect_figure("lattice_stiffness.oblong.identity",
                (A1 - 2.0 / 3 * (A2 - deviator<double>(stress))).norm() / A2.norm(), 1e-12);
  EXPECT_GT(A2.norm(), 1e-3 * largest);
}

}  // namespace
}  // namespace grainlaw::dem
