#include "dem/engine/averages.hpp"

#include <algorithm>

#include "dem/engine/state.hpp"

namespace grainlaw::dem {
namespace {

template <bool wall_driven>
ContactSums sum_spheres(const ForceField& field, const std::vector<double>& radius, std::size_t begin,
                        std::size_t end) {
  ContactSums sums;
  for (std::size_t i = begin; i < end; ++i) {
    add_sphere(sums, radius[i], [&](const auto& add) {
      visit_contacts<wall_driven>(field, i, [&](const Contact& c) {
        const Eigen::Vector3d n(c.nx, c.ny, c.nz);
        ContactShare share{n * n.transpose(), {}, c.delta, 0.25 * field.stiffness * c.delta * c.delta};
        share.virial = 0.5 * c.force * c.distance * share.nn;
        add(share);
      });
    });
  }
  return sums;
}

}  // namespace

ContactSums sum_contacts(const ForceField& field, const std::vector<double>& radius, ThreadTeam& team) {
  std::vector<ContactSums> parts(block_count(radius.size()));
  team.for_each_block(parts.size(), [&](std::size_t block) {
    const std::size_t begin = block * kBlockSize, end = std::min(radius.size(), begin + kBlockSize);
    parts[block] = field.wall_driven ? sum_spheres<true>(field, radius, begin, end)
                                     : sum_spheres<false>(field, radius, begin, end);
  });
  ContactSums total;
  for (const ContactSums& part : parts) total += part;
  return total;
}

Observation observe(Simulation& sim, const CellMotion& motion, const Deviator<double>& N) {
  const State& state = sim.state();
  const Packing& p = state.packing;
  const Material& material = state.material;

  Observation row;
  row.time = state.time;
  const std::unique_ptr<ContactView> view = view_contacts(sim, motion);  // current velocities, not those predicted
  const ContactSums sums = sum_contacts(view->field, p.radius, sim.team());
  set_averages(row, sums, p, material.stiffness, N, sim.options().portable_bits);
  row.stress_kinetic.tensor = kinetic_stress(p);

  row.E_kin = kinetic_energy(p);
  row.E_pot = sums.elastic;
  row.W_box = state.ledger.W_box;
  row.D_contact = state.ledger.D_contact;
  row.D_background = state.ledger.D_background;
  row.energy_residual = energy_residual(state);
  row.inertial_number = inertial_number(motion.L, row.stress.tensor.trace() / 3, mean_radius(p), material.density);
  return row;
}

}  // namespace grainlaw::dem
