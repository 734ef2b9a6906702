#pragma once
// The engine's neighbour list held against the plain pair list: nothing missed, nothing double, nothing invented.

#include <map>
#include <tuple>

#include "dem/engine/neighbour_list.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem::scene {

struct ListFaults {
  long missed = 0, twice = 0, invented = 0;
  long looked_for = 0;  ///< pairs that must be listed

  long total() const { return missed + twice + invented; }
};

using DirectedPair = std::tuple<std::size_t, std::size_t, long, long, long>;  ///< i, j, image offset n

inline std::map<DirectedPair, int> entries_of(const NeighbourList& list) {
  std::map<DirectedPair, int> entries;
  for (std::size_t i = 0; i + 1 < list.first.size(); ++i) {
    for (std::size_t c = list.first[i]; c < list.first[i + 1]; ++c) {
      const Eigen::Vector3d& n = list.offset[list.image[c]];
      ++entries[{i, list.j[c], std::lround(n.x()), std::lround(n.y()), std::lround(n.z())}];
    }
  }
  return entries;
}

/// Both directions of each pair of the plain list must be entries, once. Pairs whose distance is the cutoff to rounding
/// may or may not be there. `packing` is as the list saw it.
inline ListFaults compare(const NeighbourList& list, const Packing& packing) {
  ListFaults faults;
  std::map<DirectedPair, int> entries = entries_of(list);
  for (const auto& [pair, times] : entries) faults.twice += times > 1 ? 1 : 0;
  const double slack = 1e-12 * (2 * list.r_max + list.skin);
  for (const ReferencePair& pair : reference_pairs(packing, list.skin + slack)) {
    const double cutoff = packing.radius[pair.i] + packing.radius[pair.j] + list.skin;
    const bool sure = pair.x_ij.norm() < cutoff - slack;
    faults.looked_for += sure ? 1 : 0;
    const Eigen::Vector3i& n = pair.image;
    faults.missed += entries.erase({pair.i, pair.j, n.x(), n.y(), n.z()}) == 0 && sure ? 1 : 0;
    faults.missed += entries.erase({pair.j, pair.i, -n.x(), -n.y(), -n.z()}) == 0 && sure ? 1 : 0;
  }
  faults.invented = static_cast<long>(entries.size());
  return faults;
}

/// Touching pairs of `packing` that `list`, built earlier, does not know. Fractions must not have been wrapped since.
inline long contacts_missed(const NeighbourList& list, const Packing& packing) {
  long missed = 0;
  const std::map<DirectedPair, int> entries = entries_of(list);
  for (const ReferencePair& pair : reference_pairs(packing, 0)) {
    const Eigen::Vector3i& n = pair.image;
    missed += 1 - static_cast<long>(entries.count({pair.i, pair.j, n.x(), n.y(), n.z()}));
    missed += 1 - static_cast<long>(entries.count({pair.j, pair.i, -n.x(), -n.y(), -n.z()}));
  }
  return missed;
}

/// A random packing of few spheres in a sheared, flat or crowded cell (hard case D19).
inline State random_configuration(Draw& draw) {
  const auto n = static_cast<std::size_t>(draw.uniform(1, 14));
  const double w = draw.uniform(0, 1) < 0.2 ? 20 : draw.uniform(1, 4);
  const double nu = std::exp(draw.uniform(std::log(0.02), std::log(1.2)));
  Eigen::Matrix3d shape = random_shape(10, 0.6, draw);
  State state = random_state(n, w, nu, shape, draw);
  for (std::size_t i = 0; i < n; ++i) {  // also fractions outside of the cell
    place(state.packing, i, fraction(state.packing, i) + Eigen::Vector3d(draw.vector(-2, 3).array().floor()));
  }
  return state;
}

/// Faults of lists of `count` random configurations, and of the promise of allowed_displacement() afterwards.
inline ListFaults random_list_faults(int count, std::uint64_t seed) {
  Draw draw(seed);
  ThreadTeam team(1);
  ListFaults sum;
  for (int k = 0; k < count; ++k) {
    State state = random_configuration(draw);
    Packing& p = state.packing;
    const double skin = draw.uniform(0.02, 0.5) * mean_radius(p);
    const NeighbourList list = build_list(p, skin, team);
    const ListFaults faults = compare(list, p);
    sum.missed += faults.missed;
    sum.twice += faults.twice;
    sum.invented += faults.invented;
    sum.looked_for += faults.looked_for;

    // Strain the cell and move the spheres as far as the list allows: no contact may be unknown to it.
    const Eigen::Matrix3d ref_H = p.H;
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    const double strain = std::exp(draw.uniform(std::log(1e-4), std::log(0.2)));
    for (int a = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b) F(a, b) += draw.uniform(-strain, strain);
    }
    p.H = F * ref_H;
    const double allowed = allowed_displacement(list, ref_H, p.H);
    if (!(allowed > 0)) continue;
    const Eigen::Matrix3d inverse = p.H.triangularView<Eigen::Upper>().solve(Eigen::Matrix3d::Identity());
    for (std::size_t i = 0; i < p.size(); ++i) {
      place(p, i, fraction(p, i) + inverse * (0.999 * allowed * draw.vector(-1, 1).normalized()));
    }
    sum.missed += contacts_missed(list, p);
  }
  return sum;
}

}  // namespace grainlaw::dem::scene
