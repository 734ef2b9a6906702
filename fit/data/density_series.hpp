#pragma once
// What the density laws are fitted to: rows of unloading branches, and steady means of shear at constant volume.

#include <string>
#include <vector>

#include "fit/data/data_set.hpp"

namespace grainlaw::fit {

struct DensityPoint {
  double nu = 0;                ///< volume fraction [-]
  double C_star = 0;            ///< corrected coordination number; NaN where the test counts no contacts [-]
  double rattler_fraction = 0;  ///< phi_r, likewise [-]
  double P_star = 0;            ///< [-]
  double F_v = 0;               ///< trace of the fabric; NaN where the test does not tell it [-]
  double mean_overlap = 0;      ///< <delta>_c/<r>; NaN where the data set does not contain it [-]

  double C() const { return (1 - rattler_fraction) * C_star; }  ///< modified coordination number [-]
};

/// The points that one test gives.
struct DensitySeries {
  std::string test;
  int cluster = 0;
  int excluded = 0;  ///< rows outside the window, or unjammed
  std::vector<DensityPoint> points;
};

/// Rows of those segments of `tests` in which the volume grows, with nu >= iso_nu_min; tests without any are absent. Throws
/// InvalidInput naming test, row and column when a coordination number or rattler fraction of a jammed row is missing where other
/// rows have it.
std::vector<DensitySeries> unloading_series(const std::vector<const TestRecord*>& tests, const DataSet& data,
                                            const CalibrationOptions& options);

/// Those of the ISO unloading tests. Throws InvalidInput, too, when no four rows are in the window.
std::vector<DensitySeries> isotropic_series(const DataSet& data, const CalibrationOptions& options);

/// One point per test at constant volume of `mode`, D2 for all that is like it: means over eps_dev >= steady_from, or from where the
/// test is steady if that is later. Tests that end before, or are not jammed there, are absent.
std::vector<DensitySeries> steady_series(const DataSet& data, Mode mode, const CalibrationOptions& options);

/// Those of tests that count contacts.
std::vector<DensitySeries> with_contacts(const std::vector<DensitySeries>& series);

/// Smallest volume fraction of all points.
double least_nu(const std::vector<DensitySeries>& series);

/// Number of volume fractions that differ by more than 0.002.
int distinct_densities(std::vector<double> nu);

}  // namespace grainlaw::fit
