// D1-D3: two spheres meet head-on, without drag.
//   m_ij delta'' = -k delta - gamma delta',  delta(0) = 0, delta'(0) = v;  omega0^2 = k/m_ij, eta = gamma/(2 m_ij),
//   omega^2 = omega0^2 - eta^2:   delta = (v/omega) exp(-eta t) sin(omega t)
//   ends at overlap 0:       t_c = pi/omega,                                     e = exp(-eta pi/omega)
//   would end at force 0:    omega t = pi - atan2(2 eta omega, omega^2 - eta^2),  e = exp(-eta t)
// (there delta'' = 0, hence |delta'| = v exp(-eta t) by the line above). The viscous force jumps by gamma v at first
// touch and at the end; a step that straddles a jump errs by up to e gamma dt/m_ij = 2 e |ln e| dt/t_c, by its phase.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/support/dem_collision.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using scene::collide;
using scene::Draw;
using scene::Encounter;
using testing::figure;

struct Errors {
  double max = 0, rms = 0, mean = 0;  ///< of e [-]
  double mean_duration = 0;           ///< mean of |t - t_c|/t_c [-]
};

/// Errors of `e` over encounters at random phase; t_c/dt is uniform within 1 around `steps`, so never an integer.
Errors errors_over_phases(double r, double gamma, double steps, int encounters, double exact) {
  Draw draw(7);
  Errors errors;
  for (int n = 0; n < encounters; ++n) {
    Encounter encounter;
    encounter.r_i = encounter.r_j = r;
    encounter.material.contact_viscosity = gamma;
    encounter.steps_per_collision = steps + draw.uniform(-0.5, 0.5);
    encounter.phase = draw.uniform(0, 1);
    const scene::Outcome outcome = collide(encounter);
    const double error = outcome.e - exact;
    const double m = sphere_mass(encounter.material, r);
    const double t_c = collision_time(encounter.material, reduced_mass(m, m));
    errors.max = std::max(errors.max, std::abs(error));
    errors.rms += error * error / encounters;
    errors.mean += error / encounters;
    errors.mean_duration += std::abs(outcome.duration - t_c) / t_c / encounters;
  }
  errors.rms = std::sqrt(errors.rms);
  return errors;
}

double eta_of(double r, double gamma) { return gamma / sphere_mass(Material{}, r); }  // m_ij = m/2
double omega0_of(double r) { return std::sqrt(2 * 1e8 / sphere_mass(Material{}, r)); }

double exact_restitution(double r, double gamma) {
  const double eta = eta_of(r, gamma), omega0 = omega0_of(r);
  return std::exp(-std::numbers::pi * eta / std::sqrt(omega0 * omega0 - eta * eta));
}

TEST(HeadOnCollision, FormulaGivesThePublishedNumbers) {
  EXPECT_NEAR(exact_restitution(1e-3, 1), 0.926100594751, 5e-13);
  EXPECT_NEAR(exact_restitution(0.5e-3, 1), 0.804446769387, 5e-13);
}

TEST(HeadOnCollision, D1RestitutionOfTheMeanPair) {
  const Errors errors = errors_over_phases(1e-3, 1, 50, 2000, exact_restitution(1e-3, 1));
  figure("D1.max", errors.max, 3.0e-3);
  figure("D1.rms", errors.rms, 1.3e-3);
  figure("D1.mean", std::abs(errors.mean), 2e-4);
  EXPECT_LE(errors.mean_duration, 3.0e-3);
}

// The pass lines of the mean pair, carried over by the size e |ln e| of the error: 2.5 times wider here.
TEST(HeadOnCollision, D1RestitutionOfTheSmallestPair) {
  const double exact = exact_restitution(0.5e-3, 1), mean_pair = exact_restitution(1e-3, 1);
  const double scale = exact * std::log(exact) / (mean_pair * std::log(mean_pair));
  const Errors errors = errors_over_phases(0.5e-3, 1, 50, 2000, exact);
  figure("D1.small.max", errors.max, 3.0e-3 * scale);
  figure("D1.small.rms", errors.rms, 1.3e-3 * scale);
  figure("D1.small.mean", std::abs(errors.mean), 2e-4 * scale);
}

double order(double r, double gamma) {
  const double exact = exact_restitution(r, gamma);
  const double coarse = errors_over_phases(r, gamma, 25, 500, exact).rms;
  const double fine = errors_over_phases(r, gamma, 200, 500, exact).rms;
  return std::log(coarse / fine) / std::log(8.0);
}

TEST(HeadOnCollision, D1OrderOneWithDampingTwoWithout) {
  EXPECT_NEAR(order(1e-3, 1), 1, 0.1);
  EXPECT_NEAR(order(0.5e-3, 1), 1, 0.1);
  EXPECT_NEAR(order(1e-3, 0), 2, 0.2);
}

TEST(HeadOnCollision, D2WholeStepsPerCollisionHideTheError) {
  Encounter encounter;
  encounter.steps_per_collision = 100;
  encounter.phase = 0.5;
  const double trapped = std::abs(collide(encounter).e - exact_restitution(1e-3, 1));
  const Errors honest = errors_over_phases(1e-3, 1, 100, 500, exact_restitution(1e-3, 1));
  EXPECT_LT(trapped, 0.1 * honest.max) << "an integer t_c/dt must not be used for a study of dt";
}

TEST(HeadOnCollision, D3ContactEndsAtOverlapZero) {
  const double eta = eta_of(1e-3, 1), omega0 = omega0_of(1e-3), omega = std::sqrt(omega0 * omega0 - eta * eta);
  const double at_overlap_zero = exact_restitution(1e-3, 1);
  const double t_force_zero = (std::numbers::pi - std::atan2(2 * eta * omega, omega * omega - eta * eta)) / omega;
  const double at_force_zero = std::exp(-eta * t_force_zero);
  EXPECT_NEAR(at_overlap_zero, 0.926101, 5e-7);
  EXPECT_NEAR(at_force_zero, 0.927207, 5e-7);

  const Errors errors = errors_over_phases(1e-3, 1, 400, 2000, at_overlap_zero);
  figure("D3.overlap_zero", std::abs(errors.mean), 2e-5);
  EXPECT_GT(std::abs(at_overlap_zero + errors.mean - at_force_zero), 1e-3) << "the other exit rule must be told apart";
}

}  // namespace
}  // namespace grainlaw::dem
