#include "dem/force_pass.hpp"

namespace grainlaw::dem {
namespace {

template <bool wall_driven>
PassSums kernel(const ForceField& field, std::size_t begin, std::size_t end, Row* out) {
  PassSums sums;
  for (std::size_t i = begin; i < end; ++i) {
    double fx = 0, fy = 0, fz = 0, box = 0, lost = 0, elastic = 0;
    visit_contacts<wall_driven>(field, i, [&](const Contact& c) {
      fx += c.force * c.nx;
      fy += c.force * c.ny;
      fz += c.force * c.nz;
      box -= c.force * c.u_n;
      lost += field.viscosity * c.rate * c.rate;
      elastic += c.delta * c.delta;
    });
    out[i] = {fx, fy, fz, 0};
    sums.box_power += 0.5 * box;
    sums.contact_power += 0.5 * lost;
    sums.E_pot += 0.25 * field.stiffness * elastic;
  }
  return sums;
}

}  // namespace

PassSums contact_forces(const ForceField& field, std::size_t begin, std::size_t end, Row* out) {
  return field.wall_driven ? kernel<true>(field, begin, end, out) : kernel<false>(field, begin, end, out);
}

}  // namespace grainlaw::dem
