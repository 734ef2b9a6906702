#pragma once
// Whether a run keeps its energy: the imbalance of a row of its series is |W_box - (change of E_pot + E_kin) - D|. Early in
// shear W_box is negative before it grows, and relative to the work *so far* an imbalance would be judged by a scale that passes
// zero. The scale is therefore the largest |W_box| of the rows so far, which equals the one of the column energy_residual
// wherever the work is at its largest.

#include <string>
#include <vector>

#include "model/vocabulary/observation.hpp"

namespace grainlaw::dem {

/// Judges the rows of a run one after the other.
class EnergyWatch {
 public:
  /// |imbalance| over max |W_box| + E_kin(0) + D [-]; 0 where adding up the energies can lose as much by rounding. To be
  /// asked for each row in turn; `first` is the first one.
  double residual(const Observation& row, const Observation& first);

 private:
  double largest_work_ = 0;  // [J]
};

/// Largest residual that an EnergyWatch finds in these rows [-]; 0 without rows.
double largest_energy_residual(const std::vector<Observation>& rows);

/// Rows on which a quantity was beyond its limit.
struct Excess {
  std::size_t rows = 0;
  double worst = 0;  ///< the largest value ...
  double nu = 0;     ///< ... and the volume fraction there [-]

  void note(double value, double limit, double at_nu);
  /// Adds a warning unless no row was beyond the limit; `what` is the quantity, `of` the number of rows of the run.
  void report(std::vector<std::string>& warnings, const char* what, double limit, std::size_t of) const;
};

}  // namespace grainlaw::dem
