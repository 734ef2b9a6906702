#include "dem/statics/contact_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "dem/statics/relax.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

State relaxed(std::size_t n, double nu, std::uint64_t seed) {
  scene::Draw draw(seed);
  Eigen::Matrix3d shape = scene::cubic(1);
  shape(0, 2) = 0.1;
  State state = scene::random_state(n, 3, nu, shape, draw);
  EXPECT_TRUE(relax(state, {}, RelaxOptions{1e-9, 200000}, {}).relaxed);
  return state;
}

/// What is left when spheres with fewer than four contacts are taken away, one after the other, with the O(N^2) reference.
State without_rattlers(State state) {
  for (;;) {
    const ReferenceSums sums = reference_sums(state.packing, state.material, scene::at_rest(state));
    const auto rattler = std::find_if(sums.contacts.begin(), sums.contacts.end(), [](int c) { return c < 4; });
    if (rattler == sums.contacts.end()) return state;
    const auto at = rattler - sums.contacts.begin();
    Packing& p = state.packing;
    p.id.erase(p.id.begin() + at);
    for (auto* v : {&p.radius, &p.mass, &p.sx, &p.sy, &p.sz, &p.vx, &p.vy, &p.vz}) v->erase(v->begin() + at);
  }
}

TEST(ContactNetwork, RattlersAreTakenAwayUntilNoneIsLeft) {
  std::size_t taken = 0;
  for (const double nu : {0.4, 0.66, 0.7}) {
    const State state = relaxed(120, nu, 3), backbone = backbone_of(state, 2);
    EXPECT_EQ(backbone.packing.id, without_rattlers(state).packing.id) << "nu = " << nu;
    EXPECT_EQ(backbone.packing.H, state.packing.H);
    taken += state.packing.size() - backbone.packing.size();
  }
  EXPECT_GT(taken, 120u);
}

/// At rest hardly any sphere has three contacts; of spheres placed at random many have.
TEST(ContactNetwork, ASphereWithThreeContactsIsARattler) {
  scene::Draw draw(5);
  const State state = scene::random_state(200, 3, 0.8, scene::cubic(1), draw);
  const ReferenceSums sums = reference_sums(state.packing, state.material, scene::at_rest(state));
  EXPECT_GT(std::count(sums.contacts.begin(), sums.contacts.end(), 3), 10);
  const State backbone = backbone_of(state, 1);
  EXPECT_EQ(backbone.packing.id, without_rattlers(state).packing.id);
  EXPECT_GT(backbone.packing.size(), 20u);
}

TEST(ContactNetwork, ForcesAndStressAreThoseOfTheReference) {
  scene::Draw draw(7);
  const State state = scene::random_state(150, 3, 0.7, scene::random_shape(1.5, 0.3, draw), draw);
  const Packing& p = state.packing;
  const ReferenceSums sums = reference_sums(p, state.material, scene::at_rest(state));
  const auto contacts = contacts_at(p, pairs_within(p, 1e-4, 1));
  const NetworkForces forces = forces_of(contacts, p.size(), state.material.stiffness);
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_LE((forces.net.col(static_cast<Eigen::Index>(i)) - sums.force[i]).norm(), 1e-11 * sums.max_force);
  }
  EXPECT_NEAR(forces.mean_contact_force * static_cast<double>(contacts.size()), state.material.stiffness * sums.overlap,
              1e-12 * state.material.stiffness * sums.overlap);
  const Eigen::Matrix3d sigma = stress_of(contacts, state.material.stiffness, p.volume());
  EXPECT_LE((sigma * p.volume() - sums.virial).norm(), 1e-12 * sums.virial.norm());
}

TEST(ContactNetwork, ListsEachPairOnce) {
  scene::Draw draw(11);
  const State state = scene::random_state(100, 3, 0.7, scene::cubic(1), draw);
  EXPECT_EQ(pairs_within(state.packing, 2e-4, 1).size(), reference_pairs(state.packing, 2e-4).size());
  const State alone = scene::state_of(scene::cubic(1.9e-3), {{1e-3, {0, 0, 0}}});
  EXPECT_EQ(pairs_within(alone.packing, 0, 1).size(), 3u) << "own images: one pair for each axis";
}

TEST(ContactNetwork, CountsContactsThatCameAndWent) {
  const auto contact = [](std::uint32_t i, std::uint32_t j) { return NetworkContact{i, j, {0, 0, 1}, 1, 0.1}; };
  const std::vector<NetworkContact> before{contact(0, 1), contact(0, 2), contact(1, 2)};
  const std::vector<NetworkContact> after{contact(1, 3), contact(0, 1), contact(0, 1)};
  EXPECT_EQ(differing_contacts(before, after), std::pair(std::size_t{2}, std::size_t{2}));
  EXPECT_EQ(differing_contacts(before, before), std::pair(std::size_t{0}, std::size_t{0}));
}

TEST(ContactNetwork, RefusesTwoSpheresAtOnePlace) {
  const State state = scene::state_of(scene::cubic(1e-2), {{1e-3, {1e-3, 1e-3, 1e-3}}, {1e-3, {1e-3, 1e-3, 1e-3}}});
  EXPECT_THROW(contacts_at(state.packing, pairs_within(state.packing, 0, 1)), Error);
}

}  // namespace
}  // namespace grainlaw::dem
