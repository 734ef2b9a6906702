#pragma once
// Families of packings that the same checks run over (hard case D20): widths of the size distribution, one intruder,
// a sheared cell.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem::scene {

struct Family {
  std::string name;
  double w = 3;         ///< r_max/r_min of the uniform distribution [-]
  double intruder = 0;  ///< radius of sphere 0 over the mean radius of the others; 0: none
  Eigen::Matrix3d shape = Eigen::Matrix3d::Identity();  ///< shape of the cell
};

inline std::ostream& operator<<(std::ostream& out, const Family& family) { return out << family.name; }

/// The given material; where the family has spheres smaller than the paper's smallest (r = 0.5 mm) its contact
/// viscosity is lowered with sqrt(m), so that the lightest pair keeps the restitution of the paper's: at gamma = 1 kg/s
/// contacts of the smallest spheres would be overdamped.
inline State state_of_family(const Family& family, std::size_t n, double nu, Draw& draw, Material material = {}) {
  const double r_mean = 1e-3;
  double r_min = 2 * r_mean / (family.w + 1);
  if (family.intruder > 0) r_min = std::min(r_min, family.intruder * r_mean);
  material.contact_viscosity *= std::min(1.0, std::pow(r_min / 0.5e-3, 1.5));

  State state = random_state(n, family.w, nu, family.shape, draw, material);
  if (family.intruder > 0 && n > 0) {
    state.packing.radius[0] = family.intruder * r_mean;
    set_masses(state.packing, material);
    scale_to_volume_fraction(state.packing, nu);
  }
  return state;
}

inline Eigen::Matrix3d sheared_shape() {
  Eigen::Matrix3d shape;
  shape << 1, 0.6, -0.3, 0, 0.8, 0.5, 0, 0, 1.3;
  return shape;
}

inline std::vector<Family> families() {
  return {{"Equal", 1, 0},
          {"Paper", 3, 0},
          {"Wide10", 10, 0},
          {"Wide100", 100, 0},
          {"Intruder", 1, 3},
          {"SmallIntruder", 1, 0.2},
          {"Sheared", 3, 0, sheared_shape()}};
}

inline std::string name_of_family(const ::testing::TestParamInfo<Family>& info) { return info.param.name; }

/// Name of the figure that a hard case gives for a family: "D6.Paper", and "D20.D6.Equal" for the others.
inline std::string figure_name(const std::string& what, const Family& family) {
  return (family.name == "Paper" ? "" : "D20.") + what + "." + family.name;
}

}  // namespace grainlaw::dem::scene
