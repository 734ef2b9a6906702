#include "dem/engine/contact_sums.hpp"

#include <algorithm>
#include <cmath>

namespace grainlaw::dem {
namespace {

double ratio(double numerator, double denominator) {
  return denominator > 0 ? numerator / denominator : Observation::undefined;
}

}  // namespace

ContactSums& operator+=(ContactSums& sums, const ContactSums& more) {
  sums.virial += more.virial;
  sums.fabric += more.fabric;
  sums.overlap += more.overlap;
  sums.elastic += more.elastic;
  sums.contacts += more.contacts;
  sums.backbone_contacts += more.backbone_contacts;
  sums.backbone_spheres += more.backbone_spheres;
  return sums;
}

void set_averages(Observation& row, const ContactSums& sums, const Packing& p, double stiffness,
                  const Deviator<double>& N, bool portable) {
  const double V = p.volume();
  const double spheres = static_cast<double>(p.size());
  const double mean_r = mean_radius(p);

  row.nu = volume_fraction(p);
  row.stress.tensor = sums.virial / V;
  row.fabric.tensor = sums.fabric / V;
  const double P = set_following(row, N);
  row.P_star = p.size() > 0 ? 2 * mean_r / stiffness * P : 0;
  row.shape_stress = shape_factor(-row.stress.tensor);
  row.lode_stress = lode_angle(-row.stress.tensor, portable);
  row.shape_fabric = shape_factor(-row.fabric.tensor);
  row.lode_fabric = lode_angle(-row.fabric.tensor, portable);

  const double M = static_cast<double>(sums.contacts), M4 = static_cast<double>(sums.backbone_contacts),
               N4 = static_cast<double>(sums.backbone_spheres);
  row.C_r = ratio(M, spheres);
  row.C = ratio(M4, spheres);
  row.C_star = ratio(M4, N4);
  row.rattler_fraction = ratio(spheres - N4, spheres);
  row.mean_overlap = ratio(sums.overlap, M * mean_r);
}

Eigen::Matrix3d kinetic_stress(const Packing& p) {
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d v(p.vx[i], p.vy[i], p.vz[i]);
    tensor += p.mass[i] * v * v.transpose();
  }
  return tensor / p.volume();
}

double inertial_number(const Eigen::Matrix3d& L, double P, double mean_r, double density) {
  const Eigen::Matrix3d D = 0.5 * (L + L.transpose());
  const double rate = std::max(std::abs(D.trace()), deviatoric_norm(D));
  return P > 0 ? rate * 2 * mean_r * std::sqrt(density / P) : Observation::undefined;
}

}  // namespace grainlaw::dem
