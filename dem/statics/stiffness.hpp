#pragma once
// The stiffness of a contact network at rest and the solution of K u = f.
//   (K u)_i = sum_{c in i} M_c (u_i - u_j),   M_c = k [(1 + delta/d) n n^T - (delta/d) 1]
// the second derivative of E = sum k delta^2/2 with respect to the positions; the second term is the pre-stress. At a
// minimum of the energy K is positive but for the translations of the whole.

#include <Eigen/Core>
#include <stop_token>
#include <vector>

#include "dem/statics/contact_network.hpp"

namespace grainlaw::dem {

/// M_c [kg/s^2].
Eigen::Matrix3d contact_stiffness(const NetworkContact& contact, double stiffness);

/// u_1 - u_2 -> M_c (u_1 - u_2) over all contacts; columns are spheres.
Eigen::Matrix3Xd stiffness_times(const std::vector<NetworkContact>& contacts, double stiffness,
                                 const Eigen::Matrix3Xd& u);

enum class SolveEnd {
  solved,
  not_positive,  ///< a direction of negative curvature was met: the configuration is no minimum
  too_long,      ///< the limit of iterations was reached
};

struct StiffnessSolution {
  Eigen::Matrix3Xd u;  ///< [m]; columns sum to zero
  SolveEnd end = SolveEnd::solved;
  int iterations = 0;
};

/// Conjugate gradients, preconditioned by the 3 x 3 blocks of K, until the residual is `tolerance` times |f|. The columns of
/// f sum to zero [N]. Throws Interrupted on request.
StiffnessSolution solve_stiffness(const std::vector<NetworkContact>& contacts, double stiffness,
                                  const Eigen::Matrix3Xd& f, double tolerance, int max_iterations,
                                  const std::stop_token& stop = {});

}  // namespace grainlaw::dem
