#include "dem/engine/force_pass.hpp"

namespace grainlaw::dem {
namespace {

template <bool wall_driven>
PassSums kernel(const ForceField& field, std::size_t begin, std::size_t end, Row* force, Row* viscous) {
  PassSums sums;
  for (std::size_t i = begin; i < end; ++i) {
    double fx = 0, fy = 0, fz = 0, gx = 0, gy = 0, gz = 0, box = 0, lost = 0, elastic = 0;
    visit_contacts<wall_driven>(field, i, [&](const Contact& c) {
      fx += c.force * c.nx;
      fy += c.force * c.ny;
      fz += c.force * c.nz;
      box -= c.force * c.u_n;
      const double g = field.viscosity * c.rate;
      gx += g * c.nx;
      gy += g * c.ny;
      gz += g * c.nz;
      lost -= g * c.u_n;
      elastic += c.delta * c.delta;
    });
    force[i] = {fx, fy, fz, 0};
    viscous[i] = {gx, gy, gz, 0};
    sums.box_power += 0.5 * box;
    sums.contact_power += 0.5 * lost;
    sums.E_pot += 0.25 * field.stiffness * elastic;
  }
  return sums;
}

}  // namespace

PassSums contact_forces(const ForceField& field, std::size_t begin, std::size_t end, Row* force, Row* viscous) {
  return field.wall_driven ? kernel<true>(field, begin, end, force, viscous) : kernel<false>(field, begin, end, force, viscous);
}

}  // namespace grainlaw::dem
