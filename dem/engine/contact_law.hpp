#pragma once
// Linear visco-elastic normal contact, Eq. (1), and its times.
//   f = k delta + gamma d(delta)/dt along n,  delta = r_i + r_j - |x_ij|,  n = x_ij/|x_ij|,  x_ij = x_i - x_j (nearest images)
//   d(delta)/dt = -(v_i - v_j + L x_ij) . n   (L velocity gradient of the cell, v fluctuation velocities)
//   background drag f_b = -gamma_b v_i
//   t_c = pi/sqrt(k/m_ij - (gamma/2m_ij)^2),  e = exp(-gamma t_c/(2 m_ij)),  m_ij = m_i m_j/(m_i + m_j)
// Velocity Verlet with the velocity predicted to the end of a step multiplies a pair's relative motion, x, dt v, dt^2 a, by
// a matrix with the polynomial z^3 - (2 - q - 3c/2) z^2 + (1 - 2c) z + c/2, q = k dt^2/m_ij, c = gamma dt/m_ij. Its roots are
// within the unit circle while q + 4c < 4: a root leaves through -1, whatever the damping.
// A contact exists while delta > 0; its force may turn attractive before it ends. SI units. f > 0 repels.

#include <cmath>
#include <numbers>

#include "model/vocabulary/contact_model.hpp"
#include "model/vocabulary/fields.hpp"

namespace grainlaw::dem {

struct Material {
  double density = 2000;              ///< rho of the spheres [kg/m^3]
  double stiffness = 1e8;             ///< k [kg/s^2]
  double contact_viscosity = 1;       ///< gamma [kg/s]
  double background_viscosity = 0.1;  ///< gamma_b [kg/s]
};
constexpr auto fields_of(std::type_identity<Material>) {
  using M = Material;
  return std::tuple{
      Field{&M::density, "density", "kg/m^3", "rho", "mass density of the spheres"},
      Field{&M::stiffness, "stiffness", "kg/s^2", "k", "contact stiffness k"},
      Field{&M::contact_viscosity, "contact_viscosity", "kg/s", "gamma", "contact viscosity gamma"},
      Field{&M::background_viscosity, "background_viscosity", "kg/s", "gamma_b", "background drag gamma_b"}};
}
static_assert(tells_every_member<Material>());

/// Throws InvalidInput naming the key unless density and stiffness are positive, viscosities not negative, all finite.
void check(const Material& material);

/// Mass of a sphere of radius `r` [kg].
inline double sphere_mass(const Material& m, double r) { return 4.0 / 3.0 * std::numbers::pi * r * r * r * m.density; }

inline double reduced_mass(double m_i, double m_j) { return m_i * m_j / (m_i + m_j); }

/// Elastic force at overlap `delta` of a pair with r_ij = r_i r_j/(r_i + r_j), of a packing of mean radius <r> [N]; > 0 repels.
///   hooke: k delta,   hertz: k/(2<r>) sqrt(r_ij delta) delta - 4 pi w r_ij
inline double elastic_force(const Material& m, const ContactModel& c, double mean_radius, double r_ij, double delta) {
  if (c.normal_force == NormalForce::hooke) return m.stiffness * delta;
  return m.stiffness / (2 * mean_radius) * std::sqrt(r_ij * delta) * delta - 4 * std::numbers::pi * c.cohesion * r_ij;
}

/// Duration of a free collision [s]; NaN when the contact is overdamped (it never ends by itself).
inline double collision_time(const Material& m, double m_ij) {
  const double eta = m.contact_viscosity / (2 * m_ij);
  return std::numbers::pi / std::sqrt(m.stiffness / m_ij - eta * eta);
}

/// Longest time step at which the motion of a pair in contact does not grow [s]: k dt^2 + 4 gamma dt = 4 m_ij.
inline double stable_time_step(const Material& m, double m_ij) {
  const double gamma = m.contact_viscosity;
  return 2 * m_ij / (std::sqrt(gamma * gamma + m.stiffness * m_ij) + gamma);
}

/// Damping over the critical one [-].
inline double damping_ratio(const Material& m, double m_ij) {
  return m.contact_viscosity / (2 * std::sqrt(m.stiffness * m_ij));
}

}  // namespace grainlaw::dem
