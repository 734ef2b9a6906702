#include "dem/engine/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "dem/engine/averages.hpp"
#include "dem/engine/state.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_collision.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

using scene::force_on;

const Eigen::Matrix3d kBox = scene::cubic(20e-3);

/// Two spheres of 1 mm with an overlap of 0.1 mm along `line`, which need not be a unit vector.
State touching(const Eigen::Vector3d& line, const Eigen::Vector3d& v_0, const Material& material = {}) {
  const Eigen::Vector3d x(7e-3, 8e-3, 9e-3);
  return scene::state_of(kBox, {{1e-3, x + 1.9e-3 * line.normalized(), v_0}, {1e-3, x}}, material);
}

std::string message_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(StartSimulation, StepIsAFractionOfTheShortestCollision) {
  const State state = touching({1, 0, 0}, {0, 0, 0});
  const double t_c = collision_time(state.material, state.packing.mass[0] / 2);
  EXPECT_DOUBLE_EQ(scene::start(state, 0.1).dt(), 0.1 * t_c);
  EXPECT_DOUBLE_EQ(scene::start(state, 0.02).dt(), 0.02 * t_c);
}

// f = k delta - gamma (v_i - v_j).n on i along n, minus gamma_b v_i; the second sphere rests.
TEST(StartSimulation, FirstForcesFollowTheContactLaw) {
  const Material material{2000, 1e8, 2, 0.3};
  const Eigen::Vector3d n = Eigen::Vector3d(1, -2, 2) / 3, v(3, 1, -2);
  Simulation sim = scene::start(touching(n, v, material));
  const double f = 1e8 * 0.1e-3 - 2 * v.dot(n);
  EXPECT_LE((force_on(sim, 0) - (f * n - 0.3 * v)).norm(), 1e-11 * f);
  EXPECT_LE((force_on(sim, 1) + f * n).norm(), 1e-11 * f);
  EXPECT_NEAR(sim.state().sums.E_pot, 0.5 * 1e8 * 1e-8, 1e-11);
  EXPECT_NEAR(sim.state().sums.contact_power, 2 * std::pow(v.dot(n), 2), 1e-10);
  EXPECT_NEAR(sim.state().sums.drag_power, 0.3 * 14, 1e-12);
  EXPECT_EQ(sim.state().sums.box_power, 0);
}

TEST(StartSimulation, CellMotionAddsToTheRate) {
  // d(delta)/dt = -(L x_ij).n with the image's offset: the contact reaches across the face.
  const Material material{2000, 1e8, 2, 0};
  State state = scene::state_of(kBox, {{1e-3, {0.4e-3, 5e-3, 5e-3}}, {1e-3, {18.5e-3, 5e-3, 5e-3}}}, material);
  CellMotion motion = scene::at_rest(state);
  motion.L(0, 0) = -500;
  motion.L(0, 1) = 70;  // no part along n: x_ij has no y
  Simulation sim(state, scene::engine_options(), motion);
  const double f = 1e8 * 0.1e-3 + 2 * 500 * 1.9e-3;
  EXPECT_NEAR(force_on(sim, 0).x(), f, 1e-10 * f);
  EXPECT_NEAR(force_on(sim, 1).x(), -f, 1e-10 * f);
  EXPECT_NEAR(sim.state().sums.box_power, f * 500 * 1.9e-3, 1e-10 * f);
  EXPECT_NEAR(sim.state().sums.contact_power, 2 * std::pow(500 * 1.9e-3, 2), 1e-10);

  motion.transport = Transport::wall;  // the image moves with the edge: u = L H n over one whole cell
  Simulation wall(state, scene::engine_options(), motion);
  EXPECT_NEAR(force_on(wall, 0).x(), 1e8 * 0.1e-3 + 2 * 500 * 20e-3, 1e-6);
}

TEST(StartSimulation, ViscousForceMayTurnAttractive) {
  Simulation sim = scene::start(touching({1, 0, 0}, {2e4, 0, 0}, {2000, 1e8, 1, 0}));
  EXPECT_NEAR(force_on(sim, 0).x(), 1e8 * 0.1e-3 - 2e4, 1e-6);
}

TEST(StartSimulation, RefusesBadSteps) {
  const State state = touching({1, 0, 0}, {0, 0, 0});
  for (const double fraction :
       {0.0, -0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(scene::start(state, fraction), InvalidInput) << fraction;
  }
  const State overdamped = touching({1, 0, 0}, {0, 0, 0}, {2000, 1e8, 100, 0});
  EXPECT_NE(message_of([&] { scene::start(overdamped); }).find("contact_viscosity"), std::string::npos);
}

TEST(StartSimulation, RefusesDamagedPackings) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto refusal = [](const std::function<void(State&)>& damage) {
    State state = touching({1, 0, 0}, {0, 0, 0});
    damage(state);
    return message_of([&] { scene::start(state); });
  };
  const auto expect = [&](const char* words, const std::function<void(State&)>& damage) {
    EXPECT_NE(refusal(damage).find(words), std::string::npos) << words << " in: " << refusal(damage);
  };
  EXPECT_EQ(refusal([](State&) {}), "no error");
  for (const double bad : {-1e-3, 0.0, nan, inf}) {
    expect("sphere 1: radius", [&](State& s) { s.packing.radius[1] = bad; });
    expect("sphere 1: mass", [&](State& s) { s.packing.mass[1] = bad; });
    for (int i = 0; i < 3; ++i) expect("cell: ", [&](State& s) { s.packing.H(i, i) = bad; });
  }
  for (const double bad : {nan, inf}) {
    expect("sphere 1: position", [&](State& s) { s.packing.sy[1] = bad; });
    expect("sphere 1: velocity", [&](State& s) { s.packing.vz[1] = bad; });
    expect("cell: ", [&](State& s) { s.packing.H(0, 2) = bad; });
  }
  expect("cell: ", [](State& s) { s.packing.H(1, 0) = 1e-3; });
  for (const double tiny : {1e-300, 1e-9, 0.4e-3})
    expect("does not fit a cell", [&](State& s) { s.packing.H(2, 2) = tiny; });
  expect("does not fit a cell", [](State& s) { s.packing.H = scene::cubic(1e-30); });
  expect("fill ", [](State& s) { s.packing.H = scene::cubic(1.5e-3); });
  for (const double bad : {-1.0, nan, inf}) {
    expect("stiffness: ", [&](State& s) { s.material.stiffness = bad; });
    expect("contact_viscosity: ", [&](State& s) { s.material.contact_viscosity = bad; });
    expect("background_viscosity: ", [&](State& s) { s.material.background_viscosity = bad; });
    expect("density: ", [&](State& s) { s.material.density = bad; });
  }
  CellMotion motion = scene::at_rest(touching({1, 0, 0}, {0, 0, 0}));
  motion.L(0, 1) = nan;
  EXPECT_NE(message_of([&] {
              Simulation(touching({1, 0, 0}, {0, 0, 0}), scene::engine_options(), motion);
            }).find("cell: its velocity gradient"),
            std::string::npos);
}

/// Two spheres and their images in a row, all in contact, whose distance is off by 1e-9 m; the largest distance off after
/// 2000 steps of dt. Each sphere has two contacts: the motion is that of a pair of half the reduced mass.
double growth(double damping, double over_stable) {
  Material material{2000, 1e8, 0, 0};
  const double m_ij = sphere_mass(material, 1e-3) / 2;
  material.contact_viscosity = damping * 2 * std::sqrt(material.stiffness * m_ij);
  State state = scene::state_of(Eigen::Vector3d(3.8e-3, 20e-3, 20e-3).asDiagonal(),
                                {{1e-3}, {1e-3, {1.9e-3 + 1e-9, 0, 0}}}, material);
  const double dt = over_stable * stable_time_step(material, m_ij / 2);
  Simulation sim = scene::start(state, dt / collision_time(material, m_ij));
  EXPECT_NEAR(sim.dt(), dt, 1e-12 * dt);
  double farthest = 0;
  for (int k = 0; k < 2000; ++k) {
    scene::advance_at_rest(sim, 1);
    const Packing& p = sim.state().packing;
    if (k > 100) farthest = std::max(farthest, std::abs((p.sx[1] - p.sx[0]) * 3.8e-3 - 1.9e-3));
  }
  return farthest / 1e-9;
}

// The bound is sharp at any damping: 3 % below, motion dies out (without damping it stays), 3 % above it grows until
// contacts are lost.
TEST(StartSimulation, StableStepsAreKnownAtAnyDamping) {
  for (const double damping : {0.0, 0.069, 0.3, 0.7, 0.9, 0.99}) {
    EXPECT_LT(growth(damping, 0.97), 10) << damping;
    EXPECT_GT(growth(damping, 1.03), 1e3) << damping;
  }
}

// Near critical damping the collision takes ever longer, the stable step does not.
TEST(StartSimulation, RefusesStepsThatDampingMakesUnstable) {
  Material material;
  const double m_ij = sphere_mass(material, 0.5e-3) / 2;
  const auto refusal = [&](double damping, double fraction) {
    material.contact_viscosity = damping * 2 * std::sqrt(material.stiffness * m_ij);
    return message_of([&] { check_time_step(fraction, material, m_ij); });
  };
  EXPECT_EQ(refusal(0.069, 0.4), "no error") << "the paper's spheres";
  EXPECT_NE(refusal(0.069, 0.41).find("0.41 is beyond 0.4"), std::string::npos);
  EXPECT_EQ(refusal(0.5, 0.1), "no error");
  for (const double damping : {0.8, 0.9, 0.99, 0.9999}) {
    const std::string message = refusal(damping, 0.1);
    const auto give = message.find("give at most ");
    ASSERT_NE(give, std::string::npos) << damping << ": " << message;
    EXPECT_NE(message.find("time_step_fraction: 0.1 is unstable with this contact_viscosity"), std::string::npos);
    EXPECT_EQ(refusal(damping, std::stod(message.substr(give + 13))), "no error");
    EXPECT_LE(std::stod(message.substr(give + 13)) * collision_time(material, m_ij), stable_time_step(material, m_ij));
  }
}

// Rows look at what is, not at what was when somebody looked last: on lanes the end of a step waits for the next one.
TEST(StartSimulation, RowsAreOfTheCurrentTime) {
  scene::Draw draw(3);
  std::vector<scene::Sphere> spheres;
  for (int k = 0; k < 343; ++k)
    spheres.push_back({1e-3, 1.9e-3 * Eigen::Vector3d(k % 7, k / 7 % 7, k / 49), draw.vector(-20, 20)});
  const State state = scene::state_of(scene::cubic(7 * 1.9e-3), spheres);
  CellMotion motion = scene::at_rest(state);
  motion.L.diagonal() << 100, -100, 30;
  const auto row_after = [&](bool looking) {
    Simulation sim(state, scene::engine_options(), motion);
    for (int k = 0; k < 30; ++k) {
      sim.advance(motion, motion);
      if (looking) sim.state();
    }
    return observe(sim, motion, Deviator<double>::Zero());
  };
  const Observation seen = row_after(false), looked_at = row_after(true);
  EXPECT_EQ(seen.stress.tensor, looked_at.stress.tensor);
  EXPECT_EQ(seen.fabric.tensor, looked_at.fabric.tensor);
  EXPECT_EQ(seen.E_kin, looked_at.E_kin);
  EXPECT_EQ(seen.E_pot, looked_at.E_pot);
  EXPECT_EQ(seen.W_box, looked_at.W_box);
  EXPECT_EQ(seen.time, looked_at.time);
}

// D18: coinciding spheres have no normal. Distances whose square underflows are refused likewise.
TEST(StartSimulation, D18CoincidingSpheresAreNamed) {
  for (const double distance : {0.0, 1e-300, 1e-170, 1e-162}) {
    State state = scene::state_of(kBox, {{1e-3, {5e-3, 5e-3, 5e-3}}, {1e-3, {0, 0, 0}}, {1e-3, {distance, 0, 0}}});
    state.packing.id = {4, 17, 99};
    const std::string message = message_of([&] { scene::start(state); });
    EXPECT_NE(message.find("17"), std::string::npos) << message << " at " << distance;
    EXPECT_NE(message.find("99"), std::string::npos) << message << " at " << distance;
  }
  // As soon as the square is representable the direction is right.
  Simulation sim = scene::start(scene::state_of(kBox, {{1e-3, {0, 0, 0}}, {1e-3, {1e-150, 0, 0}}}));
  EXPECT_NEAR(force_on(sim, 0).x(), -1e8 * 2e-3, 1e-6);
}

// D17: a small sphere inside a big one is pushed out along the line of centres, with k (r_i + r_j - distance).
TEST(StartSimulation, D17DeepOverlapRepels) {
  Simulation sim = scene::start(
      scene::state_of(kBox, {{5e-3, {10e-3, 10e-3, 10e-3}}, {0.5e-3, {10e-3, 11e-3, 10e-3}}}, {2000, 1e8, 0.5, 0}));
  EXPECT_NEAR(force_on(sim, 1).y(), 1e8 * 4.5e-3, 1e-6);
  ASSERT_TRUE(sim.plain()) << "the cell is too small for lanes";
  EXPECT_EQ(sim.plain()->force[0][1], -sim.plain()->force[1][1]);
}

// The list is that of the last rebuild, in the cell of that time: another one would be renewed at another time.
TEST(StartSimulation, AContinuedRunHasTheListOfItsLastRebuild) {
  scene::Draw draw(5);
  constexpr double spacing = 2.3e-3;  // about the reach of the list, so that every change of the cell changes the list
  std::vector<scene::Sphere> spheres;
  for (int k = 0; k < 216; ++k) {
    const Eigen::Vector3d cell(k % 6, k / 6 % 6, k / 36);
    spheres.push_back({1e-3, spacing * cell + draw.vector(-0.1e-3, 0.1e-3)});
  }
  const State state = scene::state_of(scene::cubic(6 * spacing), spheres);
  EngineOptions options = scene::engine_options();
  options.skin = 0.3;
  Simulation whole(state, options, scene::at_rest(state));
  CellMotion end = scene::at_rest(whole.state());
  end.H(2, 2) *= 0.98;
  scene::step(whole, end, end);
  ASSERT_EQ(whole.rebuilds(), 1u);
  const NeighbourList list = scene::list_of(whole),
                      continued = scene::list_of(Simulation(whole.state(), whole.options(), end));
  EXPECT_EQ(continued.first, list.first);
  EXPECT_EQ(continued.j, list.j);
  EXPECT_EQ(continued.image, list.image);
  State forgetful = whole.state();
  forgetful.ref_x.clear();
  EXPECT_NE(scene::list_of(Simulation(forgetful, options, end)).j, list.j) << "the cell changes the list";
}

TEST(Advance, TimeAndStepsAreCounted) {
  Simulation sim = scene::start(touching({1, 0, 0}, {0, 0, 0}));
  scene::advance_at_rest(sim, 7);
  EXPECT_EQ(sim.step(), 7U);
  EXPECT_NEAR(sim.time(), 7 * sim.dt(), 1e-15 * sim.dt() * 7);
}

TEST(Advance, FreeFlightIsStraight) {
  Simulation sim = scene::start(scene::state_of(kBox, {{1e-3, {1e-3, 2e-3, 3e-3}, {3, -2, 1}}}, {2000, 1e8, 1, 0}));
  scene::advance_at_rest(sim, 1000);
  const Eigen::Vector3d expected = Eigen::Vector3d(1e-3, 2e-3, 3e-3) + 1000 * sim.dt() * Eigen::Vector3d(3, -2, 1);
  Eigen::Vector3d difference = (scene::position(sim.state().packing, 0) - expected) / 20e-3;
  difference.array() -= difference.array().round();
  const double quantum = scene::precision_under_test() == Precision::mixed ? 0x1p-32 : 0x1p-52;
  EXPECT_LE(difference.lpNorm<Eigen::Infinity>(), 1000 * quantum / 2 + scene::rounding(1e-15))
      << "half a quantum a step";
  EXPECT_EQ(scene::velocity(sim.state().packing, 0), Eigen::Vector3d(3, -2, 1));
}

TEST(Advance, LostSphereIsNamed) {
  State state = touching({1, 0, 0}, {0, 0, 0});
  state.packing.id = {30, 31};
  Simulation sim = scene::start(state);
  State nowhere = sim.state();
  nowhere.ax[1] = std::numeric_limits<double>::quiet_NaN();
  sim = Simulation(nowhere, sim.options(), scene::at_rest(nowhere));
  EXPECT_NE(message_of([&] { scene::advance_at_rest(sim, 1); }).find("sphere 31: position or velocity"),
            std::string::npos);
  state.packing.vy[1] = 0.13 * kBox(1, 1) / sim.dt();
  sim = scene::start(state);
  const std::string message = message_of([&] { scene::advance_at_rest(sim, 1); });
  EXPECT_TRUE(scene::precision_under_test() == Precision::reference ||
              message.find("sphere 31: crosses") != std::string::npos)
      << message;
}

TEST(Ledger, OpensAtTheCurrentEnergies) {
  Simulation sim = scene::start(touching({1, 0, 0}, {3, 0, 0}));
  scene::advance_at_rest(sim, 20);
  sim.open_ledger();
  const Ledger& ledger = sim.state().ledger;
  EXPECT_EQ(ledger.W_box, 0);
  EXPECT_EQ(ledger.D_contact, 0);
  EXPECT_EQ(ledger.D_background, 0);
  EXPECT_EQ(ledger.E_kin_start, kinetic_energy(sim.state().packing));
  EXPECT_EQ(ledger.E_start, ledger.E_kin_start + sim.state().sums.E_pot);
  EXPECT_EQ(energy_residual(sim.state()), 0);
}

TEST(Ledger, ResidualIsScaledByWorkStartEnergyAndDissipation) {
  Simulation sim = scene::start(touching({1, 0, 0}, {3, 0, 0}));
  sim.open_ledger();
  State state = sim.state();
  const double E_kin = kinetic_energy(state.packing);
  state.ledger.W_box = -2 * E_kin;
  state.ledger.D_contact = 0.5 * E_kin;
  state.ledger.D_background = 0.25 * E_kin;
  EXPECT_NEAR(energy_residual(state), (-2 - 0.75) / (2 + 1 + 0.75), 1e-14);
}

TEST(Ledger, KineticEnergy) {
  const State state = touching({1, 0, 0}, {3, -4, 12});
  EXPECT_DOUBLE_EQ(kinetic_energy(state.packing), 0.5 * state.packing.mass[0] * 169);
  EXPECT_EQ(kinetic_energy(Packing{}), 0);
}

// A damped pair in a box at rest ends apart and slower: what it lost is in the account.
TEST(Ledger, FreeCollisionLosesWhatTheRestitutionSays) {
  const Material material{2000, 1e8, 1, 0};
  State state = scene::state_of(
      kBox, {{1e-3, {8e-3, 10e-3, 10e-3}, {1, 0, 0}}, {1e-3, {10.01e-3, 10e-3, 10e-3}, {-1, 0, 0}}}, material);
  Simulation sim = scene::start(state, 1 / 200.3);
  sim.open_ledger();
  const double E_0 = sim.state().ledger.E_kin_start, e = scene::restitution(material, state.packing.mass[0] / 2);
  scene::advance_at_rest(sim, 2500);
  EXPECT_LT(sim.state().packing.vx[0], 0);
  EXPECT_EQ(sim.state().ledger.W_box, 0);
  EXPECT_EQ(sim.state().sums.E_pot, 0);
  EXPECT_NEAR(sim.state().ledger.D_contact / E_0, 1 - e * e, 2e-3);
  // A step in which the contact begins or ends errs by at most k v^2 dt^2/8 = (pi dt/t_c)^2/4 of the energy.
  EXPECT_LE(std::abs(energy_residual(sim.state())), std::pow(std::numbers::pi / 200.3, 2) / 4);
}

}  // namespace
}  // namespace grainlaw::dem
