#include "dem/export/snapshot.hpp"

#include <algorithm>
#include <cmath>

#include "dem/engine/contacts.hpp"

namespace grainlaw::dem {

Snapshot snapshot_of(const State& state, const Eigen::Matrix3d& L) {
  Snapshot snapshot;
  snapshot.density = state.material.density;
  snapshot.time = state.time;
  snapshot.step = state.step;
  ThreadTeam team(1);
  const auto view =
      view_contacts(state, build_list(state.packing, 0, team), {state.packing.H, L, Transport::homogeneous});
  const Packing& p = state.packing;
  const bool plain = state.contacts.normal_force == NormalForce::hooke;
  const double mean = mean_radius(p);
  for (std::size_t i = 0; i < state.packing.size(); ++i) {
    visit_contacts<false>(view->field, i, [&](const Contact& c) {
      const Eigen::Vector3d n(c.nx, c.ny, c.nz);
      const double r_ij = p.radius[i] * p.radius[c.j] / (p.radius[i] + p.radius[c.j]),
                   elastic = elastic_force(state.material, state.contacts, mean, r_ij, c.delta),
                   force = plain ? c.force : c.force - state.material.stiffness * c.delta + elastic;
      if (c.j > i || (c.j == i && first_of_opposites(n)))
        snapshot.contacts.push_back({i, c.j, c.distance * n, force * n, c.delta});
    });
  }
  snapshot.packing = state.packing;
  wrap(snapshot.packing);
  return snapshot;
}

std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pieces_in_cell(const Snapshot& snapshot,
                                                                        const SnapshotContact& contact) {
  const Packing& p = snapshot.packing;
  const Eigen::Vector3d start(p.sx[contact.i], p.sy[contact.i], p.sz[contact.i]);
  const Eigen::Vector3d way = p.H.triangularView<Eigen::Upper>().solve(Eigen::Vector3d(-contact.branch));
  std::vector<double> cuts{0, 1};  // where it passes a face, as parts of the way
  for (int a = 0; a < 3; ++a) {
    const double end = start[a] + way[a];
    for (double face = std::floor(std::min(start[a], end)) + 1; face < std::max(start[a], end); ++face)
      cuts.push_back(std::clamp((face - start[a]) / way[a], 0.0, 1.0));
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pieces;
  for (std::size_t c = 1; c < cuts.size(); ++c) {
    if (cuts[c] == cuts[c - 1]) continue;
    const Eigen::Vector3d middle = start + 0.5 * (cuts[c - 1] + cuts[c]) * way;
    const Eigen::Vector3d image = middle.array().floor();
    pieces.emplace_back(p.H * (start + cuts[c - 1] * way - image), p.H * (start + cuts[c] * way - image));
  }
  return pieces;
}

}  // namespace grainlaw::dem
