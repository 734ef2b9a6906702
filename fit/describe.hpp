#pragma once
// Laws of the modes that the calibrated law does not read as such, from tests of role description: a row of Table 2 each for UNI
// and D3, Eq. (20) for D3, and D2 from the loading branch beside that from the unloading branch. The stages are those of
// the calibration (staged_laws.hpp) on other tests; nothing of it flows back.

#include <string>
#include <vector>

#include "fit/calibrate.hpp"

namespace grainlaw::fit {

struct Description {
  std::string name;         ///< "UNI", "D3", "D2-loading"
  Calibration calibration;  ///< only the laws that the tests speak of are identified; nu_min, nu_max of their rows
};

/// One for each of these modes that the tests, all of role description, contain with rows enough:
///   UNI         unloading segments of single-axis strain; Eqs. (11) to (14), like ISO unloading
///   D3, D2      shear at constant volume, one description for each starting branch ("-loading" for that one); `nu_c`, of
///               Eq. (14) on ISO unloading, decides which of them are jammed
/// Throws InvalidInput naming test, row and column of what cannot be trusted.
std::vector<Description> describe(const std::vector<TestRecord>& tests, double nu_c, const CalibrationOptions& options,
                                  const RunControl& control);

}  // namespace grainlaw::fit
