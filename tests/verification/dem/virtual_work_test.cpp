// D6-D8 and D20: forces and stress are derivatives of one elastic energy, and the engine is the plain reference.
//   f_i = -dE/dx_i,   sigma_ab = -(1/V) dE/d eps_ab  (compression positive; cell H -> (1 + h e_a e_b^T) H at fixed
//   fractions, whose antisymmetric part is a rotation and changes nothing),   sum_i f_i = 0

#include <gtest/gtest.h>

#include <algorithm>

#include "dem/engine/averages.hpp"
#include "dem/statics/relax.hpp"
#include "tests/support/dem_families.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using scene::Draw;
using scene::Family;
using testing::expect_figure;

const Material kNoDrag{2000, 1e8, 1, 0};

double elastic_energy(const State& state) { return scene::start(state).state().sums.E_pot; }

Eigen::Matrix3d stress(const State& state) {
  Simulation sim = scene::start(state);
  return observe(sim, scene::at_rest(state), Deviator<double>::Zero()).stress.tensor;
}

/// Largest error of the six stresses over the largest stress, against the central difference of step h.
double stress_error(const State& state, double h) {
  const Eigen::Matrix3d sigma = stress(state);
  double worst = 0;
  for (const auto& [a, b] : kComponentIndex) {
    double energy[2];
    for (const int side : {0, 1}) {
      Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
      F(a, b) += side == 0 ? -h : h;  // a <= b: the cell stays upper triangular
      State strained = state;
      strained.packing.H = F * state.packing.H;
      energy[side] = elastic_energy(strained);
    }
    const double expected = -(energy[1] - energy[0]) / (2 * h) / state.packing.volume();
    worst = std::max({worst, std::abs(sigma(a, b) - expected), std::abs(sigma(b, a) - expected)});
  }
  return worst / sigma.cwiseAbs().maxCoeff();
}

/// Largest error of the forces on a sample of spheres over the largest force, likewise, with steps of h times <r>.
double force_error(const State& state, double h, int sample) {
  Simulation sim = scene::start(state);
  const Packing& p = state.packing;
  const double step = h * mean_radius(p);
  const Eigen::Matrix3d inverse = p.H.triangularView<Eigen::Upper>().solve(Eigen::Matrix3d::Identity());
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) largest = std::max(largest, scene::force_on(sim, i).norm());
  for (int n = 0; n < sample; ++n) {
    const std::size_t i = static_cast<std::size_t>(n) * p.size() / static_cast<std::size_t>(sample);
    for (int a = 0; a < 3; ++a) {
      double energy[2];
      for (const int side : {0, 1}) {
        State moved = state;
        const double d = side == 0 ? -step : step;
        scene::place(moved.packing, i, scene::fraction(p, i) + inverse * (d * Eigen::Vector3d::Unit(a)));
        energy[side] = elastic_energy(moved);
      }
      const double expected = -(energy[1] - energy[0]) / (2 * step);
      worst = std::max(worst, std::abs(scene::force_on(sim, i)(a) - expected));
    }
  }
  return worst / largest;
}

State relaxed(const Family& family) {
  Draw draw(19);
  State state = scene::state_of_family(family, 150, 0.75, draw, kNoDrag);
  const Relaxation relaxation = relax(state, EngineOptions{}, RelaxOptions{}, RunControl{});
  EXPECT_TRUE(relaxation.relaxed);
  return state;
}

class VirtualWork : public ::testing::TestWithParam<Family> {
 protected:
  State random_overlaps() const {
    Draw draw(17);
    return scene::state_of_family(GetParam(), 300, 0.7, draw, kNoDrag);
  }
};

TEST_P(VirtualWork, D6ForcesSumToZero) {
  Draw draw(3);
  State state = random_overlaps();
  scene::random_velocities(state.packing, 1, draw);
  const ReferenceSums reference = reference_sums(state.packing, state.material, scene::at_rest(state));
  Simulation sim = scene::start(state);
  Eigen::Vector3d total = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < state.packing.size(); ++i) total += scene::force_on(sim, i);
  expect_figure(scene::figure_name("D6", GetParam()), total.norm() / reference.max_force, 1e-12);
}

TEST_P(VirtualWork, D7StressIsTheStrainDerivativeOfTheEnergy) {
  expect_figure(scene::figure_name("D7.random", GetParam()), stress_error(random_overlaps(), 1e-5), 1e-9);
  expect_figure(scene::figure_name("D7.relaxed", GetParam()), stress_error(relaxed(GetParam()), 5e-8), 1e-9);
}

TEST_P(VirtualWork, D8ForceIsTheGradientOfTheEnergy) {
  expect_figure(scene::figure_name("D8", GetParam()), force_error(random_overlaps(), 1e-5, 15), 1e-8);
}

TEST_P(VirtualWork, EngineEqualsThePlainReference) {
  Draw draw(23);
  for (const Transport transport : {Transport::homogeneous, Transport::wall}) {
    State state = random_overlaps();
    state.packing.H(0, 2) += 0.1 * state.packing.H(2, 2);
    scene::random_velocities(state.packing, 0.5, draw);
    CellMotion motion = scene::at_rest(state);
    motion.transport = transport;
    motion.L << -120, 70, 40, 0, 90, -60, 0, 0, -30;
    EngineOptions options = scene::engine_options();
    options.refuse_deep_overlaps = false;
    Simulation sim(state, options, motion);
    const Observation seen = observe(sim, motion, Deviator<double>::Zero());
    const ReferenceSums expected = reference_sums(sim.state().packing, state.material, motion);
    const double V = state.packing.volume();

    double worst = 0;
    int contacts = 0;
    for (std::size_t i = 0; i < state.packing.size(); ++i) {
      worst = std::max(worst, (scene::force_on(sim, i) - expected.force[i]).norm());
      contacts += expected.contacts[i];
    }
    EXPECT_LE(worst, 1e-12 * expected.max_force);
    EXPECT_LE((seen.stress.tensor * V - expected.virial).norm(), 1e-13 * expected.virial.norm());
    EXPECT_LE((seen.fabric.tensor - expected.fabric).norm(), 1e-13 * expected.fabric.norm());
    EXPECT_NEAR(sim.state().sums.E_pot, expected.E_pot, 1e-13 * expected.E_pot);
    EXPECT_NEAR(seen.E_pot, expected.E_pot, 1e-13 * expected.E_pot);
    EXPECT_NEAR(sim.state().sums.contact_power, expected.contact_power, 1e-12 * expected.contact_power);
    EXPECT_NEAR(sim.state().sums.box_power, expected.box_power, 1e-12 * motion.L.norm() * expected.virial.norm());
    EXPECT_NEAR(seen.mean_overlap * mean_radius(state.packing), 2 * expected.overlap / contacts,
                1e-13 * expected.overlap);
    EXPECT_DOUBLE_EQ(seen.C_r, contacts / static_cast<double>(state.packing.size()));
    if (transport == Transport::homogeneous) {  // dW/dt = -V sigma : L with the virial of all contact forces
      EXPECT_NEAR(sim.state().sums.box_power, -(expected.virial.transpose() * motion.L).trace(),
                  1e-12 * motion.L.norm() * expected.virial.norm());
    }
  }
}

// At the end of a step forces are those of predicted velocities; what is measured belongs to the velocities themselves.
TEST_P(VirtualWork, MeasuredStressEqualsThePlainReferenceAfterSteps) {
  Draw draw(31);
  State state = random_overlaps();
  scene::random_velocities(state.packing, 0.5, draw);
  const StraightSegment segment =
      scene::segment_of(direction_of(Mode::D3).tensor, 0.01, volume_fraction(state.packing));
  const Drive drive = make_drive(segment, {500, Profile::constant, Transport::homogeneous}, state.packing.H);
  EngineOptions options = scene::engine_options();
  options.refuse_deep_overlaps = false;
  Simulation sim(state, options, motion_at(drive, 0));
  for (int k = 0; k < 5; ++k)
    scene::step(sim, motion_at(drive, (k + 0.5) * sim.dt()), motion_at(drive, (k + 1) * sim.dt()));
  const CellMotion motion = motion_at(drive, 5 * sim.dt());
  const Observation seen = observe(sim, motion, Deviator<double>::Zero());
  const Packing& p = sim.state().packing;
  const ReferenceSums expected = reference_sums(p, state.material, motion);
  EXPECT_LE((seen.stress.tensor * p.volume() - expected.virial).norm(), 1e-12 * expected.virial.norm());
  EXPECT_LE((seen.fabric.tensor - expected.fabric).norm(), 1e-12 * expected.fabric.norm());
}

INSTANTIATE_TEST_SUITE_P(D20, VirtualWork, ::testing::ValuesIn(scene::families()), scene::name_of_family);

TEST(NewtonsThirdLaw, D6PairForcesAreOppositeToTheLastBit) {
  Draw draw(29);
  int different = 0;
  for (int n = 0; n < 1000; ++n) {
    const Eigen::Vector3d x = draw.vector(0, 1e-2), d = 0.9e-3 * draw.vector(-1, 1);
    Simulation sim = scene::start(scene::state_of(
        1e-2 * scene::sheared_shape(), {{1e-3, x, draw.vector(-1, 1)}, {1e-3, x + d, draw.vector(-1, 1)}}, kNoDrag));
    ASSERT_NE(scene::force_on(sim, 0).norm(), 0);
    ASSERT_TRUE(sim.plain()) << "a sheared cell";
    const std::vector<Row>& force = sim.plain()->force;
    for (std::size_t a = 0; a < 3; ++a) different += force[0][a] != -force[1][a] ? 1 : 0;
  }
  expect_figure("D6.pair_forces_not_opposite", different, 0);
}

}  // namespace
}  // namespace grainlaw::dem
