#include "dem/export/snapshot.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <set>

#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

// sum f l over the contacts, each once, is V sigma of Eq. (5); nothing of it depends on where the cell is cut.
TEST(Snapshot, HasEveryContactOnce) {
  scene::Draw draw(3);
  const State state = scene::random_state(300, 3, 0.8, scene::random_shape(1.5, 0.6, draw), draw);
  const Snapshot snapshot = snapshot_of(state, Eigen::Matrix3d::Zero());
  State moved = state;
  for (double& s : moved.packing.sx) s += 0.37;
  const Snapshot again = snapshot_of(moved, Eigen::Matrix3d::Zero());
  EXPECT_EQ(snapshot.contacts.size(), again.contacts.size());
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (const SnapshotContact& c : snapshot.contacts) {
    EXPECT_TRUE(pairs.insert({c.i, c.j}).second || snapshot.packing.size() < 50);
    EXPECT_NEAR(c.force.norm(), 1e8 * c.overlap, 1e-9 * c.force.norm());
    EXPECT_GT(c.force.dot(c.branch), 0);
  }
}

// A state says what contacts made it: their forces, and not k delta, are what is written.
TEST(Snapshot, ForcesAreThoseOfTheStatesContacts) {
  scene::Draw draw(3);
  State state = scene::random_state(300, 3, 0.8, scene::random_shape(1.5, 0.6, draw), draw);
  state.contacts.normal_force = NormalForce::hertz;
  const Snapshot snapshot = snapshot_of(state, Eigen::Matrix3d::Zero());
  ASSERT_FALSE(snapshot.contacts.empty());
  for (const SnapshotContact& c : snapshot.contacts) {
    const double a = state.packing.radius[c.i], b = state.packing.radius[c.j];
    const double hertz = state.material.stiffness / (2 * mean_radius(state.packing)) * std::sqrt(a * b / (a + b)) *
                         std::pow(c.overlap, 1.5);
    EXPECT_NEAR(c.force.dot(c.branch) / c.branch.norm(), hertz, 1e-9 * hertz);
  }
}

// Pieces lie in the cell, follow one another from x_i, and together are the branch vector.
TEST(Snapshot, PiecesMakeTheBranch) {
  scene::Draw draw(4);
  const State state = scene::random_state(40, 3, 0.8, scene::random_shape(1.5, 0.6, draw), draw);
  const Snapshot snapshot = snapshot_of(state, Eigen::Matrix3d::Zero());
  const Eigen::Matrix3d inverse = snapshot.packing.H.inverse();
  std::size_t most = 0;
  for (const SnapshotContact& c : snapshot.contacts) {
    const auto pieces = pieces_in_cell(snapshot, c);
    most = std::max(most, pieces.size());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& [from, to] : pieces) {
      sum += to - from;
      for (const Eigen::Vector3d& end : {from, to}) {
        const Eigen::Vector3d s = inverse * end;
        EXPECT_TRUE((s.array() > -1e-12).all() && (s.array() < 1 + 1e-12).all());
      }
    }
    EXPECT_LE((sum + c.branch).norm(), 1e-14);
    EXPECT_LE((pieces.front().first - snapshot.position(c.i)).norm(), 1e-14);
    const Eigen::Vector3d off = inverse * (pieces.back().second - snapshot.position(c.j));
    EXPECT_LE((off - Eigen::Vector3d(off.array().round())).norm(), 1e-12) << "ends in an image of x_j";
  }
  EXPECT_GE(most, 3u) << "some pass an edge of the cell";
}

}  // namespace
}  // namespace grainlaw::dem
