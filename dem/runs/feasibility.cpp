#include "dem/runs/feasibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem/element_tests/stepper.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kMaxSteps = 1e10;  // runs that would take more are refused
constexpr double kPassesPerMinimum =
    300;  // force passes of one minimisation along a quasi-static path, measured within a factor of 3
constexpr double kUnloadTo = 0.66;  // just below jamming, so that the unloading branch brackets nu_c

/// The lightest sphere of the distribution, uniform on 2<r>/(w+1) [1, w].
double smallest_radius(const PackingOptions& packing) { return 2 * packing.mean_radius / (packing.size_width + 1); }

double lightest_pair(const PackingOptions& packing) {
  return sphere_mass(packing.material, smallest_radius(packing)) / 2;
}

double shortest_collision(const PackingOptions& packing) {
  return collision_time(packing.material, lightest_pair(packing));
}

}  // namespace

double expected_steps(const PreparationOptions& o, const std::vector<StraightSegment>& segments) {
  const double dt = o.engine.time_step_fraction * shortest_collision(o.packing);
  double steps = 0;
  if (o.drive.quasi_static_step > 0) {
    for (const StraightSegment& segment : segments)
      steps += kPassesPerMinimum * static_cast<double>(quasi_static_steps(segment, o.drive, o.rows));
    return steps;
  }
  for (const StraightSegment& segment : segments) {
    steps += std::ceil(make_drive(segment, o.drive, Eigen::Matrix3d::Identity()).duration / dt);
  }
  return steps;
}

double expected_steps(const PreparationOptions& o) {
  PreparationOptions gas = o;
  gas.drive.quasi_static_step = 0;
  return expected_steps(gas, isotropic_segment(o.nu_gas, o.nu_start)) / o.gas_compression_factor +
         expected_steps(o, isotropic_segment(o.nu_start, o.nu_max)) +
         expected_steps(o, isotropic_segment(o.nu_max, o.nu_end.value_or(o.nu_start)));
}

void complete_preparation(PreparationOptions& o, const std::string& name) {
  if (!o.nu_end) {
    double lowest = kUnloadTo;
    for (const double nu : o.keep_unloading) lowest = std::min(lowest, nu);
    o.nu_end = lowest < o.nu_max ? std::max(o.nu_start, lowest) : o.nu_start;
  }
  // the densest state tells a reader of the branches' series which packing they belong to
  if (o.keep_loading.empty() && o.keep_unloading.empty()) o.keep_loading.push_back(o.nu_max);
  try {
    check(o);
    if (!std::isfinite(shortest_collision(o.packing))) {
      throw InvalidInput(fmt::format(
          "contact_viscosity: {} kg/s overdamps the contacts of the smallest spheres, which then never end; give less "
          "than {:.4g}",
          o.packing.material.contact_viscosity,
          std::sqrt(2 * o.packing.material.stiffness * sphere_mass(o.packing.material, smallest_radius(o.packing)))));
    }
    check_time_step(o.engine.time_step_fraction, o.packing.material, lightest_pair(o.packing));
    if (const double steps = expected_steps(o); !(steps <= kMaxSteps)) {
      throw InvalidInput(fmt::format(
          "strain_rate: {} 1/s makes the preparation {:.3g} steps long, more than {:.0g}; give a larger one",
          o.drive.strain_rate, steps, kMaxSteps));
    }
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, error.what()));
  }
}

void check_path(const Path& path, const PreparationOptions& o, const std::string& name) {
  try {
    const std::vector<StraightSegment> segments = resolve(path);
    check_can_follow(segments);
    if (const double steps = expected_steps(o, segments); !(steps <= kMaxSteps)) {
      throw InvalidInput(
          fmt::format("strain_rate: {} 1/s makes the path {:.3g} steps long, more than {:.0g}; give a larger one, or a "
                      "shorter path",
                      o.drive.strain_rate, steps, kMaxSteps));
    }
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, error.what()));
  }
}

}  // namespace grainlaw::dem
