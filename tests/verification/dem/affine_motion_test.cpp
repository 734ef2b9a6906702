// D10: spheres without contact and fluctuation are carried by the cell.
//   x(t) = F(t) x(0),  nu(t) = nu(0)/det F(t);  there and back: where they were
// F is a function of time, here with growing shears and unequal stretches, so nothing may accumulate in 1e6 steps.
// With a fluctuation velocity v (constant without force) and constant L = diag(a):
//   homogeneous  s_x(t) = s_x(0) + v_x/H_xx(0) (1 - exp(-a_x t))/a_x;    wall-driven  x_x(t) = x_x(0) + v_x t
// and with drag v(t) = v(0) exp(-gamma_b t/m).

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>

#include "tests/support/dem_scene.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using testing::expect_figure;

/// F(u), u in [0, 1]: out and back, F(0) = F(1) = 1.
Eigen::Matrix3d deformation(double u) {
  const double bump = std::sin(std::numbers::pi * u) * std::sin(std::numbers::pi * u),
               twist = std::sin(2 * std::numbers::pi * u);
  Eigen::Matrix3d F;
  F << std::exp(0.4 * bump), 0.6 * twist, -0.5 * bump, 0, std::exp(-0.3 * twist), 0.7 * bump, 0, 0,
      std::exp(-0.25 * bump);
  return F;
}

Eigen::Matrix3d velocity_gradient(double u, double duration) {
  const double d = 1e-6;
  return (deformation(u + d) - deformation(u - d)) / (2 * d * duration) * deformation(u).inverse();
}

TEST(AffineMotion, D10ThereAndBackInAMillionSteps) {
  const Eigen::Matrix3d H_0 = 20e-3 * Eigen::Matrix3d::Identity();
  const std::vector<Eigen::Vector3d> x_0{{3e-3, 4e-3, 16e-3}, {11e-3, 14e-3, 6e-3}, {17e-3, 5e-3, 9e-3}};
  Simulation sim = scene::start(scene::state_of(H_0, {{0.5e-3, x_0[0]}, {0.8e-3, x_0[1]}, {0.6e-3, x_0[2]}}));
  const Packing& p = sim.state().packing;
  const double nu_0 = volume_fraction(p);
  const std::int64_t steps = 1000000;
  const double duration = static_cast<double>(steps) * sim.dt();
  // The gradient feeds viscous forces only and there are no contacts, so a few instants of it suffice.
  const Eigen::Matrix3d L = velocity_gradient(0.3, duration);

  double worst = 0;
  for (std::int64_t k = 1; k <= steps; ++k) {
    const double u = static_cast<double>(k) / static_cast<double>(steps);
    const CellMotion half{deformation(u - 0.5 / static_cast<double>(steps)) * H_0, L, Transport::homogeneous};
    const CellMotion end{deformation(u) * H_0, L, Transport::homogeneous};
    scene::step(sim, half, end);
    if (k % (steps / 20) == 0) {
      const Eigen::Matrix3d F = deformation(u);
      for (std::size_t i = 0; i < x_0.size(); ++i) {
        // Rebuilds of the list may have moved a sphere by whole cells.
        Eigen::Vector3d difference = scene::fraction(p, i) - p.H.inverse() * (F * x_0[i]);
        difference.array() -= difference.array().round();
        worst = std::max(worst, (p.H * difference).norm() / (F * x_0[i]).norm());
      }
      worst = std::max(worst, std::abs(volume_fraction(p) / (nu_0 / F.determinant()) - 1));
    }
  }
  EXPECT_GT(sim.rebuilds(), 1U) << "the deformation must have invalidated the list";
  EXPECT_EQ(sim.state().ledger.W_box, 0);
  EXPECT_EQ(kinetic_energy(p), 0);
  expect_figure("D10.there_and_back", worst, 1e-13);
}

/// Error of the sphere's position after 3e-4 s in `steps` steps of uniform stretching [m].
double drift_error(Transport transport, int steps) {
  const Eigen::Vector3d a(-400, 250, 100), v(0.9, -0.6, 0.3), x_0(4e-3, 16e-3, 7e-3);
  const Eigen::Matrix3d H_0 = scene::cubic(20e-3);
  Simulation sim = scene::start(scene::state_of(H_0, {{0.5e-3, x_0, v}}, {2000, 1e8, 1, 0}));
  const double t_end = 3e-4;
  sim.set_dt(t_end / steps);
  const auto motion = [&](double t) {
    const Eigen::Vector3d stretch = (a * t).array().exp();
    return CellMotion{stretch.asDiagonal() * H_0, Eigen::Matrix3d(a.asDiagonal()), transport};
  };
  for (int k = 0; k < steps; ++k) scene::step(sim, motion((k + 0.5) * sim.dt()), motion((k + 1) * sim.dt()));
  const Packing& p = sim.state().packing;
  EXPECT_EQ(scene::velocity(p, 0), v);
  Eigen::Vector3d expected;
  for (int c = 0; c < 3; ++c) {
    expected(c) = transport == Transport::wall
                      ? x_0(c) + v(c) * t_end
                      : p.H(c, c) * (x_0(c) / H_0(c, c) + v(c) / H_0(c, c) * -std::expm1(-a(c) * t_end) / a(c));
  }
  return (scene::position(p, 0) - expected).norm();
}

TEST(AffineMotion, FluctuationIsCarriedWithTheCell) {
  const double coarse = drift_error(Transport::homogeneous, 50), fine = drift_error(Transport::homogeneous, 200);
  const double speed = 1.2, t_end = 3e-4, a_dt = 400 * t_end / 50;
  EXPECT_LE(coarse, speed * t_end * a_dt * a_dt / 24) << "midpoint rule";
  EXPECT_NEAR(std::log(coarse / fine) / std::log(4.0), 2, 0.1);
}

TEST(AffineMotion, WallDrivenSpheresKeepTheirPlace) { EXPECT_LE(drift_error(Transport::wall, 50), 1e-16); }

TEST(AffineMotion, WallDrivenSphereReentersWithItsVelocity) {
  // The edge sweeps over a resting sphere: it re-enters on the other side, where the cell begins, and stays at rest.
  const Eigen::Matrix3d H_0 = scene::cubic(20e-3);
  Simulation sim = scene::start(scene::state_of(H_0, {{0.5e-3, {19e-3, 5e-3, 5e-3}}}));
  const Eigen::Matrix3d L = Eigen::Vector3d(-1e4, 0, 0).asDiagonal();
  for (int k = 0; k < 3000; ++k) {
    const auto motion = [&](double t) {
      Eigen::Matrix3d H = H_0;
      H(0, 0) *= std::exp(-1e4 * t);
      return CellMotion{H, L, Transport::wall};
    };
    scene::step(sim, motion((k + 0.5) * sim.dt()), motion((k + 1) * sim.dt()));
  }
  const Packing& p = sim.state().packing;
  const double edge = p.H(0, 0);
  ASSERT_LT(edge, 19e-3);
  ASSERT_GT(edge, 9.5e-3);
  const double inside = (p.sx[0] - std::floor(p.sx[0])) * edge;
  // It re-entered at 0 when the edge, which moves by 3 um a step, passed 19 mm, and then kept its place.
  EXPECT_LT(inside, 3e-6);
  EXPECT_EQ(p.vx[0], 0);
  EXPECT_NEAR(p.sy[0] * p.H(1, 1), 5e-3, 5e-3 * 3000 * 1.2e-16) << "rounding of 3000 steps";
}

TEST(AffineMotion, DragDecaysExponentially) {
  const Material material;
  const double m = sphere_mass(material, 1e-3), t_b = m / material.background_viscosity;
  const auto error = [&](int steps) {
    Simulation sim = scene::start(scene::state_of(scene::cubic(20e-3), {{1e-3, {1e-3, 2e-3, 3e-3}, {3, -2, 1}}}));
    sim.set_dt(t_b / steps);
    sim.open_ledger();
    scene::advance_at_rest(sim, steps);
    const Eigen::Vector3d exact = std::exp(-1.0) * Eigen::Vector3d(3, -2, 1);
    EXPECT_NEAR(sim.state().ledger.D_background, 0.5 * m * 14 * (1 - std::exp(-2.0)),
                0.5 * m * 14 * 3.0 / (steps * steps));
    return (scene::velocity(sim.state().packing, 0) - exact).norm() / exact.norm();
  };
  EXPECT_LE(error(100), 1e-5);
  EXPECT_NEAR(std::log2(error(50) / error(100)), 2, 0.1);
}

}  // namespace
}  // namespace grainlaw::dem
