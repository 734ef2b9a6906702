#pragma once
// First-order response of a packing at rest to strain, its contacts unchanged (static linear response, pre-stress included).
//   dl = g l + u_i - u_j,   sum_{c in i} M_c dl = 0,   g = sym. displacement gradient, u on top of it
//   dsigma = -tr(g) sigma + (1/V) sum_c [d(k delta/d) l l + (k delta/d) (dl l + l dl)],   no rotation
//   x = -eps_vol, e = deviator of -eps;   (dP, dsigma') = T (dx, de):   B = T_00,  A1 = T_0b,  A2 = T_a0,  DG = T_ab
// Work, dW/V = P dx + (2/3) sigma'.de, makes DG symmetric and A1 = (2/3)(A2 - sigma'). Relaxation lowers the energy, so
// affine - relaxed has no negative eigenvalue once the deviatoric rows are weighed by 2/3. Compression positive. [Pa]

#include <Eigen/Core>
#include <vector>

#include "dem/statics/stiffness.hpp"
#include "model/vocabulary/tensor.hpp"

namespace grainlaw::dem {

using Vector6 =
    Eigen::Matrix<double, 6, 1>;  ///< P and sigma', or x and e, in the coordinates of model/vocabulary/tensor.hpp
using Tangent = Eigen::Matrix<double, 6, 6>;  ///< rows P, sigma'; columns x, e [Pa]

/// (P, sigma') of a stress.
Vector6 stress_coordinates(const Eigen::Matrix3d& sigma);

/// The tension-positive strain tensor with the coordinates (x, e).
Eigen::Matrix3d strain_of(const Vector6& coordinates);

struct LinearResponse {
  Tangent relaxed = Tangent::Zero();  ///< T [Pa]
  Tangent affine = Tangent::Zero();   ///< T if every sphere followed the strain, u = 0 [Pa]
  std::vector<Eigen::Matrix3Xd> u;    ///< of each unit strain, x and e [m]
  SolveEnd end = SolveEnd::solved;    ///< the worst of the six; unless solved, `relaxed` is NaN
  int iterations = 0;                 ///< of conjugate gradients, all six
};

/// `contacts` are those of `packing` at rest, all its spheres carrying load. Throws Interrupted on request.
LinearResponse linear_response(const Packing& packing, const std::vector<NetworkContact>& contacts, double stiffness,
                               const std::stop_token& stop = {});

}  // namespace grainlaw::dem
