#include "dem/engine/averages.hpp"

#include <gtest/gtest.h>

#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kEdge = 20e-3, kVolume = kEdge * kEdge * kEdge, kOverlap = 0.1e-3;
const Deviator<double> kNone = Deviator<double>::Zero();

/// Two touching spheres of radii 1 and 1.5 mm with their line of centres along `n`.
struct Pair {
  Eigen::Vector3d n = Eigen::Vector3d(2, -1, 2) / 3;
  Eigen::Vector3d v{3, 1, -2};  ///< of the first sphere
  Material material{2000, 1e8, 2, 0.1};
  CellMotion motion{scene::cubic(kEdge), Eigen::Matrix3d::Zero(), Transport::homogeneous};

  double distance() const { return 2.5e-3 - kOverlap; }
  Simulation simulation() const {
    const Eigen::Vector3d x(7e-3, 8e-3, 9e-3);
    return Simulation(scene::state_of(scene::cubic(kEdge), {{1e-3, x + distance() * n, v}, {1.5e-3, x}}, material),
                      scene::engine_options(), motion);
  }
};

// sigma = (1/V) f l n n with the viscous part of f; kinetic part m v v/V apart.
TEST(Averages, StressOfOneContact) {
  const Pair pair;
  const Observation seen = observe(pair.simulation(), pair.motion, kNone);
  const double f = 1e8 * kOverlap - 2 * pair.v.dot(pair.n);
  const Eigen::Matrix3d expected = f * pair.distance() / kVolume * pair.n * pair.n.transpose();
  EXPECT_LE((seen.stress.tensor - expected).norm(), 1e-12 * expected.norm());
  const double P = f * pair.distance() / (3 * kVolume);
  EXPECT_NEAR(seen.P_star, 2 * 1.25e-3 * P / 1e8, 1e-12 * seen.P_star);
  EXPECT_NEAR(seen.s_dev, 3, 1e-11) << "a uniaxial tensor: |sigma|_dev = tr sigma = 3 P";
  const double m = sphere_mass(pair.material, 1e-3);
  EXPECT_LE((seen.stress_kinetic.tensor - m / kVolume * pair.v * pair.v.transpose()).norm(), 1e-15 * m / kVolume * 14);
}

TEST(Averages, StressContainsTheViscosityOfTheCellsMotion) {
  Pair pair;
  pair.v.setZero();
  pair.motion.L << -300, 40, 20, 0, 100, -60, 0, 0, 50;
  const Observation seen = observe(pair.simulation(), pair.motion, kNone);
  const double f = 1e8 * kOverlap - 2 * pair.distance() * pair.n.dot(pair.motion.L * pair.n);
  EXPECT_NEAR(seen.stress.tensor.trace(), f * pair.distance() / kVolume, 1e-12 * seen.stress.tensor.trace());
}

// F = (1/V) (V_1 + V_2) n n
TEST(Averages, FabricOfOneContact) {
  const Pair pair;
  const Observation seen = observe(pair.simulation(), pair.motion, kNone);
  const double solid = 4.0 / 3.0 * std::numbers::pi * (1e-9 + 3.375e-9);
  EXPECT_LE((seen.fabric.tensor - solid / kVolume * pair.n * pair.n.transpose()).norm(), 1e-12 * solid / kVolume);
  EXPECT_NEAR(seen.F_v, solid / kVolume, 1e-12 * seen.F_v);
  EXPECT_NEAR(seen.F_dev, solid / kVolume, 1e-12 * seen.F_v);
  EXPECT_NEAR(seen.nu, solid / kVolume, 1e-14);
}

TEST(Averages, SignedMeasuresAlongADirection) {
  Pair pair;
  pair.n = {0, 0, 1};
  pair.v.setZero();
  Simulation sim = pair.simulation();
  const Deviator<double> along_z = Deviator<double>{1, 0, 0, 0, 0};
  const Observation seen = observe(sim, pair.motion, along_z);
  EXPECT_NEAR(seen.s_par, 3, 1e-12);
  EXPECT_NEAR(seen.F_par, seen.F_dev, 1e-15);
  const Observation reversed = observe(sim, pair.motion, -along_z);
  EXPECT_NEAR(reversed.s_par, -3, 1e-12);
  EXPECT_NEAR(reversed.F_par, -seen.F_dev, 1e-15);
  EXPECT_NEAR(reversed.s_dev, 3, 1e-12) << "a norm has no sign";
  const Observation isotropic = observe(sim, pair.motion, kNone);
  EXPECT_TRUE(std::isnan(isotropic.s_par));
  EXPECT_TRUE(std::isnan(isotropic.F_par));
}

// Tension positive a contact along z is -f n n: eigenvalues of the deviator (1, 1, -2)/3, Lambda = 1, Lode 60 degrees,
// as D3 and UNI in Table 1.
TEST(Averages, ShapeAndLodeAreTensionPositive) {
  Pair pair;
  pair.n = {0, 0, 1};
  const Observation seen = observe(pair.simulation(), pair.motion, kNone);
  EXPECT_NEAR(seen.shape_stress, 1, 1e-12);
  EXPECT_NEAR(seen.lode_stress, 60, 1e-4);
  EXPECT_NEAR(seen.shape_fabric, 1, 1e-12);
  EXPECT_NEAR(seen.lode_fabric, 60, 1e-4);
}

TEST(Averages, EnergiesAndOverlap) {
  const Pair pair;
  Simulation sim = pair.simulation();
  const Observation seen = observe(sim, pair.motion, kNone);
  EXPECT_NEAR(seen.E_pot, 0.5 * 1e8 * kOverlap * kOverlap, 1e-11 * seen.E_pot);
  EXPECT_DOUBLE_EQ(seen.E_kin, 0.5 * sphere_mass(pair.material, 1e-3) * 14);
  EXPECT_NEAR(seen.mean_overlap, kOverlap / 1.25e-3, 1e-11 * seen.mean_overlap);
  EXPECT_EQ(seen.C_r, 1);
  EXPECT_EQ(seen.C, 0);
  EXPECT_EQ(seen.rattler_fraction, 1);
  EXPECT_TRUE(std::isnan(seen.C_star));
}

// I = rate 2 <r> sqrt(rho/P), rate = max(|tr D|, |D|_dev)
TEST(Averages, InertialNumber) {
  Pair pair;
  pair.v.setZero();
  pair.material.contact_viscosity = 0;
  pair.motion.L.diagonal() << 0, 0, -200;  // UNI: both rates are 200
  Observation seen = observe(pair.simulation(), pair.motion, kNone);
  const double P = 1e8 * kOverlap * pair.distance() / (3 * kVolume);
  EXPECT_NEAR(seen.inertial_number, 200 * 2 * 1.25e-3 * std::sqrt(2000 / P), 1e-11 * seen.inertial_number);
  pair.motion.L.diagonal() << 200, 0, -200;  // D2: sqrt(3) 200
  seen = observe(pair.simulation(), pair.motion, kNone);
  EXPECT_NEAR(seen.inertial_number, std::sqrt(3.0) * 200 * 2.5e-3 * std::sqrt(2000 / P), 1e-11 * seen.inertial_number);
}

// Periodic copies in a sheared cell, of unwrapped places: the averages are those of one.
TEST(Averages, OfCopiesAreThoseOfOne) {
  scene::Draw draw(5);
  State one = scene::random_state(60, 3, 0.8, scene::random_shape(1.5, 0.4, draw), draw);
  scene::random_velocities(one.packing, 1e-2, draw);
  for (std::size_t i = 0; i < one.packing.size(); i += 3) one.packing.sy[i] -= 4;
  const auto seen = [](State state) {
    const CellMotion motion = scene::at_rest(state);
    return observe(scene::start(std::move(state)), motion, kNone);
  };
  const State eight = tiled(one, 2);
  EXPECT_EQ(eight.packing.size(), 480u);
  const Observation of_one = seen(one), of_eight = seen(eight);
  const double rounding = scene::rounding(1e-13);
  EXPECT_LE((of_eight.stress.tensor - of_one.stress.tensor).norm(), rounding * of_one.stress.tensor.norm());
  EXPECT_LE((of_eight.fabric.tensor - of_one.fabric.tensor).norm(), rounding * of_one.fabric.tensor.norm());
  EXPECT_NEAR(of_eight.nu, of_one.nu, 1e-14);
  EXPECT_NEAR(of_eight.E_kin, 8 * of_one.E_kin, 1e-13 * of_eight.E_kin);
}

TEST(Averages, LedgerAndTimeAreTakenFromTheState) {
  const Pair pair;
  Simulation sim = pair.simulation();
  sim.open_ledger();
  scene::advance_at_rest(sim, 30);
  const Observation seen = observe(sim, pair.motion, kNone);
  EXPECT_EQ(seen.time, sim.time());
  EXPECT_EQ(seen.W_box, sim.state().ledger.W_box);
  EXPECT_EQ(seen.D_contact, sim.state().ledger.D_contact);
  EXPECT_EQ(seen.D_background, sim.state().ledger.D_background);
  EXPECT_GT(seen.D_contact, 0);
  EXPECT_GT(seen.D_background, 0);
  EXPECT_EQ(seen.energy_residual, energy_residual(sim.state()));
}

}  // namespace
}  // namespace grainlaw::dem
