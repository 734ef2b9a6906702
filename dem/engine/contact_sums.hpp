#pragma once
// The sums over contacts behind a packing's averages, Eqs. (5)-(10) and section 4.1 of the paper, for contacts of the
// engine and for those that somebody else gives (dem/foreign/): the one place where they are summed and units dropped.
//   sigma = (1/V) sum_c f l,  compression positive, l the branch vector x_ij, f the force on i (any direction)
//   F     = (1/V) sum_p V_p sum_{c in p} n n
//   M = contacts counted per sphere (twice in all), N4 spheres with >= 4 contacts, M4 contacts of those; one counting
//   pass, rattlers are not removed iteratively: C_r = M/N, C = M4/N, C* = M4/N4, phi_r = 1 - N4/N.
// <r> is the packing's own mean.

#include <Eigen/Core>
#include <cstdint>
#include <numbers>

#include "dem/engine/packing.hpp"
#include "model/vocabulary/observation.hpp"

namespace grainlaw::dem {

inline constexpr std::int64_t kMinBackboneContacts = 4;  ///< a frictionless sphere with fewer is a rattler

struct ContactSums {
  Eigen::Matrix3d virial = Eigen::Matrix3d::Zero();                        ///< sum_c f l, every contact once [J]
  Eigen::Matrix3d fabric = Eigen::Matrix3d::Zero();                        ///< sum_p V_p sum_c n n [m^3]
  double overlap = 0;                                                      ///< every contact twice [m]
  double elastic = 0;                                                      ///< energy of the contacts [J]
  std::int64_t contacts = 0, backbone_contacts = 0, backbone_spheres = 0;  ///< M, M4, N4
};

/// What one of its two spheres sees of a contact.
struct ContactShare {
  Eigen::Matrix3d nn;      ///< n n
  Eigen::Matrix3d virial;  ///< half of f l [J]
  double overlap = 0;      ///< delta [m]
  double elastic = 0;      ///< half of its energy [J]
};

/// Adds one sphere. `for_each_contact` calls what it is handed with the ContactShare of each of the sphere's contacts.
template <class ForEachContact>
void add_sphere(ContactSums& sums, double radius, const ForEachContact& for_each_contact) {
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  std::int64_t count = 0;
  for_each_contact([&](const ContactShare& share) {
    normals += share.nn;
    sums.virial += share.virial;
    sums.overlap += share.overlap;
    sums.elastic += share.elastic;
    ++count;
  });
  sums.fabric += 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * normals;
  sums.contacts += count;
  if (count >= kMinBackboneContacts) {
    sums.backbone_contacts += count;
    ++sums.backbone_spheres;
  }
}

ContactSums& operator+=(ContactSums& sums, const ContactSums& more);

/// Sets what the sums say of a packing: nu, stress, P_star = 2<r>/k tr(sigma)/3 with `stiffness` k [kg/s^2], fabric, their
/// ratios, shapes and angles, contact numbers, overlap. `N`: direction for s_par and F_par (zero: they are undefined).
void set_averages(Observation& row, const ContactSums& sums, const Packing& packing, double stiffness,
                  const Deviator<double>& N, bool portable);

/// (1/V) sum_p m v v of the packing's velocities [Pa].
Eigen::Matrix3d kinetic_stress(const Packing& packing);

/// max(|tr D|, |D|_dev) 2<r> sqrt(rho/P) of the velocity gradient L [1/s]; NaN unless the pressure P [Pa] is positive.
double inertial_number(const Eigen::Matrix3d& L, double P, double mean_radius, double density);

}  // namespace grainlaw::dem
