#include "dem/statics/relax.hpp"

#include <gtest/gtest.h>

#include "dem/engine/lanes/lane_pass.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

State overlapping(std::size_t n, double nu, std::uint64_t seed = 1, double w = 3) {
  scene::Draw draw(seed);
  return scene::random_state(n, w, nu, scene::cubic(1), draw);
}

ReferenceSums forces_at_rest(const State& state) {
  return reference_sums(state.packing, state.material, scene::at_rest(state));
}

double max_net_force(const ReferenceSums& sums) {
  double largest = 0;
  for (const Eigen::Vector3d& f : sums.force) largest = std::max(largest, f.norm());
  return largest;
}

double mean_contact_force(const ReferenceSums& sums, const Material& material) {
  double contacts = 0;
  for (const int count : sums.contacts) contacts += 0.5 * count;
  return material.stiffness * sums.overlap / contacts;
}

TEST(Relax, MeetsItsCriterionByThePlainReference) {
  for (const double w : {1.0, 3.0, 30.0}) {
    State state = overlapping(150, 0.75, 3, w);
    const Relaxation result = relax(state, {}, {}, {});
    const ReferenceSums sums = forces_at_rest(state);
    ASSERT_TRUE(result.relaxed) << "w = " << w;
    EXPECT_NEAR(result.mean_contact_force / mean_contact_force(sums, state.material), 1, 1e-9);
    EXPECT_LE(max_net_force(sums), 1.0001e-5 * mean_contact_force(sums, state.material));
    EXPECT_GT(sums.E_pot, 0);
  }
}

TEST(Relax, IsAMinimumOfTheElasticEnergy) {
  State state = overlapping(80, 0.75);
  const double before = forces_at_rest(state).E_pot;
  relax(state, {}, RelaxOptions{1e-9, 200000}, {});
  const double E = forces_at_rest(state).E_pot;
  EXPECT_LT(E, before);
  scene::Draw draw(5);
  for (int trial = 0; trial < 20; ++trial) {
    State moved = state;
    for (std::size_t i = 0; i < state.packing.size(); ++i) {
      scene::place(moved.packing, i, scene::fraction(state.packing, i) + draw.vector(-1e-6, 1e-6));
    }
    EXPECT_GT(forces_at_rest(moved).E_pot, E);
  }
}

// The same state, slightly disturbed, comes to rest at the same energy and pressure by drag. The energy is stationary
// there, so forces of 1e-6 leave an error of their square; the pressure's is of first order.
TEST(Relax, AgreesWithDynamics) {
  State relaxed = overlapping(60, 0.78, 11);
  relaxed.material.background_viscosity = 2;
  relax(relaxed, {}, RelaxOptions{1e-8, 200000}, {});
  scene::Draw draw(2);
  State disturbed = relaxed;
  for (std::size_t i = 0; i < disturbed.packing.size(); ++i) {
    scene::place(disturbed.packing, i, scene::fraction(relaxed.packing, i) + draw.vector(-2e-5, 2e-5));
  }
  State minimised = disturbed;
  ASSERT_TRUE(relax(minimised, {}, RelaxOptions{1e-8, 200000}, {}).relaxed);
  Simulation sim = scene::start(disturbed, 0.1);
  scene::advance_at_rest(sim, 40000);
  const ReferenceSums dynamic = forces_at_rest(sim.state()), minimal = forces_at_rest(minimised);
  ASSERT_LE(max_net_force(dynamic), 1e-6 * mean_contact_force(dynamic, relaxed.material))
      << "the dynamics is not at rest yet";
  EXPECT_NEAR(dynamic.E_pot / minimal.E_pot, 1, 1e-10);
  EXPECT_NEAR(dynamic.virial.trace() / minimal.virial.trace(), 1, 1e-6);
}

TEST(Relax, LeavesAStateAtRestThatRemembersNoMotion) {
  State state = overlapping(30, 0.7);
  scene::Draw draw(1);
  scene::random_velocities(state.packing, 1, draw);
  Simulation sim = scene::start(state, 0.1);
  sim.open_ledger();
  scene::advance_at_rest(sim, 10);
  state = sim.state();
  const Eigen::Matrix3d H = state.packing.H;
  relax(state, {}, {}, {});
  EXPECT_EQ(kinetic_energy(state.packing), 0);
  EXPECT_TRUE(state.ax.empty() && state.ref_x.empty());
  EXPECT_EQ(state.step, 0u);
  EXPECT_EQ(state.time, 0);
  EXPECT_EQ(state.ledger.E_start, 0);
  EXPECT_EQ(state.packing.H, H);
}

TEST(Relax, WithoutContactsThereIsNothingToDo) {
  for (State state : {State{}, overlapping(1, 0.3)}) {
    const Relaxation result = relax(state, {}, {}, {});
    EXPECT_TRUE(result.relaxed);
    EXPECT_EQ(result.max_net_force, 0);
    EXPECT_EQ(result.mean_contact_force, 0);
  }
}

TEST(Relax, BelowJammingTheLastOverlapsGo) {
  State state = overlapping(100, 0.5);
  const Relaxation result = relax(state, {}, {}, {});
  EXPECT_TRUE(result.relaxed);
  EXPECT_LE(result.mean_contact_force, 1e-10 * state.material.stiffness * mean_radius(state.packing));
}

TEST(Relax, SaysSoWhenItGivesUp) {
  State state = overlapping(100, 0.68);
  const Relaxation result = relax(state, {}, RelaxOptions{1e-5, 20}, {});
  EXPECT_FALSE(result.relaxed);
  EXPECT_EQ(result.passes, 20);
  EXPECT_GT(result.max_net_force, 1e-5 * result.mean_contact_force);
}

TEST(Relax, GivesTheSameBitsOnAnyNumberOfThreads) {
  State reference = overlapping(600, 0.7);
  const State start = reference;
  relax(reference, {}, RelaxOptions{1e-5, 200}, {});
  for (const int threads : {2, 3}) {
    State state = start;
    EngineOptions engine;
    engine.threads = threads;
    relax(state, engine, RelaxOptions{1e-5, 200}, {});
    EXPECT_EQ(state.packing.sx, reference.packing.sx) << threads << " threads";
    EXPECT_EQ(state.packing.sz, reference.packing.sz) << threads << " threads";
  }
}

TEST(Relax, GivesTheSameBitsOnAnyVectors) {
#ifdef GRAINLAW_ONE_VECTOR_SET
  GTEST_SKIP() << "one kind of vector instructions was compiled";
#endif
  const State start = overlapping(300, 0.7);
  std::vector<State> states;
  std::vector<Relaxation> results;
  for (const std::string& target : vector_targets()) {
    use_vector_target(target);
    states.push_back(start);
    results.push_back(relax(states.back(), {}, RelaxOptions{1e-5, 200}, {}));
  }
  use_vector_target("");
  ASSERT_GE(states.size(), 2u);
  for (std::size_t k = 1; k < states.size(); ++k) {
    EXPECT_EQ(states[k].packing.sx, states[0].packing.sx) << vector_targets()[k];
    EXPECT_EQ(states[k].packing.sz, states[0].packing.sz) << vector_targets()[k];
    EXPECT_EQ(results[k].E_after, results[0].E_after) << vector_targets()[k];
    EXPECT_EQ(results[k].mean_contact_force, results[0].mean_contact_force) << vector_targets()[k];
  }
}

TEST(Relax, NamesTwoSpheresAtOnePosition) {
  State state = overlapping(10, 0.3);
  state.packing.id[4] = 404;
  scene::place(state.packing, 7, scene::fraction(state.packing, 4));
  try {
    relax(state, {}, {}, {});
    FAIL() << "two spheres at one position were accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("404"), std::string::npos);
  }
}

TEST(Relax, RefusesImpossibleOptions) {
  State state = overlapping(10, 0.3);
  EXPECT_THROW(relax(state, {}, RelaxOptions{0, 100}, {}), InvalidInput);
  EXPECT_THROW(relax(state, {}, RelaxOptions{1e-5, 0}, {}), InvalidInput);
  EngineOptions engine;
  engine.skin = 0;
  EXPECT_THROW(relax(state, engine, {}, {}), InvalidInput);
}

TEST(Relax, StopsOnRequest) {
  State state = overlapping(100, 0.7);
  std::stop_source stop;
  stop.request_stop();
  RunControl control;
  control.stop = stop.get_token();
  EXPECT_THROW(relax(state, {}, {}, control), Interrupted);
}

}  // namespace
}  // namespace grainlaw::dem
