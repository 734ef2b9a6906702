#include "dem/engine/averages.hpp"

#include <algorithm>
#include <cmath>

#include "dem/engine/state.hpp"

namespace grainlaw::dem {
namespace {

constexpr std::int64_t kMinBackboneContacts = 4;  // a frictionless sphere with fewer is a rattler

struct ContactSums {
  Eigen::Matrix3d virial = Eigen::Matrix3d::Zero();  // sum_c f n l, every contact once
  Eigen::Matrix3d fabric = Eigen::Matrix3d::Zero();  // sum_p V_p sum_c n n
  double overlap = 0;                                // every contact twice
  double elastic = 0;
  std::int64_t contacts = 0, backbone_contacts = 0, backbone_spheres = 0;  // M, M4, N4
};

template <bool wall_driven>
ContactSums sum_contacts(const ForceField& field, const std::vector<double>& radius, std::size_t begin,
                         std::size_t end) {
  ContactSums sums;
  for (std::size_t i = begin; i < end; ++i) {
    Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
    std::int64_t count = 0;
    visit_contacts<wall_driven>(field, i, [&](const Contact& c) {
      const Eigen::Vector3d n(c.nx, c.ny, c.nz);
      const Eigen::Matrix3d nn = n * n.transpose();
      normals += nn;
      sums.virial += 0.5 * c.force * c.distance * nn;
      sums.overlap += c.delta;
      sums.elastic += 0.25 * field.stiffness * c.delta * c.delta;
      ++count;
    });
    sums.fabric += 4.0 / 3.0 * std::numbers::pi * radius[i] * radius[i] * radius[i] * normals;
    sums.contacts += count;
    if (count >= kMinBackboneContacts) {
      sums.backbone_contacts += count;
      ++sums.backbone_spheres;
    }
  }
  return sums;
}

ContactSums sum_contacts(Simulation& sim, const CellMotion& motion) {
  const Packing& p = sim.state().packing;
  const std::unique_ptr<ContactView> view = view_contacts(sim, motion);  // current velocities, not those predicted
  const ForceField& field = view->field;
  std::vector<ContactSums> parts(block_count(p.size()));
  sim.team().for_each_block(parts.size(), [&](std::size_t block) {
    const std::size_t begin = block * kBlockSize, end = std::min(p.size(), begin + kBlockSize);
    parts[block] = field.wall_driven ? sum_contacts<true>(field, p.radius, begin, end)
                                     : sum_contacts<false>(field, p.radius, begin, end);
  });
  ContactSums total;
  for (const ContactSums& part : parts) {
    total.virial += part.virial;
    total.fabric += part.fabric;
    total.overlap += part.overlap;
    total.elastic += part.elastic;
    total.contacts += part.contacts;
    total.backbone_contacts += part.backbone_contacts;
    total.backbone_spheres += part.backbone_spheres;
  }
  return total;
}

Eigen::Matrix3d kinetic_tensor(const Packing& p) {
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d v(p.vx[i], p.vy[i], p.vz[i]);
    tensor += p.mass[i] * v * v.transpose();
  }
  return tensor;
}

double ratio(double numerator, double denominator) {
  return denominator > 0 ? numerator / denominator : Observation::undefined;
}

}  // namespace

Observation observe(Simulation& sim, const CellMotion& motion, const Deviator<double>& N) {
  const State& state = sim.state();
  const Packing& p = state.packing;
  const Material& material = state.material;
  const ContactSums sums = sum_contacts(sim, motion);
  const double V = p.volume();
  const double spheres = static_cast<double>(p.size());
  const double mean_r = mean_radius(p);

  Observation row;
  row.time = state.time;
  row.nu = volume_fraction(p);
  row.stress.tensor = sums.virial / V;
  row.stress_kinetic.tensor = kinetic_tensor(p) / V;
  const double P = row.stress.tensor.trace() / 3;
  row.P_star = p.size() > 0 ? 2 * mean_r / material.stiffness * P : 0;
  row.shape_stress = shape_factor(-row.stress.tensor);
  row.lode_stress = lode_angle(-row.stress.tensor, sim.options().portable_bits);

  row.fabric.tensor = sums.fabric / V;
  row.F_v = row.fabric.tensor.trace();
  set_ratios(row, P, deviator<double>(row.stress.tensor), deviator<double>(row.fabric.tensor), N);
  row.shape_fabric = shape_factor(-row.fabric.tensor);
  row.lode_fabric = lode_angle(-row.fabric.tensor, sim.options().portable_bits);

  const double M = static_cast<double>(sums.contacts), M4 = static_cast<double>(sums.backbone_contacts),
               N4 = static_cast<double>(sums.backbone_spheres);
  row.C_r = ratio(M, spheres);
  row.C = ratio(M4, spheres);
  row.C_star = ratio(M4, N4);
  row.rattler_fraction = ratio(spheres - N4, spheres);
  row.mean_overlap = ratio(sums.overlap, M * mean_r);

  row.E_kin = kinetic_energy(p);
  row.E_pot = sums.elastic;
  row.W_box = state.ledger.W_box;
  row.D_contact = state.ledger.D_contact;
  row.D_background = state.ledger.D_background;
  row.energy_residual = energy_residual(state);

  const Eigen::Matrix3d D = 0.5 * (motion.L + motion.L.transpose());
  const double rate = std::max(std::abs(D.trace()), deviatoric_norm(D));
  row.inertial_number = P > 0 ? rate * 2 * mean_r * std::sqrt(material.density / P) : Observation::undefined;
  return row;
}

}  // namespace grainlaw::dem
