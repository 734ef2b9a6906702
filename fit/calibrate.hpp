#pragma once
// From the data set to the parameters of the law, in stages (docs/formats.md, calibration.json):
//   1 density laws: Eqs. (11), (12), (14) on ISO unloading and on steady D2; Eq. (13); g3
//   2 shear: Eqs. (17), (18) per constant-volume test, windows of equations.md 0
//   3 Eq. (20) over density for s_max, beta_s, F_max, beta_F
//   4 evolution: Eq. (16) on all calibration trajectories at once, started from the staged values, exact derivatives
//   5 lode: what the Lode angle changes, on shear at constant volume unlike D2, which the stages 3, 4 and 6 leave out
//   6 memory: what the memory rung adds, on the trajectories of 4, with the laws of the stages before
// Validation tests are refused here, not filtered silently.

#include <cstdint>
#include <string>
#include <vector>

#include "fit/data/options.hpp"
#include "fit/stages/shear_fit.hpp"
#include "fit/statistics/inherited_error.hpp"
#include "model/calibrated_law.hpp"
#include "model/vocabulary/run_control.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::fit {

/// A calibration without one packing, leave_one_out.hpp.
struct LeftOut {
  std::uint64_t seed = 0;     ///< of the packing
  std::vector<double> value;  ///< in the order of parameter_table(); NaN where not identified
  std::string note;           ///< what went wrong; may be empty
};

/// The calibrated law and how it came about.
struct Calibration {
  CalibratedLaw law;
  FoundErrors errors;                     ///< by packing; not in parameters.json
  std::vector<Stage> stages;              ///< in order of computation
  std::vector<ShearFit> shear;            ///< in the order of the tests
  std::vector<std::string> unused_tests;  ///< calibration tests that no stage reads, e.g. ISO loading
  std::vector<std::string> warnings;      ///< about the data, e.g. rows that stand out (outliers.hpp)
  std::vector<LeftOut> left_out;          ///< one per packing, when asked for (leave_one_out.hpp)
  PackingCount size;                      ///< of the tests
  Moderation moderation;                  ///< what a prior made of the law's errors; those of the stages are without
};

/// Packings (seeds) of the tests and their spheres.
PackingCount size_of(const std::vector<TestRecord>& tests);

/// Throws InvalidInput naming test, row and column when a validation test, a test without rows, a non-finite or
/// inconsistent value is given, or when the ISO unloading branch or all shear tests are missing (with the remedy).
/// Throws Interrupted. A stage that does not converge is reported, not thrown.
Calibration calibrate(const std::vector<TestRecord>& tests, const CalibrationOptions& options,
                      const RunControl& control);

}  // namespace grainlaw::fit
