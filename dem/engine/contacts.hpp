#pragma once
// The contacts of one sphere: geometry, rate and force, Eq. (1), for everything that sums over contacts.
//   u = L x_ij                              velocity that the moving cell adds to x_ij, homogeneous transport
//   u = L H (floor s_i - floor s_j - n)     the same when only the edges move

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "dem/engine/neighbour_list.hpp"
#include "dem/engine/stepping.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {

using Row = std::array<double, 4>;

/// What a sum over contacts reads: plain pointers, so that the inner loop stays free of indirection.
struct ForceField {
  const NeighbourList* list = nullptr;
  const Row* place = nullptr;             ///< x, y, z [m], r [m]
  const Row* motion = nullptr;            ///< vx, vy, vz [m/s], unused
  const double *sx = nullptr, *sy = nullptr, *sz = nullptr;  ///< fractions; read by wall-driven transport only
  const Eigen::Vector3d* shift = nullptr; ///< H n of each image of the list [m]
  const std::int64_t* id = nullptr;       ///< for messages
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d L = Eigen::Matrix3d::Zero();
  double stiffness = 0, viscosity = 0;    ///< k, gamma
  bool wall_driven = false;
};

/// One contact of sphere i with sphere (or image) j.
struct Contact {
  std::size_t j;
  double nx, ny, nz;  ///< n = x_ij/|x_ij|, from j to i [-]
  double distance;    ///< |x_ij|, the length of the branch vector [m]
  double delta;       ///< overlap > 0 [m]
  double rate;        ///< d(delta)/dt [m/s]
  double u_n;         ///< u . n [m/s]
  double force;       ///< f along n on sphere i, Eq. (1) [N]
};

/// Calls visit(contact) for each contact of sphere i in the order of its neighbours. Throws Error naming both ids when
/// two touching spheres share one position.
template <bool wall_driven, class Visit>
inline void visit_contacts(const ForceField& field, std::size_t i, const Visit& visit) {
  const NeighbourList& list = *field.list;
  const Eigen::Matrix3d& L = field.L;
  const Row& pi = field.place[i];
  for (std::size_t c = list.first[i]; c < list.first[i + 1]; ++c) {
    const std::size_t j = list.j[c];
    const Row& pj = field.place[j];
    const Eigen::Vector3d& shift = field.shift[list.image[c]];
    const double dx = pi[0] - pj[0] - shift[0], dy = pi[1] - pj[1] - shift[1], dz = pi[2] - pj[2] - shift[2];
    const double reach = pi[3] + pj[3];
    const double d2 = dx * dx + dy * dy + dz * dz;
    if (!(d2 < reach * reach)) continue;
    Contact contact;
    contact.j = j;
    contact.distance = std::sqrt(d2);
    contact.delta = reach - contact.distance;
    const double inverse = 1 / contact.distance;
    contact.nx = dx * inverse;
    contact.ny = dy * inverse;
    contact.nz = dz * inverse;
    if (!std::isfinite(contact.nx + contact.ny + contact.nz)) {  // at zero distance, or where its square underflows
      throw Error(fmt::format("spheres {} and {} share one position; move one of them", field.id[i], field.id[j]));
    }
    double ux, uy, uz;
    if constexpr (wall_driven) {
      const Eigen::Vector3d& n = list.offset[list.image[c]];
      const Eigen::Vector3d images(std::floor(field.sx[i]) - std::floor(field.sx[j]) - n[0],
                                   std::floor(field.sy[i]) - std::floor(field.sy[j]) - n[1],
                                   std::floor(field.sz[i]) - std::floor(field.sz[j]) - n[2]);
      const Eigen::Vector3d u = L * (field.H * images);
      ux = u[0], uy = u[1], uz = u[2];
    } else {
      ux = L(0, 0) * dx + L(0, 1) * dy + L(0, 2) * dz;
      uy = L(1, 1) * dy + L(1, 2) * dz;
      uz = L(2, 2) * dz;
    }
    contact.u_n = ux * contact.nx + uy * contact.ny + uz * contact.nz;
    const Row& vi = field.motion[i];
    const Row& vj = field.motion[j];
    contact.rate = -((vi[0] - vj[0]) * contact.nx + (vi[1] - vj[1]) * contact.ny + (vi[2] - vj[2]) * contact.nz +
                     contact.u_n);
    contact.force = field.stiffness * contact.delta + field.viscosity * contact.rate;
    visit(contact);
  }
}

// A packing's contacts for such sums: whatever the engine, in double precision and in the order of the packing.

/// Position x = H s [m] with the radius.
Row place_with_radius(const Packing& packing, std::size_t i);

/// H n [m] of each image of the list.
std::vector<Eigen::Vector3d> image_shifts(const Eigen::Matrix3d& H, const NeighbourList& list);

/// What sums over the contacts of a state read; all arguments must outlive it.
ForceField force_field(const State& state, const CellMotion& motion, const NeighbourList& list,
                       const std::vector<Row>& place, const std::vector<Row>& velocity,
                       const std::vector<Eigen::Vector3d>& shift);

/// The contacts of a state for its velocities.
struct ContactView {
  NeighbourList list;
  std::vector<Row> place, velocity;
  std::vector<Eigen::Vector3d> shift;
  ForceField field;  ///< points into the members above and into the state
};

/// The state must outlive the view and stay as it is.
std::unique_ptr<ContactView> view_contacts(const State& state, NeighbourList list, const CellMotion& motion);

}  // namespace grainlaw::dem
