#pragma once
// Two spheres that meet once, followed through the engine step by step.

#include <cmath>

#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem::scene {

/// Coefficient of restitution of a free collision that ends at zero overlap [-].
inline double restitution(const Material& m, double m_ij) {
  return std::exp(-m.contact_viscosity * collision_time(m, m_ij) / (2 * m_ij));
}

struct Encounter {
  double r_i = 1e-3, r_j = 1e-3;                         ///< [m]
  Material material{2000, 1e8, 1, 0};                    ///< no drag: a free collision
  double steps_per_collision = 50.5;                     ///< t_c/dt
  double phase = 0;                                      ///< part of a step that passes before the spheres touch [0..1)
  Eigen::Vector3d line = Eigen::Vector3d::UnitX();       ///< unit vector from j to i at first touch
  Eigen::Vector3d approach = -Eigen::Vector3d::UnitX();  ///< v_i - v_j [m/s], approach . line < 0
  Eigen::Vector3d boost = Eigen::Vector3d::Zero();       ///< velocity of the centre of mass [m/s]
};

struct Outcome {
  double e = 0;         ///< -(relative velocity along the line of centres after)/(before) [-]
  double duration = 0;  ///< from first touch to separation [s]
  Eigen::Vector3d departure = Eigen::Vector3d::Zero();        ///< v_i - v_j after [m/s]
  Eigen::Vector3d momentum_change = Eigen::Vector3d::Zero();  ///< [kg m/s]
  double momentum_scale = 0;                                  ///< sum of |p| before [kg m/s]
};

/// Lets the pair collide in the middle of a cell of 20 mm.
inline Outcome collide(const Encounter& given) {
  const double m_i = sphere_mass(given.material, given.r_i), m_j = sphere_mass(given.material, given.r_j);
  const double t_c = collision_time(given.material, reduced_mass(m_i, m_j));
  const double dt = t_c / given.steps_per_collision;
  const double touch = given.r_i + given.r_j;
  // One whole step and a part of one lie before the first touch.
  const Eigen::Vector3d start_ij = touch * given.line - (1 + given.phase) * dt * given.approach;
  const Eigen::Vector3d middle(0.7e-2, 0.9e-2, 1.1e-2);
  const double part_i = m_j / (m_i + m_j), part_j = m_i / (m_i + m_j);
  State state = state_of(cubic(2e-2),
                         {{given.r_i, middle + part_i * start_ij, given.boost + part_i * given.approach},
                          {given.r_j, middle - part_j * start_ij, given.boost - part_j * given.approach}},
                         given.material);
  const double shortest = min_collision_time(state.packing, given.material);
  Simulation sim = start(std::move(state), dt / shortest);

  const Packing& p = sim.state().packing;
  const auto separation = [&] {
    Eigen::Vector3d s = fraction(p, 0) - fraction(p, 1);
    s.array() -= s.array().round();
    return Eigen::Vector3d(p.H * s);
  };
  const auto momentum = [&] { return Eigen::Vector3d(m_i * velocity(p, 0) + m_j * velocity(p, 1)); };
  const Eigen::Vector3d momentum_before = momentum();

  Outcome outcome;
  outcome.momentum_scale = m_i * velocity(p, 0).norm() + m_j * velocity(p, 1).norm();
  const auto last = static_cast<std::int64_t>(3 * given.steps_per_collision) + 10;
  bool touched = false;
  Eigen::Vector3d normal = given.line;
  for (std::int64_t k = 1; k <= last; ++k) {
    advance_at_rest(sim, 1);
    const double gap = separation().norm() - touch;
    if (gap < 0) touched = true;
    if (gap >= 0 && touched) {
      advance_at_rest(sim, 1);
      normal = separation().normalized();
      const double speed = (velocity(p, 0) - velocity(p, 1)).dot(normal);
      outcome.duration = static_cast<double>(k) * dt - gap / speed - (1 + given.phase) * dt;
      break;
    }
  }
  outcome.departure = velocity(p, 0) - velocity(p, 1);
  outcome.e = -outcome.departure.dot(normal) / given.approach.dot(given.line);
  outcome.momentum_change = momentum() - momentum_before;
  return outcome;
}

}  // namespace grainlaw::dem::scene
