#include "dem/engine/contact_law.hpp"

#include <gtest/gtest.h>

#include "tests/support/dem_collision.hpp"

namespace grainlaw::dem {
namespace {

using std::numbers::pi;

TEST(ContactLaw, MassOfASphere) {
  EXPECT_DOUBLE_EQ(sphere_mass({2000, 1e8, 1, 0.1}, 1e-3), 4.0 / 3.0 * pi * 1e-9 * 2000);
}

TEST(ContactLaw, ReducedMass) {
  EXPECT_DOUBLE_EQ(reduced_mass(3, 3), 1.5);
  EXPECT_DOUBLE_EQ(reduced_mass(1, 3), 0.75);
  EXPECT_DOUBLE_EQ(reduced_mass(3, 1), reduced_mass(1, 3));
}

// Section 2 of the paper prints .643 us, .926, 8.37 us, 83.7 us for the mean pair and .228 us, .804 for the smallest.
TEST(ContactLaw, NumbersOfThePaper) {
  const Material m;
  const double mean = reduced_mass(sphere_mass(m, 1e-3), sphere_mass(m, 1e-3));
  const double least = reduced_mass(sphere_mass(m, 0.5e-3), sphere_mass(m, 0.5e-3));
  EXPECT_NEAR(collision_time(m, mean), 0.643167e-6, 5e-13);
  EXPECT_NEAR(scene::restitution(m, mean), 0.926100594751, 5e-13);
  EXPECT_NEAR(collision_time(m, least), 0.227871e-6, 5e-13);
  EXPECT_NEAR(scene::restitution(m, least), 0.804446769387, 5e-13);
  EXPECT_NEAR(2 * mean / m.contact_viscosity, 8.37e-6, 0.01e-6);
  EXPECT_NEAR(2 * mean / m.background_viscosity, 83.7e-6, 0.1e-6);
}

TEST(ContactLaw, UndampedCollisionIsHalfAPeriodAndElastic) {
  const Material m{2000, 1e8, 0, 0};
  const double m_ij = 4e-6;
  EXPECT_DOUBLE_EQ(collision_time(m, m_ij), pi * std::sqrt(m_ij / 1e8));
  EXPECT_EQ(scene::restitution(m, m_ij), 1);
}

TEST(ContactLaw, OverdampedContactHasNoCollisionTime) {
  const double m_ij = 1e-6, critical = 2 * std::sqrt(1e8 * m_ij);
  EXPECT_TRUE(std::isfinite(collision_time({2000, 1e8, 0.99 * critical, 0}, m_ij)));
  EXPECT_TRUE(std::isnan(collision_time({2000, 1e8, 1.01 * critical, 0}, m_ij)));
}

TEST(ContactLaw, ElasticForces) {
  const Material m;
  ContactModel contacts;
  const double r = 1e-3, r_ij = 0.5e-3, delta = 1e-5, K = m.stiffness / (2 * r);
  const auto force = [&] { return elastic_force(m, contacts, r, r_ij, delta); };
  EXPECT_DOUBLE_EQ(force(), m.stiffness * delta);
  contacts.normal_force = NormalForce::hertz;
  EXPECT_NEAR(force(), K * std::sqrt(r_ij) * std::pow(delta, 1.5), 1e-9);
  const double without = force();
  contacts.cohesion = 3;
  EXPECT_NEAR(force(), without - 4 * std::numbers::pi * 3 * r_ij, 1e-9);
}

}  // namespace
}  // namespace grainlaw::dem
