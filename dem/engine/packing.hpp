#pragma once
// Spheres in a periodic cell: structure of arrays. The cell is an upper-triangular matrix H whose columns are its edge
// vectors; positions are fractions of it: x = H s. Fractions are not wrapped between rebuilds of the neighbour list,
// so x = H s may lie outside the cell. SI units.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "dem/engine/contact_law.hpp"

namespace grainlaw::dem {

struct Packing {
  std::vector<std::int64_t> id;                     ///< stable name of each sphere
  std::vector<double> radius;                       ///< [m]
  std::vector<double> mass;                         ///< [kg]
  std::vector<double> sx, sy, sz;                   ///< fractions of the cell [-]
  std::vector<double> vx, vy, vz;                   ///< fluctuation velocities [m/s]
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();  ///< cell, upper triangular, positive diagonal [m]

  std::size_t size() const { return radius.size(); }
  double volume() const { return H(0, 0) * H(1, 1) * H(2, 2); }  ///< of the cell [m^3]
};

/// Allocates all arrays for n spheres, zero filled, ids 0..n-1.
void resize(Packing& packing, std::size_t n);

/// Rounds the radii, by 2^-22 of the largest at most, to a grid on which the sum of any two is a float: in mixed precision
/// a rounded sum would be the largest error of an overlap. Idempotent.
void round_radii(Packing& packing);

/// Sets the masses from the radii.
void set_masses(Packing& packing, const Material& material);

double solid_volume(const Packing& packing);     ///< sum of sphere volumes [m^3]
double volume_fraction(const Packing& packing);  ///< nu [-]
double mean_radius(const Packing& packing);      ///< <r> of this packing [m]; NaN when empty

/// Scales H isotropically so that the volume fraction becomes `nu`. Needs at least one sphere.
void scale_to_volume_fraction(Packing& packing, double nu, bool portable = false);

/// Removes the mean momentum [kg m/s].
void remove_drift(Packing& packing);

/// Throws InvalidInput naming sphere id and quantity unless: arrays of one length, radii and masses positive, everything
/// finite, H upper triangular with positive diagonal.
void check(const Packing& packing);

/// Throws InvalidInput when no cell of this size can hold the spheres: solid volume above twice the cell's, or a radius
/// above twice its smallest height. Their units are most likely wrong.
void check_sizes(const Packing& packing);

/// Reduced mass of the lightest pair that the sizes allow: the two lightest spheres, or one with its own image [kg].
double lightest_pair(const Packing& packing);

/// Smallest collision time of any pair [s].
double min_collision_time(const Packing& packing, const Material& material);

}  // namespace grainlaw::dem
