// D5: three spheres in a row, one hits two that touch. Without drag the motion is linear between the instants at which
// a contact begins or ends: y = (x_1, x_2, x_3, v_1, v_2, v_3),  y' = A y + b with the springs of the closed contacts,
//   y(t) = y_0 + phi,  (phi, 1) = exp([A b'; 0 0] t) (0, 1),  b' = A y_0 + b
// and each instant is found by bisection on an overlap.

#include <gtest/gtest.h>

#include <array>
#include <unsupported/Eigen/MatrixFunctions>

#include "tests/support/dem_scene.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

struct Row3 {
  std::array<double, 3> r{1e-3, 1e-3, 1e-3};  ///< [m]
  Material material{2000, 1e8, 1, 0};

  double mass(int i) const { return sphere_mass(material, r[static_cast<std::size_t>(i)]); }
  double touch(int c) const { return r[static_cast<std::size_t>(c)] + r[static_cast<std::size_t>(c) + 1]; }
  double overlap(const Vector6& y, int c) const { return touch(c) - (y(c + 1) - y(c)); }
};

/// Time `t` later, while exactly the contacts of `closed` act.
Vector6 flow(const Row3& row, const Vector6& y, const std::array<bool, 2>& closed, double t) {
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  Vector6 b = Vector6::Zero();
  A.topRightCorner<3, 3>().setIdentity();
  for (int c = 0; c < 2; ++c) {
    if (!closed[static_cast<std::size_t>(c)]) continue;
    for (const int i : {c, c + 1}) {
      const double sign = (i == c ? -1 : 1) / row.mass(i);
      const double k = row.material.stiffness, gamma = row.material.contact_viscosity;
      A(3 + i, c) += sign * k, A(3 + i, c + 1) -= sign * k;  // k (touch - x_{c+1} + x_c)
      A(3 + i, 3 + c) += sign * gamma, A(3 + i, 4 + c) -= sign * gamma;
      b(3 + i) += sign * k * row.touch(c);
    }
  }
  Eigen::Matrix<double, 7, 7> M = Eigen::Matrix<double, 7, 7>::Zero();
  M.topLeftCorner<6, 6>() = A * t;
  M.topRightCorner<6, 1>() = (A * y + b) * t;
  return y + M.exp().topRightCorner<6, 1>();
}

/// Exact state at time T: contacts open and close where their overlap changes sign.
Vector6 exact(const Row3& row, Vector6 y, double T) {
  const double look = 1e-9;  // far below the 5e-7 s of a collision, so no event is stepped over
  std::array<bool, 2> closed{row.overlap(y, 0) > 0, row.overlap(y, 1) > 0};
  for (double t = 0; t < T;) {
    const double step = std::min(look, T - t);
    Vector6 next = flow(row, y, closed, step);
    double low = 0, high = step;
    const auto changed = [&](const Vector6& at, int c) {
      return (row.overlap(at, c) > 0) != closed[static_cast<std::size_t>(c)];
    };
    if (changed(next, 0) || changed(next, 1)) {
      for (int n = 0; n < 60; ++n) {
        const double middle = (low + high) / 2;
        const Vector6 at = flow(row, y, closed, middle);
        (changed(at, 0) || changed(at, 1) ? high : low) = middle;
      }
      next = flow(row, y, closed, high);
      for (int c = 0; c < 2; ++c) {
        if (changed(next, c)) closed[static_cast<std::size_t>(c)] = !closed[static_cast<std::size_t>(c)];
      }
    }
    y = next;
    t += high;
  }
  return y;
}

constexpr double kEdge = 32e-3;
constexpr double kFirstSpeed = 0.25;

/// Sphere 0 flies to the right and hits 1 and 2, which touch; it starts `gap` away. Fractions lie in [1/2, 1).
State start_row(const Row3& row, double gap, bool mirrored) {
  std::vector<scene::Sphere> spheres(3);
  double x = 0.75 * kEdge - row.r[0] - gap;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i == 1) x = 0.75 * kEdge + row.r[1];
    if (i == 2) x += row.r[1] + row.r[2];
    spheres[i] = {row.r[i], {x, 0.5 * kEdge, 0.5 * kEdge}, {i == 0 ? kFirstSpeed : 0, 0, 0}};
  }
  State state = scene::state_of(scene::cubic(kEdge), spheres, row.material);
  if (mirrored) {
    for (double& s : state.packing.sx) s = 1.5 - s;  // exact in [1/2, 1), where all fractions have the same spacing
    for (double& v : state.packing.vx) v = -v;
  }
  return state;
}

double shortest_step(const Row3& row) {
  const double m = std::min({row.mass(0), row.mass(1), row.mass(2)});
  return collision_time(row.material, m / 2) / 50.4;
}

class ThreeInARow : public ::testing::TestWithParam<std::array<double, 3>> {};

TEST_P(ThreeInARow, D5AgreesWithTheMatrixExponential) {
  Row3 row;
  row.r = GetParam();
  const double dt = shortest_step(row);
  double worst = 0;
  for (int n = 0; n < 20; ++n) {
    const double gap = (1 + n / 20.0) * dt * kFirstSpeed;
    State state = start_row(row, gap, false);
    const double shortest = min_collision_time(state.packing, row.material);
    Vector6 y;
    for (int i = 0; i < 3; ++i) {
      y(i) = kEdge * state.packing.sx[static_cast<std::size_t>(i)];
      y(3 + i) = state.packing.vx[static_cast<std::size_t>(i)];
    }
    y(2) = y(1) + row.touch(1);  // touching exactly, not to the rounding of a fraction
    Simulation sim = scene::start(std::move(state), dt / shortest);
    const auto steps = static_cast<std::int64_t>(std::ceil(2.4e-6 / dt));
    scene::advance_at_rest(sim, steps);
    y = exact(row, y, static_cast<double>(steps) * dt);
    EXPECT_LT(row.overlap(y, 0), 0) << "all must have parted";
    EXPECT_LT(row.overlap(y, 1), 0) << "all must have parted";
    for (std::size_t i = 0; i < 3; ++i) {
      worst = std::max(worst, std::abs(sim.state().packing.vx[i] - y(3 + static_cast<int>(i))) / kFirstSpeed);
    }
  }
  testing::expect_figure(fmt::format("D5.{:g}-{:g}-{:g}", 1e3 * row.r[0], 1e3 * row.r[1], 1e3 * row.r[2]), worst, 5e-3);
}

INSTANTIATE_TEST_SUITE_P(Sizes, ThreeInARow,
                         ::testing::Values(std::array{1e-3, 1e-3, 1e-3}, std::array{0.5e-3, 1e-3, 1.5e-3},
                                           std::array{1.5e-3, 1e-3, 0.5e-3}));

TEST(ThreeInARow, D5MirrorImageBitwise) {
  const Row3 row;
  State left = start_row(row, 1.5e-9, false);
  State right = start_row(row, 1.5e-9, true);
  Simulation a = scene::start(std::move(left)), b = scene::start(std::move(right));
  int different = 0;
  for (int k = 0; k < 400; ++k) {
    scene::advance_at_rest(a, 1);
    scene::advance_at_rest(b, 1);
    for (std::size_t i = 0; i < 3; ++i) {
      const double sum = a.state().packing.sx[i] + b.state().packing.sx[i];  // exact, up to whole cells
      different += sum - std::floor(sum) != 0.5 ? 1 : 0;
      different += a.state().packing.vx[i] != -b.state().packing.vx[i] ? 1 : 0;
    }
  }
  EXPECT_LT(a.state().packing.vx[0], 0.5 * kFirstSpeed) << "they must have met";
  testing::expect_figure("D5.numbers_that_differ_in_the_mirror", different, 0);
}

}  // namespace
}  // namespace grainlaw::dem
