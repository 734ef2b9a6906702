#include "dem/statics/contact_network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "dem/engine/neighbour_list.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr int kFewestContacts = 4;  // of a frictionless sphere that carries load

Eigen::Vector3d fraction(const Packing& p, std::size_t i) { return {p.sx[i], p.sy[i], p.sz[i]}; }

/// For each sphere the spheres that it touches, one entry for each contact.
std::vector<std::vector<std::uint32_t>> neighbours(const Packing& packing, int threads) {
  std::vector<std::vector<std::uint32_t>> touched(packing.size());
  for (const NetworkContact& c : contacts_at(packing, pairs_within(packing, 0, threads))) {
    touched[c.i].push_back(c.j);
    touched[c.j].push_back(c.i);
  }
  return touched;
}

std::vector<bool> carries_load(const Packing& packing, int threads) {
  const auto touched = neighbours(packing, threads);
  std::vector<bool> carries(packing.size(), true);
  std::vector<int> count(packing.size());
  std::vector<std::uint32_t> to_go;
  const auto judge = [&](std::uint32_t i) {
    if (!carries[i] || count[i] >= kFewestContacts) return;
    carries[i] = false;
    to_go.push_back(i);
  };
  for (std::uint32_t i = 0; i < packing.size(); ++i) count[i] = static_cast<int>(touched[i].size());
  for (std::uint32_t i = 0; i < packing.size(); ++i) judge(i);
  while (!to_go.empty()) {
    const std::uint32_t gone = to_go.back();
    to_go.pop_back();
    for (const std::uint32_t j : touched[gone]) {
      --count[j];
      judge(j);
    }
  }
  return carries;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> ends_of(const std::vector<NetworkContact>& contacts) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
  for (const NetworkContact& c : contacts) ends.emplace_back(c.i, c.j);
  std::sort(ends.begin(), ends.end());
  return ends;
}

}  // namespace

State backbone_of(const State& state, int threads) {
  const Packing& all = state.packing;
  const std::vector<bool> carries = carries_load(all, threads);
  State backbone;
  backbone.material = state.material;
  backbone.seed = state.seed;
  Packing& p = backbone.packing;
  p.H = all.H;
  resize(p, static_cast<std::size_t>(std::count(carries.begin(), carries.end(), true)));
  for (std::size_t i = 0, to = 0; i < all.size(); ++i) {
    if (!carries[i]) continue;
    p.id[to] = all.id[i];
    p.radius[to] = all.radius[i];
    p.mass[to] = all.mass[i];
    p.sx[to] = all.sx[i], p.sy[to] = all.sy[i], p.sz[to] = all.sz[i];
    ++to;
  }
  return backbone;
}

std::vector<NetworkPair> pairs_within(const Packing& packing, double skin, int threads) {
  ThreadTeam team(threads);
  const NeighbourList list = build_list(packing, skin, team);
  std::vector<NetworkPair> pairs;
  pairs.reserve(list.j.size() / 2);
  for (std::uint32_t i = 0; i < packing.size(); ++i) {
    for (std::size_t c = list.first[i]; c < list.first[i + 1]; ++c) {
      const std::uint32_t j = list.j[c];
      const Eigen::Vector3d& image = list.offset[list.image[c]];
      if (j > i || (j == i && first_of_opposites(image))) pairs.push_back({i, j, image});
    }
  }
  return pairs;
}

std::vector<NetworkContact> contacts_at(const Packing& p, const std::vector<NetworkPair>& pairs) {
  std::vector<NetworkContact> contacts;
  contacts.reserve(pairs.size());
  for (const auto& [i, j, image] : pairs) {
    const Eigen::Vector3d l = p.H * (fraction(p, i) - fraction(p, j) - image);
    const double reach = p.radius[i] + p.radius[j];
    if (!(l.squaredNorm() < reach * reach)) continue;
    const double d = l.norm();
    const Eigen::Vector3d n = l / d;
    if (!n.allFinite()) {
      throw Error(fmt::format("spheres {} and {} share one position; move one of them", p.id[i], p.id[j]));
    }
    contacts.push_back({i, j, n, d, reach - d});
  }
  return contacts;
}

NetworkForces forces_of(const std::vector<NetworkContact>& contacts, std::size_t spheres, double stiffness) {
  NetworkForces forces;
  forces.net = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(spheres));
  double overlap = 0;
  for (const NetworkContact& c : contacts) {
    const Eigen::Vector3d f = stiffness * c.delta * c.n;
    forces.net.col(c.i) += f;
    forces.net.col(c.j) -= f;
    overlap += c.delta;
  }
  if (spheres > 0) forces.max_net_force = std::sqrt(forces.net.colwise().squaredNorm().maxCoeff());
  if (!contacts.empty()) forces.mean_contact_force = stiffness * overlap / static_cast<double>(contacts.size());
  return forces;
}

Eigen::Matrix3d stress_of(const std::vector<NetworkContact>& contacts, double stiffness, double volume) {
  Eigen::Matrix3d virial = Eigen::Matrix3d::Zero();
  for (const NetworkContact& c : contacts) virial += stiffness * c.delta * c.d * c.n * c.n.transpose();
  return virial / volume;
}

std::pair<std::size_t, std::size_t> differing_contacts(const std::vector<NetworkContact>& before,
                                                       const std::vector<NetworkContact>& after) {
  const auto was = ends_of(before), is = ends_of(after);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> closed, opened;
  std::set_difference(is.begin(), is.end(), was.begin(), was.end(), std::back_inserter(closed));
  std::set_difference(was.begin(), was.end(), is.begin(), is.end(), std::back_inserter(opened));
  return {closed.size(), opened.size()};
}

}  // namespace grainlaw::dem
