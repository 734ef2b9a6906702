#include "dem/engine/contacts.hpp"

#include <utility>

namespace grainlaw::dem {

Row place_with_radius(const Packing& p, std::size_t i) {
  const Eigen::Matrix3d& H = p.H;
  const double sx = p.sx[i], sy = p.sy[i], sz = p.sz[i];
  return {H(0, 0) * sx + H(0, 1) * sy + H(0, 2) * sz, H(1, 1) * sy + H(1, 2) * sz, H(2, 2) * sz, p.radius[i]};
}

std::vector<Eigen::Vector3d> image_shifts(const Eigen::Matrix3d& H, const NeighbourList& list) {
  std::vector<Eigen::Vector3d> shift;
  for (const Eigen::Vector3d& n : list.offset) shift.push_back(H * n);
  return shift;
}

ForceField force_field(const State& state, const CellMotion& motion, const NeighbourList& list,
                       const std::vector<Row>& place, const std::vector<Row>& velocity,
                       const std::vector<Eigen::Vector3d>& shift) {
  const Packing& p = state.packing;
  const Material& material = state.material;
  return {&list,
          place.data(),
          velocity.data(),
          p.sx.data(),
          p.sy.data(),
          p.sz.data(),
          shift.data(),
          p.id.data(),
          p.H,
          motion.L,
          material.stiffness,
          material.contact_viscosity,
          motion.transport == Transport::wall};
}

std::unique_ptr<ContactView> view_contacts(const State& state, NeighbourList list, const CellMotion& motion) {
  const Packing& p = state.packing;
  auto view = std::make_unique<ContactView>();
  view->list = std::move(list);
  view->shift = image_shifts(p.H, view->list);
  view->place.resize(p.size());
  view->velocity.resize(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    view->place[i] = place_with_radius(p, i);
    view->velocity[i] = {p.vx[i], p.vy[i], p.vz[i], 0};
  }
  view->field = force_field(state, motion, view->list, view->place, view->velocity, view->shift);
  return view;
}

}  // namespace grainlaw::dem
