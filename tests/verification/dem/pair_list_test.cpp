// D19: the neighbour list against all pairs: 0 missed, 0 double, in cells with aspect up to 10, shear up to 0.6 and
// volume fractions up to 1.2 (the test of 10^6 configurations is in tests/long). Also after the cell has been strained
// and the spheres have moved as far as allowed_displacement() says, and along a run that shears and collapses.

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "dem/engine/averages.hpp"
#include "dem/engine/lanes/lane_list.hpp"
#include "tests/support/dem_compression.hpp"
#include "tests/support/dem_families.hpp"
#include "tests/support/dem_pair_list.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using scene::Draw;
using scene::Family;
using scene::ListFaults;
using testing::expect_figure;

TEST(PairList, D19RandomConfigurations) {
  const ListFaults faults = scene::random_list_faults(20000, 41);
  expect_figure("D19.missed.20000", static_cast<double>(faults.missed), 0);
  expect_figure("D19.double.20000", static_cast<double>(faults.twice), 0);
  expect_figure("D19.invented.20000", static_cast<double>(faults.invented), 0);
}

class PairListOfFamily : public ::testing::TestWithParam<Family> {};

TEST_P(PairListOfFamily, D19D20LargerPackings) {
  Draw draw(43);
  ThreadTeam team(2);
  long faults_of_all = 0;
  for (const double nu : {0.1, 0.7, 1.2}) {
    for (int k = 0; k < 3; ++k) {
      Family family = GetParam();
      family.shape = scene::random_shape(10, 0.6, draw);
      const State state = scene::state_of_family(family, 300, nu, draw);
      const double skin = 0.1 * mean_radius(state.packing);
      const ListFaults faults = scene::compare(build_list(state.packing, skin, team), state.packing);
      EXPECT_EQ(faults.total(), 0) << "missed " << faults.missed << ", double " << faults.twice << ", invented "
                                   << faults.invented << " at nu " << nu;
      faults_of_all += faults.total();
    }
  }
  expect_figure(scene::figure_name("D19.faults", GetParam()), static_cast<double>(faults_of_all), 0);
}

TEST_P(PairListOfFamily, SmallSpheresInAGrowingCell) {
  // In a growing cell the gap to an unlisted neighbour grows least for the smallest spheres.
  Draw draw(47);
  ThreadTeam team(1);
  const State state = scene::state_of_family(GetParam(), 150, 0.5, draw);
  const Packing& p = state.packing;
  const Eigen::Matrix3d ref_H = p.H;
  for (const double skin_fraction : {0.02, 0.1, 0.3}) {
    const NeighbourList list = build_list(p, skin_fraction * mean_radius(p), team);
    for (const double stretch : {1.01, 1.1, 1.3}) {
      State moved = state;
      moved.packing.H = stretch * ref_H;
      const double allowed = allowed_displacement(list, ref_H, moved.packing.H);
      ASSERT_GT(allowed, 0);
      const Eigen::Matrix3d inverse = moved.packing.H.triangularView<Eigen::Upper>().solve(Eigen::Matrix3d::Identity());
      for (int k = 0; k < 5; ++k) {
        for (std::size_t i = 0; i < p.size(); ++i) {
          const Eigen::Vector3d step = 0.999 * allowed * draw.vector(-1, 1).normalized();
          scene::place(moved.packing, i, scene::fraction(p, i) + inverse * step);
        }
        ASSERT_EQ(scene::contacts_missed(list, moved.packing), 0)
            << "stretch " << stretch << ", skin " << skin_fraction;
      }
    }
  }
}

TEST_P(PairListOfFamily, D19AlongARunThatShearsAndCollapses) {
  // Volume fraction 0.3 to 1.2 with 60 % shear; the engine's contacts are counted against all pairs every 50 steps.
  Draw draw(53);
  State state = scene::state_of_family(GetParam(), 40, 0.3, draw, {2000, 1e8, 0.1, 0});
  scene::random_velocities(state.packing, 5, draw);
  const Eigen::Matrix3d H_0 = state.packing.H;
  Simulation sim = scene::start(state, 0.1);
  const int steps = 4000;
  const double shrink = std::log(4.0) / 3 / steps, shear = 0.6 / steps;
  const auto motion = [&](double k) {
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity(), L = Eigen::Matrix3d::Zero();
    F(0, 2) = shear * k;
    L(0, 2) = shear / sim.dt();
    L.diagonal().setConstant(-shrink / sim.dt());
    return CellMotion{std::exp(-shrink * k) * F * H_0, L, Transport::homogeneous};
  };
  long missed = 0;
  for (int k = 0; k < steps; ++k) {
    scene::step(sim, motion(k + 0.5), motion(k + 1));
    if (k % 50 == 0) missed += scene::contacts_missed(scene::list_of(sim), sim.state().packing);
  }
  expect_figure(scene::figure_name("D19.missed_in_collapse", GetParam()), static_cast<double>(missed), 0);
  EXPECT_NEAR(volume_fraction(sim.state().packing), 1.2, 1e-9);
  EXPECT_GT(sim.rebuilds(), 3U);
}

struct NearFaults {
  long missed = 0, listed = 0, looked = 0, picks = 0;
};

/// On lanes, at a constant rate of strain a step: of spheres that touch after every `every`th step, how many the near ones lack.
NearFaults near_faults(const State& state, Precision precision, const Eigen::Vector3d& rate, int steps, int every) {
  EngineOptions options;
  options.precision = precision;
  Simulation sim(state, options, scene::at_rest(state));
  const auto motion = [&](double k) {
    const Eigen::Vector3d F = (rate * k).array().exp();
    return CellMotion{F.asDiagonal() * state.packing.H, (rate / sim.dt()).asDiagonal(), Transport::homogeneous};
  };
  NearFaults sum;
  for (int k = 0; k < steps; ++k) {
    const std::int64_t last_pick = sim.lanes()->near_step;
    sim.advance(motion(k + 0.5), motion(k + 1));
    sum.picks += sim.lanes()->near_step == last_pick ? 0 : 1;
    if (k % every != 0) continue;
    const NeighbourList near = sim.neighbours(Listed::near);
    sum.missed += scene::contacts_missed(near, sim.state().packing);
    sum.listed += static_cast<long>(near.j.size());
    ++sum.looked;
  }
  return sum;
}

class NearPairs : public ::testing::TestWithParam<Precision> {
 protected:
  std::string name(const std::string& what) const {
    return "D19.near_missed." + what + (GetParam() == Precision::mixed ? ".mixed" : ".double");
  }
};

TEST_P(NearPairs, D19OfSpheresThatFlyThroughAPacking) {
  State state = scene::jammed({"Paper", 3}, 200, 0.70, 11);
  Draw draw(59);
  scene::random_velocities(state.packing, 1, draw);
  for (std::size_t i = 0; i < state.packing.size(); i += 60) state.packing.vx[i] = 100;
  const NearFaults faults = near_faults(state, GetParam(), {2e-5, -4e-5, -1e-5}, 2000, 11);
  expect_figure(name("flying"), static_cast<double>(faults.missed), 0);
  EXPECT_GT(faults.listed, 200 * faults.looked);
  EXPECT_GT(faults.picks, 20);
  EXPECT_LT(faults.picks, 1000) << "at every other step: the skins are of no use";
}

// A lattice at rest in a cell that is pressed along x until its spheres touch: only the cell moves.
TEST_P(NearPairs, D19OfSpheresThatTheCellBringsTogether) {
  const int n = 6;
  const double r = 1e-3, apart = 2.1 * r;
  std::vector<scene::Sphere> lattice;
  for (int i = 0; i < n * n * n; ++i) lattice.push_back({r, apart * Eigen::Vector3d(i / (n * n), i / n % n, i % n)});
  const NearFaults faults =
      near_faults(scene::state_of(scene::cubic(n * apart), lattice), GetParam(), {-1e-3, 2e-4, 0}, 80, 1);
  expect_figure(name("pressed"), static_cast<double>(faults.missed), 0);
  EXPECT_GT(faults.listed, 20 * 2 * n * n * n) << "they have not met for some 20 steps";
  EXPECT_LT(faults.picks, 20);
}

std::string name_of_precision(const ::testing::TestParamInfo<Precision>& run) {
  return run.param == Precision::mixed ? "mixed" : "double";
}

INSTANTIATE_TEST_SUITE_P(D19, NearPairs, ::testing::Values(Precision::mixed, Precision::full), name_of_precision);
INSTANTIATE_TEST_SUITE_P(D20, PairListOfFamily, ::testing::ValuesIn(scene::families()), scene::name_of_family);

}  // namespace
}  // namespace grainlaw::dem
