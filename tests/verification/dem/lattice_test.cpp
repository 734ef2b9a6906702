// D11: perfect lattices, the only contacts are with images of the own cell; edge a, spheres of radius r, N per cell.
//   lattice  N  C   distance d      delta = 2 r - d
//   sc       1  6   a               P = (1/(3 V)) sum_c f d = (N C/2) k delta d/(3 a^3)    (sc: k delta/a^2)
//   bcc      2  8   sqrt(3) a/2     tr F = C nu
//   fcc      4  12  a/sqrt(2)       cubic symmetry: no deviator
// Overlaps of 2 % leave second neighbours apart.

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "dem/element_tests/drive.hpp"
#include "dem/engine/averages.hpp"
#include "tests/support/dem_scene.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using testing::expect_figure;

struct Lattice {
  const char* name;
  std::vector<Eigen::Vector3d> sites;  ///< fractions of the cell
  int C;                               ///< coordination number
  double distance;                     ///< of nearest neighbours over the edge
};

std::ostream& operator<<(std::ostream& out, const Lattice& lattice) { return out << lattice.name; }

class LatticeTest : public ::testing::TestWithParam<Lattice> {
 protected:
  static constexpr double kEdge = 3e-3, kRelativeOverlap = 0.02;
  double d() const { return GetParam().distance * kEdge; }
  double r() const { return 0.5 * d() / (1 - kRelativeOverlap); }
  Simulation lattice(const Eigen::Vector3d& shift) const {
    std::vector<scene::Sphere> spheres;
    for (const Eigen::Vector3d& site : GetParam().sites) spheres.push_back({r(), kEdge * (site + shift)});
    return scene::start(scene::state_of(scene::cubic(kEdge), spheres));
  }
};

TEST_P(LatticeTest, D11PressureFabricAndCoordination) {
  const auto [name, sites, C, distance] = GetParam();
  const double N = static_cast<double>(sites.size()), V = kEdge * kEdge * kEdge, k = Material{}.stiffness;
  const double P = N * C / 2 * k * (2 * r() - d()) * d() / (3 * V);
  const double nu = N * 4.0 / 3.0 * std::numbers::pi * r() * r() * r() / V;
  double error = 0, deviator = 0;
  for (const double shift : {0.0, 0.125, 0.8125}) {
    Simulation sim = lattice({shift, 0.5 * shift, -shift});
    const Observation seen = observe(sim, scene::at_rest(sim.state()), Deviator<double>::Zero());
    // The overlap is the difference of lengths 50 times larger: its rounding is that of the lengths.
    error = std::max({error, std::abs(seen.stress.tensor.trace() / 3 / P - 1), std::abs(seen.F_v / (C * nu) - 1),
                      std::abs(seen.C - C), std::abs(seen.P_star / (2 * r() * P / k) - 1), std::abs(seen.nu / nu - 1)});
    deviator = std::max({deviator, deviatoric_norm(seen.stress.tensor) / seen.stress.tensor.trace(),
                         deviatoric_norm(seen.fabric.tensor) / seen.F_v});
    EXPECT_EQ(seen.C_star, C);
    EXPECT_EQ(seen.C_r, C);
    EXPECT_EQ(seen.rattler_fraction, 0);
    EXPECT_NEAR(seen.E_pot, N * C / 4 * k * std::pow(2 * r() - d(), 2), 1e-12 * seen.E_pot);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      EXPECT_LE(scene::force_on(sim, i).norm(), 1e-13 * k * (2 * r() - d())) << "each site is a centre of symmetry";
    }
  }
  expect_figure(std::string("D11.") + name + ".mean", error, 1e-13);
  expect_figure(std::string("D11.") + name + ".deviator", deviator, 1e-14);
}

TEST_P(LatticeTest, D11StaysInEquilibrium) {
  Simulation sim = lattice({0.25, 0.5, 0.125});
  scene::advance_at_rest(sim, 1000);
  EXPECT_LE(kinetic_energy(sim.state().packing), 1e-24 * sim.state().sums.E_pot);
}

INSTANTIATE_TEST_SUITE_P(
    Cubic, LatticeTest,
    ::testing::Values(Lattice{"sc", {{0, 0, 0}}, 6, 1},
                      Lattice{"bcc", {{0, 0, 0}, {0.5, 0.5, 0.5}}, 8, std::sqrt(3.0) / 2},
                      Lattice{"fcc", {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}}, 12, 1 / std::sqrt(2.0)}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(SelfImages, ShearedSimpleLatticeTouchesItsImages) {
  // One sphere in a rhombohedral cell with angles of 60 degrees is the fcc lattice again: 12 own images.
  const double a = 2e-3, r = 0.5 * a / 0.98;
  Eigen::Matrix3d H;
  H << 1, 0.5, 0.5, 0, std::sqrt(3.0) / 2, std::sqrt(3.0) / 6, 0, 0, std::sqrt(2.0 / 3.0);
  Simulation sim = scene::start(scene::state_of(a * H, {{r, {0.3e-3, 0.2e-3, 0.9e-3}}}));
  const Observation seen = observe(sim, scene::at_rest(sim.state()), Deviator<double>::Zero());
  const double V = a * a * a / std::sqrt(2.0);
  EXPECT_EQ(seen.C, 12);
  EXPECT_NEAR(seen.stress.tensor.trace() / 3, 6 * 1e8 * (2 * r - a) * a / (3 * V), 1e-12 * seen.stress.tensor.trace());
  EXPECT_LE(deviatoric_norm(seen.stress.tensor), 1e-13 * seen.stress.tensor.trace());
}

// The account of a simple cubic lattice whose cell shrinks at a constant rate, a(t) = a_0 exp(-rate t): three contacts,
//   dE_pot = 3 k/2 ((2r - a_1)^2 - (2r - a_0)^2),   D = 3 gamma int (rate a)^2 dt = 3 gamma rate (a_0^2 - a_1^2)/2,
//   W = dE_pot + D;  the trapezoidal rule errs with dt^2. Sphere and cell rest, so both kinds of transport agree.
TEST(LatticeEnergy, WorkAndDissipationOfAShrinkingCell) {
  const double a_0 = 3e-3, r = 0.5 * a_0 / 0.98, strain = 0.02, rate = 1e6, k = 1e8, gamma = 1;
  const double a_1 = a_0 * std::exp(-strain);
  const double stored = 1.5 * k * (std::pow(2 * r - a_1, 2) - std::pow(2 * r - a_0, 2));
  const double lost = 1.5 * gamma * rate * (a_0 * a_0 - a_1 * a_1);
  for (const Transport transport : {Transport::homogeneous, Transport::wall}) {
    DriveOptions options;
    options.profile = Profile::constant;
    options.strain_rate = 3 * rate;
    options.transport = transport;
    const Drive drive =
        make_drive(scene::segment_of(-Eigen::Matrix3d::Identity(), strain, 0.5), options, scene::cubic(a_0));
    const auto errors = [&](int steps) {
      State state = scene::state_of(scene::cubic(a_0), {{r, {0, 0, 0}}}, {2000, k, gamma, 0.1});
      Simulation sim(std::move(state), scene::engine_options(), motion_at(drive, 0));
      sim.set_dt(drive.duration / steps);
      scene::run_along(sim, drive);
      EXPECT_NEAR(sim.state().sums.E_pot - sim.state().ledger.E_start, stored, 1e-11 * stored);
      return std::pair(std::abs(sim.state().ledger.W_box / (stored + lost) - 1),
                       std::abs(sim.state().ledger.D_contact / lost - 1));
    };
    const auto [work, loss] = errors(20);
    const auto [finer_work, finer_loss] = errors(80);
    EXPECT_LE(work, 1e-5);
    EXPECT_LE(loss, 1e-5);
    EXPECT_NEAR(std::log(work / finer_work) / std::log(4.0), 2, 0.1);
    EXPECT_NEAR(std::log(loss / finer_loss) / std::log(4.0), 2, 0.1);
  }
}

}  // namespace
}  // namespace grainlaw::dem
